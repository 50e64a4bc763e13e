// A vehicle in a plane with a thruster on each side, in an even current.
//
// parameter position0.{x,y,z} m
// parameter yaw0 rad
// parameter current.{x,y,z} m/s
// input thrusters[1..2] N
// output state.position.{x,y,z} m
// output state.attitude.{w,x,y,z} 1
// output state.velocity.{x,y,z} m/s
// output state.rate.{x,y,z} rad/s
// local yaw rad
// local surge m/s

static void begin(struct unit *unit) {
    R[yaw] = R[yaw0];
    memcpy(&R[state_position], &R[position0], 3 * sizeof(double));
    R[state_attitude] = cos(R[yaw] / 2);
    R[state_attitude + 3] = sin(R[yaw] / 2);
}

// Mass 50 kg, moment of inertia 20 kg m^2, thrusters 0.5 m off the axis, damping 25 N s/m and 20 N m s.
static void advance(struct unit *unit) {
    R[surge] += H * (R[thrusters] + R[thrusters + 1] - 25 * R[surge]) / 50;
    R[state_rate + 2] += H * (0.5 * (R[thrusters + 1] - R[thrusters]) - 20 * R[state_rate + 2]) / 20;
    R[yaw] += H * R[state_rate + 2];
    R[state_velocity] = R[surge] * cos(R[yaw]) + R[current];
    R[state_velocity + 1] = R[surge] * sin(R[yaw]) + R[current + 1];
    R[state_velocity + 2] = R[current + 2];
    for (int i = 0; i < 3; i++) R[state_position + i] += H * R[state_velocity + i];
    R[state_attitude] = cos(R[yaw] / 2);
    R[state_attitude + 3] = sin(R[yaw] / 2);
}
