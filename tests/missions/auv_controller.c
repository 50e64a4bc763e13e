// Shares the thrust that holds a speed and turns to a heading among two thrusters.
//
// input state.position.{x,y,z} m
// input state.attitude.{w,x,y,z} 1
// input state.velocity.{x,y,z} m/s
// input state.rate.{x,y,z} rad/s
// input command.yaw rad
// input command.speed m/s
// output thrusters[1..2] N

static void begin(struct unit *unit) {}

static void advance(struct unit *unit) {
    double yaw = heading(&R[state_attitude]);
    double surge = R[state_velocity] * cos(yaw) + R[state_velocity + 1] * sin(yaw);
    double rate = limited(0.6 * turn(yaw, R[command_yaw]), 0.35);
    double both = limited(25 * R[command_speed] + 40 * (R[command_speed] - surge), 60);
    double moment = limited(20 * rate + 40 * (rate - R[state_rate + 2]), 40);
    R[thrusters] = both / 2 - moment;
    R[thrusters + 1] = both / 2 + moment;
}
