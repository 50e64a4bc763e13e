// Plans a route from the first place of a vehicle to a goal: beside each known obstacle that stands in the way.
//
// parameter goal.{x,y,z} m 0
// parameter margin m 0
// parameter method grid|ant_colony 1
// input vehicle.position.{x,y,z} m
// input obstacles.count Integer
// input obstacles.position[1..4].{x,y,z} m
// input obstacles.radius[1..4] m
// output route.count Integer
// output route.point[1..4].{x,y,z} m
// local first[1..3] m

static void add(struct unit *unit, const double *point) {
    memcpy(&R[route_point + 3 * I[route_count]++], point, 3 * sizeof *point);
}

static void begin(struct unit *unit) {}

// Obstacles are numbered along the way.
static void advance(struct unit *unit) {
    if (STEPS == 1) memcpy(&R[first], &R[vehicle_position], 3 * sizeof(double));
    double along[] = {R[goal] - R[first], R[goal + 1] - R[first + 1], R[goal + 2] - R[first + 2]};
    double length = hypot(along[0], along[1]);
    I[route_count] = 0;
    for (int i = 0; i < I[obstacles_count] && i < 3; i++) {
        double to[] = {R[obstacles_position + 3 * i] - R[first], R[obstacles_position + 3 * i + 1] - R[first + 1]};
        double part = (to[0] * along[0] + to[1] * along[1]) / (length * length);
        double side = (to[1] * along[0] - to[0] * along[1]) / length;
        double keep = R[obstacles_radius + i] + R[margin] + 1;
        if (part < 0 || part > 1 || fabs(side) > keep) continue;
        double shift = side - copysign(keep, side);
        double beside[3];
        for (int k = 0; k < 3; k++) beside[k] = R[first + k] + part * along[k];
        beside[0] -= shift * along[1] / length;
        beside[1] += shift * along[0] / length;
        add(unit, beside);
    }
    add(unit, &R[goal]);
}
