// A point that follows a demanded velocity in wind.
//
// parameter position0.{x,y,z} m
// input demand.{x,y,z} m/s
// input wind.{x,y,z} m/s
// output state.position.{x,y,z} m
// output state.velocity.{x,y,z} m/s

static void begin(struct unit *unit) { memcpy(&R[state_position], &R[position0], 3 * sizeof(double)); }

// Time constants: 0.3 s to the demand, 12 s to the wind.
static void advance(struct unit *unit) {
    for (int i = 0; i < 3; i++) {
        double *velocity = &R[state_velocity + i];
        *velocity += H * ((R[demand + i] - *velocity) / 0.3 + (R[wind + i] - *velocity) / 12);
        R[state_position + i] += H * *velocity;
    }
}
