// Moves a setpoint along a route, never far from the vehicle, and away from tracked obstacles.
//
// parameter speed_max m/s 1
// input vehicle.position.{x,y,z} m
// input tracks.seen[1..4] Boolean
// input tracks.position[1..4].{x,y,z} m
// input tracks.radius[1..4] m
// input route.count Integer
// input route.point[1..4].{x,y,z} m
// output setpoint.position.{x,y,z} m
// output setpoint.velocity.{x,y,z} m/s
// output setpoint.acceleration.{x,y,z} m/s^2
// output setpoint.yaw rad
// local carrot[1..3] m
// local leg Integer

static void begin(struct unit *unit) {}

static void advance(struct unit *unit) {
    double *at = &R[carrot];
    const double *vehicle = &R[vehicle_position];
    if (STEPS == 1) memcpy(at, vehicle, 3 * sizeof *at);
    if (I[leg] < I[route_count] && distance(at, vehicle) < 1.8) {
        const double *next = &R[route_point + 3 * I[leg]];
        double left = distance(at, next), part = fmin(1, R[speed_max] * H / fmax(left, 1e-9));
        for (int k = 0; k < 3; k++) at[k] += part * (next[k] - at[k]);
        if (part == 1 && I[leg] + 1 < I[route_count]) I[leg]++;
    }
    memcpy(&R[setpoint_position], at, 3 * sizeof *at);
    for (int i = 0; i < 4; i++) {
        const double *track = &R[tracks_position + 3 * i];
        double away = distance(vehicle, track), clearance = away - R[tracks_radius + i];
        if (!B[tracks_seen + i] || clearance > 3) continue;
        for (int k = 0; k < 2; k++) R[setpoint_position + k] += (3 - clearance) * (vehicle[k] - track[k]) / away;
    }
}
