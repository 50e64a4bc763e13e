// Keeps how surely each cell of a grid is occupied: more where beams end, less where they pass.
//
// input vehicle.position.{x,y,z} m
// input vehicle.attitude.{w,x,y,z} 1
// input scan.count Integer
// input scan.reach m
// input scan.range[1..121] m
// output map.cell[1..32,1..12] 1

static void begin(struct unit *unit) {}

static void advance(struct unit *unit) {
    for (int beam = 0; beam < I[scan_count]; beam++) {
        double bearing = heading(&R[vehicle_attitude]) + beam_angle(beam, I[scan_count]);
        double range = R[scan_range + beam];
        for (double far = 1; far < range + 0.2; far += 0.5) {
            double x = R[vehicle_position] + far * cos(bearing), y = R[vehicle_position + 1] + far * sin(bearing);
            int cell = cell_at(x, y);
            if (cell >= 0 && far < range - CELL) R[map_cell + cell] *= 0.98;
        }
        if (range > R[scan_reach] - 1) continue;
        double x = R[vehicle_position] + range * cos(bearing), y = R[vehicle_position + 1] + range * sin(bearing);
        int cell = cell_at(x, y);
        if (cell >= 0) R[map_cell + cell] += 0.3 * (1 - R[map_cell + cell]);
    }
}
