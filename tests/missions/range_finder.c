// Measures ranges in a plane, evenly over 240 degrees about the heading, with noise of 2 cm.
//
// parameter beams Integer 121
// parameter range_max m 10
// parameter seed Integer 1
// parameter stream Integer 0
// input vehicle.position.{x,y,z} m
// input vehicle.attitude.{w,x,y,z} 1
// input obstacles.count Integer
// input obstacles.position[1..4].{x,y,z} m
// input obstacles.radius[1..4] m
// output scan.count Integer
// output scan.reach m
// output scan.range[1..121] m

static void begin(struct unit *unit) {}

// How far a ray from a point runs to a circle; -1 if it passes by.
static double ray(const double *from, double bearing, const double *centre, double radius) {
    double x = centre[0] - from[0], y = centre[1] - from[1];
    double along = x * cos(bearing) + y * sin(bearing), square = radius * radius - (x * x + y * y - along * along);
    return along < 0 || square < 0 ? -1 : along - sqrt(square);
}

static void advance(struct unit *unit) {
    I[scan_count] = I[beams];
    R[scan_reach] = R[range_max];
    for (int beam = 0; beam < I[beams]; beam++) {
        double bearing = heading(&R[vehicle_attitude]) + beam_angle(beam, I[beams]), range = R[range_max];
        for (int i = 0; i < I[obstacles_count]; i++) {
            double far = ray(&R[vehicle_position], bearing, &R[obstacles_position + 3 * i], R[obstacles_radius + i]);
            if (far >= 0) range = fmin(range, far + 0.02 * noise(I[seed], I[stream], STEPS, beam));
        }
        R[scan_range + beam] = range;
    }
}
