// Points in space, limits and noise for the units of this folder.
#include <math.h>
#include <stdint.h>

static double distance(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static double limited(double value, double limit) { return fmax(-limit, fmin(limit, value)); }

// The heading of an attitude that turns about the vertical only, or nearly so.
static double heading(const double *attitude) { return 2 * atan2(attitude[3], attitude[0]); }

static double turn(double from, double to) { return remainder(to - from, 2 * M_PI); }

// A number with mean 0 and standard deviation 1, the same for the same arguments.
static double noise(int seed, int stream, long sample, int element) {
    uint64_t state = (uint64_t)seed * 1000003 + (uint64_t)stream * 10007 + (uint64_t)sample * 1009 + (uint64_t)element;
    double sum = -6;
    for (int i = 0; i < 12; i++) {
        uint64_t mixed = state += 0x9e3779b97f4a7c15u;
        mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
        mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
        sum += (double)((mixed ^ (mixed >> 31)) >> 11) / 9007199254740992.0;
    }
    return sum;
}

// The angle of a beam to the heading: `beams` of them lie evenly over 240 degrees.
static double beam_angle(int beam, int beams) { return (2.0 * beam / (beams - 1) - 1) * 2 * M_PI / 3; }

// A grid of square cells in a plane, the first one in the south-west.
enum { ALONG = 32, ACROSS = 12, CELL = 2, WEST = -56, SOUTH = -12 };

// The cell at a point, numbered as `cell[1..ALONG,1..ACROSS]`; -1 outside.
static int cell_at(double x, double y) {
    double i = floor((x - WEST) / CELL), j = floor((y - SOUTH) / CELL);
    return i < 0 || i >= ALONG || j < 0 || j >= ACROSS ? -1 : (int)i * ACROSS + (int)j;
}
