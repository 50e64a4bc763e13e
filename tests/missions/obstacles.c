// Balls that stand still or move, from a table, and how far a vehicle is from the nearest one. Nothing is drawn at random.
//
// parameter map String
// parameter seed Integer 1
// parameter stream Integer 0
// input vehicle.position.{x,y,z} m
// output obstacles.count Integer
// output obstacles.position[1..4].{x,y,z} m
// output obstacles.radius[1..4] m
// output known.count Integer
// output known.position[1..4].{x,y,z} m
// output known.radius[1..4] m
// output position[1..4].{x,y,z} m
// output clearance m
// local rows[1..44] 1

enum { COLUMNS = 11, RADIUS = 9, KNOWN = 10 };

static void place(struct unit *unit, double time) {
    R[clearance] = 1000;
    I[known_count] = 0;
    for (int ball = 0; ball < I[obstacles_count]; ball++) {
        const double *row = &R[rows + COLUMNS * ball];
        double *centre = &R[obstacles_position + 3 * ball];
        for (int i = 0; i < 3; i++) centre[i] = row[i] + row[3 + i] * time + row[6 + i] * time * time / 2;
        memcpy(&R[position + 3 * ball], centre, 3 * sizeof *centre);
        R[obstacles_radius + ball] = row[RADIUS];
        R[clearance] = fmin(R[clearance], distance(centre, &R[vehicle_position]) - row[RADIUS]);
        if (row[KNOWN] == 0) continue;
        memcpy(&R[known_position + 3 * I[known_count]], centre, 3 * sizeof *centre);
        R[known_radius + I[known_count]++] = row[RADIUS];
    }
}

// Columns of the table: position (m), velocity (m/s), acceleration (m/s^2), radius (m), known (1 or 0).
static void begin(struct unit *unit) {
    FILE *table = fopen(S[map], "r");
    if (!table) return;
    fscanf(table, "%*[^\n]");
    int count = 0;
    while (count < 4 * COLUMNS && fscanf(table, "%lf%*[, ]", &R[rows + count]) == 1) count++;
    fclose(table);
    I[obstacles_count] = count / COLUMNS;
    place(unit, T);
}

static void advance(struct unit *unit) { place(unit, T + H); }
