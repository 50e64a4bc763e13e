// Demands the velocity that keeps a vehicle in its slot behind a neighbour, or on the path if it leads, and off threats.
//
// parameter slot.{x,y,z} m
// parameter gap_min m
// input state.position.{x,y,z} m
// input state.velocity.{x,y,z} m/s
// input path.time s
// input path.position.{x,y,z} m
// input path.velocity.{x,y,z} m/s
// input threats.count Integer
// input threats.position[1..4].{x,y,z} m
// input threats.radius[1..4] m
// input neighbours[1..2].position.{x,y,z} m
// input neighbours[1..2].velocity.{x,y,z} m/s
// output radio.position.{x,y,z} m
// output radio.velocity.{x,y,z} m/s
// output demand.{x,y,z} m/s
// output error m

static void begin(struct unit *unit) {}

// Adds the velocity away from a place that is nearer than `limit`.
static void avoid(struct unit *unit, const double *place, double limit) {
    double away = fmax(distance(&R[state_position], place), 1e-3);
    for (int i = 0; i < 3 && away < limit; i++) {
        R[demand + i] += 1.5 * (limit - away) * (R[state_position + i] - place[i]) / away;
    }
}

static void advance(struct unit *unit) {
    double *me = &R[state_position], meant[3];
    int leads = R[slot] == 0 && R[slot + 1] == 0 && R[slot + 2] == 0;
    for (int i = 0; i < 3; i++) {
        meant[i] = R[path_position + i] + R[path_velocity + i] * (T - R[path_time]) + R[slot + i];
        double target = leads ? meant[i] : R[neighbours_position + i] + R[slot + i];
        R[demand + i] = (leads ? R[path_velocity + i] : R[neighbours_velocity + i]) + 0.7 * (target - me[i]);
    }
    R[error] = distance(me, meant);
    if (!leads) avoid(unit, &R[neighbours_position], R[gap_min]);
    for (int i = 0; i < I[threats_count]; i++) {
        avoid(unit, &R[threats_position + 3 * i], R[threats_radius + i] + 8);
    }
    memcpy(&R[radio_position], me, 3 * sizeof *me);
    memcpy(&R[radio_velocity], &R[state_velocity], 3 * sizeof *me);
}
