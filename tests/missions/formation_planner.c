// A path that winds over hills from a table: where the leader should be, and how fast it moves.
//
// parameter map String
// parameter speed m/s 1
// output path.time s
// output path.position.{x,y,z} m
// output path.velocity.{x,y,z} m/s
// local hills[1..12] m
// local count Integer

static double height(struct unit *unit, double x) {
    double sum = 30;
    for (int i = 0; i < I[count]; i++) {
        const double *hill = &R[hills + 3 * i];
        sum += hill[2] * exp(-(x - hill[0]) * (x - hill[0]) / (2 * hill[1] * hill[1]));
    }
    return sum;
}

static void place(struct unit *unit, double time) {
    double x = R[speed] * time;
    double y = 10 * (1 - cos(x / 60));
    R[path_time] = time;
    R[path_position] = x;
    R[path_position + 1] = y;
    R[path_position + 2] = height(unit, x);
    R[path_velocity] = R[speed];
    R[path_velocity + 1] = R[speed] / 6 * sin(x / 60);
    R[path_velocity + 2] = R[speed] * (height(unit, x + 0.5) - height(unit, x - 0.5));
}

// Columns of the table: where a hill is along x, its width and its height (m).
static void begin(struct unit *unit) {
    FILE *table = fopen(S[map], "r");
    if (!table) return;
    fscanf(table, "%*[^\n]");
    int values = 0;
    while (values < 12 && fscanf(table, "%lf%*[, ]", &R[hills + values]) == 1) values++;
    fclose(table);
    I[count] = values / 3;
    place(unit, T);
}

static void advance(struct unit *unit) { place(unit, T + H); }
