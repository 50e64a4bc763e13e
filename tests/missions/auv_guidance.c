// Heads for the third point of a path, slower where cells before the vehicle are occupied.
//
// parameter speed_max m/s 1
// input vehicle.position.{x,y,z} m
// input vehicle.attitude.{w,x,y,z} 1
// input map.cell[1..32,1..12] 1
// input path.count Integer
// input path.point[1..8].{x,y} m
// output command.yaw rad
// output command.speed m/s

static void begin(struct unit *unit) {}

static void advance(struct unit *unit) {
    R[command_speed] = 0;
    R[command_yaw] = heading(&R[vehicle_attitude]);
    if (I[path_count] == 0) return;
    const double *aim = &R[path_point + 2 * (I[path_count] < 3 ? I[path_count] - 1 : 2)];
    double x = R[vehicle_position], y = R[vehicle_position + 1];
    int before = cell_at(x + CELL * cos(R[command_yaw]), y + CELL * sin(R[command_yaw]));
    R[command_speed] = R[speed_max] * (before >= 0 && R[map_cell + before] > 0.5 ? 0.3 : 0.7);
    R[command_yaw] = atan2(aim[1] - y, aim[0] - x);
}
