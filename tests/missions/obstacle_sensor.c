// Measures distance, bearing and height of obstacles in its range, with noise of the distance.
//
// parameter range_max m 10
// parameter sigma_range m 0
// parameter seed Integer 1
// parameter stream Integer 0
// input vehicle.position.{x,y,z} m
// input obstacles.count Integer
// input obstacles.position[1..4].{x,y,z} m
// input obstacles.radius[1..4] m
// output detections.seen[1..4] Boolean
// output detections.distance[1..4] m
// output detections.bearing[1..4] rad
// output detections.height[1..4] m
// output detections.radius[1..4] m

static void begin(struct unit *unit) {}

static void advance(struct unit *unit) {
    const double *from = &R[vehicle_position];
    for (int i = 0; i < 4; i++) {
        const double *to = &R[obstacles_position + 3 * i];
        double away = hypot(to[0] - from[0], to[1] - from[1]);
        B[detections_seen + i] = i < I[obstacles_count] && away < R[range_max];
        R[detections_distance + i] = away + R[sigma_range] * noise(I[seed], I[stream], STEPS, i);
        R[detections_bearing + i] = atan2(to[1] - from[1], to[0] - from[0]);
        R[detections_height + i] = to[2] - from[2];
        R[detections_radius + i] = R[obstacles_radius + i];
    }
}
