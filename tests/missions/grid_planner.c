// The cheapest path over a grid to a goal; a cell costs more the surer it or a neighbour is occupied.
//
// parameter goal.{x,y} m
// input vehicle.position.{x,y,z} m
// input map.cell[1..32,1..12] 1
// output path.count Integer
// output path.point[1..8].{x,y} m
// local cost[1..384] 1
// local price[1..384] 1

static void begin(struct unit *unit) {}

// The neighbour of a cell from which the way costs least, or the cell; `least` is that cost.
static int best(struct unit *unit, int cell, double *least) {
    int found = cell;
    for (int k = 0; k < 9; k++) {
        int i = cell / ACROSS + k / 3 - 1, j = cell % ACROSS + k % 3 - 1, other = i * ACROSS + j;
        if (k == 4 || i < 0 || i >= ALONG || j < 0 || j >= ACROSS) continue;
        double sum = R[cost + other] + hypot(k / 3 - 1, k % 3 - 1) * R[price + other];
        if (sum < *least) *least = sum, found = other;
    }
    return found;
}

static void advance(struct unit *unit) {
    int last = cell_at(R[goal], R[goal + 1]), changed = 1;
    for (int cell = 0; cell < ALONG * ACROSS; cell++) {
        R[cost + cell] = cell == last ? 0 : 1e9;
        R[price + cell] = 1;
        for (int k = 0; k < 9; k++) {
            int i = cell / ACROSS + k / 3 - 1, j = cell % ACROSS + k % 3 - 1;
            if (i < 0 || i >= ALONG || j < 0 || j >= ACROSS) continue;
            R[price + cell] += (k == 4 ? 60 : 4) * R[map_cell + i * ACROSS + j];
        }
    }
    while (changed) {
        changed = 0;
        for (int cell = ALONG * ACROSS - 1; cell >= 0; cell--) {
            double least = R[cost + cell] - 1e-9;
            if (best(unit, cell, &least) != cell) R[cost + cell] = least, changed = 1;
        }
    }
    int cell = cell_at(R[vehicle_position], R[vehicle_position + 1]);
    for (I[path_count] = 0; cell >= 0 && cell != last && I[path_count] < 7; I[path_count]++) {
        double least = 1e9;
        cell = best(unit, cell, &least);
        R[path_point + 2 * I[path_count]] = WEST + CELL * (cell / ACROSS + 0.5);
        R[path_point + 2 * I[path_count] + 1] = SOUTH + CELL * (cell % ACROSS + 0.5);
    }
    if (cell == last) memcpy(&R[path_point + 2 * I[path_count]++], &R[goal], 2 * sizeof(double));
}
