/* A small FMI 2.0 co-simulation unit in plain C, written from the standard's text without its header files.
 *
 * y follows gain * u by one Euler step each, count counts steps, label is a text. It logs with printf arguments.
 *
 * -DMISBEHAVE_CALL=<call> -DMISBEHAVE_HOW=<how> make it misbehave:
 *   call: LOAD INSTANTIATE SETUP ENTER EXIT GET SET STEP TERMINATE FREE
 *   how:  CRASH ABORT EXIT_0 EXIT_3 HANG SPIN OVERFLOW_STACK          the process ends or does not return
 *         WARNING DISCARD ERROR_STATUS FATAL PENDING STATUS_42        a status is returned
 *         TERMINATED                                                  Discard, and terminated at the middle of the step
 *         NOT_A_NUMBER                                                y is NaN from that time on
 *         NO_INSTANCE                                                 NULL, in INSTANTIATE
 * -DMISBEHAVE_FROM_S=<seconds> is the time from which GET, SET and STEP misbehave; 0 by default.
 * -DSTEP_TAKES_US=<microseconds> makes each step slow.
 * -DVERSION and -DTYPES_PLATFORM change the strings that fmi2GetVersion and fmi2GetTypesPlatform return.
 * -DWITHOUT_SET_STRING, -DWITHOUT_STATUS and -DWITHOUT_STATES leave functions out; -DWITH_STATES saves and restores
 * states. -DNEEDS_SYMBOL refers to an undefined function. -DDISTURB changes rounding mode and working directory during
 * instantiation.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef GUID
#define GUID "{5f1ed1f0-c0de-4c0d-8000-00000000f0e1}"
#endif
#ifndef VERSION
#define VERSION "2.0"
#endif
#ifndef TYPES_PLATFORM
#define TYPES_PLATFORM "default"
#endif
#ifndef MISBEHAVE_CALL
#define MISBEHAVE_CALL NEVER
#define MISBEHAVE_HOW CRASH
#endif
#ifndef STEP_TAKES_US
#define STEP_TAKES_US 0
#endif
#ifndef MISBEHAVE_FROM_S
#define MISBEHAVE_FROM_S 0.0
#endif

enum call { NEVER, LOAD, INSTANTIATE, SETUP, ENTER, EXIT, GET, SET, STEP, TERMINATE, FREE };
enum how {
    CRASH, ABORT, EXIT_0, EXIT_3, HANG, SPIN, OVERFLOW_STACK,
    WARNING, DISCARD, ERROR_STATUS, FATAL, PENDING, STATUS_42, TERMINATED, NOT_A_NUMBER, NO_INSTANCE
};
enum status { OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL, STATUS_PENDING };

typedef void (*logger_function)(void *, const char *, int, const char *, const char *, ...);

struct callbacks {
    logger_function logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
};

struct unit {
    const struct callbacks *callbacks; /* a pointer to the importer's struct, not a copy, as in many units */
    char *name;
    char label[64];
    double time, u, gain, y, reached;
    int count, enabled, logging, terminated, broken;
};

#define EXPORT __attribute__((visibility("default")))
#define LOG(unit, status, category, ...) \
    (unit)->callbacks->logger((unit)->callbacks->environment, (unit)->name, status, category, __VA_ARGS__)

/* Volatile, so that the compiler cannot know that it is NULL. */
static int *volatile nowhere = NULL;

static int overflow(volatile char *above) {
    volatile char frame[4096];
    frame[0] = above[0];
    return overflow(frame) + frame[1];
}

/* Misbehaves if this is the configured call; returns the status to return, or -1 to continue normally. */
static int misbehave(enum call call, double time) {
    char start = 0;
    if (call != MISBEHAVE_CALL || time < MISBEHAVE_FROM_S) return -1;
    switch (MISBEHAVE_HOW) {
    case CRASH: *nowhere = 1; break;
    case ABORT: abort();
    case EXIT_0: exit(0);
    case EXIT_3: exit(3);
    case HANG: for (;;) sleep(1000);
    case SPIN: for (volatile int i = 0;; i++) {}
    case OVERFLOW_STACK: return overflow(&start);
    case WARNING: return STATUS_WARNING;
    case DISCARD: case TERMINATED: return STATUS_DISCARD;
    case ERROR_STATUS: return STATUS_ERROR;
    case FATAL: return STATUS_FATAL;
    case PENDING: return STATUS_PENDING;
    case STATUS_42: return 42;
    default: break;
    }
    return -1;
}

static int fails(struct unit *unit, enum call call) {
    int status = misbehave(call, unit->time);
    if (status >= 0) LOG(unit, status, "logAll", "asked to return %d at %.3f s", status, unit->time);
    return status;
}

#define TRY(unit, call) do { int status_ = fails(unit, call); if (status_ >= 0) return status_; } while (0)

__attribute__((constructor)) static void loaded(void) { misbehave(LOAD, 0.0); }

#ifdef NEEDS_SYMBOL
void nobody_has_this_function(void);
EXPORT void refer(void) { nobody_has_this_function(); }
#endif

#ifdef DISTURB
#include <fenv.h>
#endif

EXPORT const char *fmi2GetVersion(void) { return VERSION; }
EXPORT const char *fmi2GetTypesPlatform(void) { return TYPES_PLATFORM; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const struct callbacks *callbacks, int visible, int logging) {
    struct unit *unit;
    (void)visible;
    if (strcmp(guid, GUID) != 0) {
        callbacks->logger(callbacks->environment, name, STATUS_ERROR, "logStatusError",
                          "the guid is %s, but this unit's is %s", guid, GUID);
        return NULL;
    }
#ifdef DISTURB
    fesetround(FE_DOWNWARD);
    if (chdir("/") != 0) return NULL;
#endif
    misbehave(INSTANTIATE, 0.0);
    if (INSTANTIATE == MISBEHAVE_CALL) return NULL;
    unit = callbacks->allocate(1, sizeof *unit);
    if (!unit) return NULL;
    unit->callbacks = callbacks;
    unit->name = callbacks->allocate(strlen(name) + 1, 1);
    strcpy(unit->name, name);
    strcpy(unit->label, "none");
    unit->gain = 2.0;
    unit->logging = logging;
    LOG(unit, OK, "logAll", "type %d, resources in %s", type, strncmp(resources, "file:///", 8) ? resources : "file:///");
    return unit;
}

EXPORT void fmi2FreeInstance(struct unit *unit) {
    if (!unit) return;
    fails(unit, FREE);
    unit->callbacks->release(unit->name);
    unit->callbacks->release(unit);
}

EXPORT int fmi2SetDebugLogging(struct unit *unit, int on, size_t count, const char *const categories[]) {
    (void)count, (void)categories;
    unit->logging = on;
    return OK;
}

EXPORT int fmi2SetupExperiment(struct unit *unit, int with_tolerance, double tolerance, double start, int with_stop, double stop) {
    (void)with_tolerance, (void)tolerance, (void)with_stop, (void)stop;
    unit->time = start;
    TRY(unit, SETUP);
    return OK;
}

EXPORT int fmi2EnterInitializationMode(struct unit *unit) { TRY(unit, ENTER); return OK; }
EXPORT int fmi2ExitInitializationMode(struct unit *unit) { TRY(unit, EXIT); return OK; }

EXPORT int fmi2Terminate(struct unit *unit) {
    TRY(unit, TERMINATE);
    LOG(unit, OK, "logAll", "done after %d steps: %g %g %g %g %g %g %g %g %g | %s", unit->count, 1.0, 2.0, 3.0, 4.0, 5.0,
        6.0, 7.0, 8.0, unit->y, unit->label);
    return OK;
}

EXPORT int fmi2Reset(struct unit *unit) { unit->time = unit->u = unit->y = 0.0; unit->count = 0; return OK; }

EXPORT int fmi2GetReal(struct unit *unit, const unsigned vr[], size_t count, double value[]) {
    TRY(unit, GET);
    for (size_t i = 0; i < count; i++) switch (vr[i]) {
        case 0: value[i] = unit->u; break;
        case 1: value[i] = unit->gain; break;
        case 2: value[i] = unit->broken ? NAN : unit->y; break;
        default: LOG(unit, STATUS_ERROR, "logStatusError", "no Real variable %u", vr[i]); return STATUS_ERROR;
    }
    if (GET == MISBEHAVE_CALL && NOT_A_NUMBER == MISBEHAVE_HOW && unit->time >= MISBEHAVE_FROM_S) unit->broken = 1;
    return OK;
}

EXPORT int fmi2SetReal(struct unit *unit, const unsigned vr[], size_t count, const double value[]) {
    TRY(unit, SET);
    for (size_t i = 0; i < count; i++) {
        if (vr[i] > 1) { LOG(unit, STATUS_ERROR, "logStatusError", "#r%u# cannot be set", vr[i]); return STATUS_ERROR; }
        *(vr[i] ? &unit->gain : &unit->u) = value[i];
    }
    return OK;
}

EXPORT int fmi2GetInteger(struct unit *unit, const unsigned vr[], size_t count, int value[]) {
    for (size_t i = 0; i < count; i++) { if (vr[i]) return STATUS_ERROR; value[i] = unit->count; }
    return OK;
}
EXPORT int fmi2SetInteger(struct unit *unit, const unsigned vr[], size_t count, const int value[]) {
    (void)unit, (void)vr, (void)value;
    return count ? STATUS_ERROR : OK;
}
EXPORT int fmi2GetBoolean(struct unit *unit, const unsigned vr[], size_t count, int value[]) {
    /* Any number except zero is true. */
    for (size_t i = 0; i < count; i++) { if (vr[i]) return STATUS_ERROR; value[i] = unit->enabled ? -7 : 0; }
    return OK;
}
EXPORT int fmi2SetBoolean(struct unit *unit, const unsigned vr[], size_t count, const int value[]) {
    for (size_t i = 0; i < count; i++) { if (vr[i]) return STATUS_ERROR; unit->enabled = value[i]; }
    return OK;
}
EXPORT int fmi2GetString(struct unit *unit, const unsigned vr[], size_t count, const char *value[]) {
    for (size_t i = 0; i < count; i++) { if (vr[i]) return STATUS_ERROR; value[i] = unit->label; }
    return OK;
}
#ifndef WITHOUT_SET_STRING
EXPORT int fmi2SetString(struct unit *unit, const unsigned vr[], size_t count, const char *const value[]) {
    for (size_t i = 0; i < count; i++) {
        if (vr[i]) return STATUS_ERROR;
        snprintf(unit->label, sizeof unit->label, "%s", value[i]);
    }
    return OK;
}
#endif

EXPORT int fmi2DoStep(struct unit *unit, double time, double step, int no_return) {
    (void)no_return;
    unit->time = time;
    unit->reached = time + step / 2;
    unit->terminated = TERMINATED == MISBEHAVE_HOW;
    TRY(unit, STEP);
    if (STEP == MISBEHAVE_CALL && NOT_A_NUMBER == MISBEHAVE_HOW && time >= MISBEHAVE_FROM_S) unit->broken = 1;
    if (STEP_TAKES_US) usleep(STEP_TAKES_US);
    unit->y += step * (unit->gain * unit->u - unit->y);
    unit->count++;
    unit->time = unit->reached = time + step;
    if (unit->logging) LOG(unit, OK, "logAll", "step %d of %s: #r2# = %.6f", unit->count, unit->name, unit->y);
    return OK;
}

EXPORT int fmi2CancelStep(struct unit *unit) { (void)unit; return STATUS_ERROR; }

#ifndef WITHOUT_STATUS
EXPORT int fmi2GetStatus(struct unit *unit, int kind, int *value) { (void)unit, (void)kind, (void)value; return STATUS_DISCARD; }
EXPORT int fmi2GetRealStatus(struct unit *unit, int kind, double *value) {
    if (kind != 2) return STATUS_DISCARD;
    *value = unit->reached;
    return OK;
}
EXPORT int fmi2GetIntegerStatus(struct unit *unit, int kind, int *value) { (void)unit, (void)kind, (void)value; return STATUS_DISCARD; }
EXPORT int fmi2GetBooleanStatus(struct unit *unit, int kind, int *value) {
    if (kind != 3) return STATUS_DISCARD;
    *value = unit->terminated;
    return OK;
}
EXPORT int fmi2GetStringStatus(struct unit *unit, int kind, const char **value) { (void)unit, (void)kind, (void)value; return STATUS_DISCARD; }
#endif

#ifdef WITH_STATES
/* A state is a copy of the whole struct, in memory from the importer; callbacks and name are not restored. */
EXPORT int fmi2GetFMUstate(struct unit *unit, void **state) {
    if (!*state) *state = unit->callbacks->allocate(1, sizeof *unit);
    if (!*state) return STATUS_ERROR;
    memcpy(*state, unit, sizeof *unit);
    return OK;
}
EXPORT int fmi2SetFMUstate(struct unit *unit, void *state) {
    const struct callbacks *callbacks = unit->callbacks;
    char *name = unit->name;
    if (!state) return STATUS_ERROR;
    memcpy(unit, state, sizeof *unit);
    unit->callbacks = callbacks, unit->name = name;
    return OK;
}
EXPORT int fmi2FreeFMUstate(struct unit *unit, void **state) {
    unit->callbacks->release(*state);
    *state = NULL;
    return OK;
}
EXPORT int fmi2SerializedFMUstateSize(struct unit *unit, void *state, size_t *size) {
    (void)unit, (void)state;
    *size = sizeof(struct unit);
    return OK;
}
EXPORT int fmi2SerializeFMUstate(struct unit *unit, void *state, char bytes[], size_t size) {
    (void)unit;
    if (size < sizeof(struct unit)) return STATUS_ERROR;
    memcpy(bytes, state, sizeof(struct unit));
    /* Addresses are not valid for the reader of the bytes. */
    memset(bytes, 0, offsetof(struct unit, label));
    return OK;
}
EXPORT int fmi2DeSerializeFMUstate(struct unit *unit, const char bytes[], size_t size, void **state) {
    if (size != sizeof *unit) {
        LOG(unit, STATUS_ERROR, "logStatusError", "a state has %zu bytes, not %zu", sizeof *unit, size);
        return STATUS_ERROR;
    }
    if (!*state) *state = unit->callbacks->allocate(1, size);
    if (!*state) return STATUS_ERROR;
    memcpy(*state, bytes, size);
    return OK;
}
#endif

/* Capabilities that the description does not declare: exported, but they return an error. */
#define REFUSED(name, ...) EXPORT int name(__VA_ARGS__) { return STATUS_ERROR; }
#if !defined WITH_STATES && !defined WITHOUT_STATES
REFUSED(fmi2GetFMUstate, void *unit, void **state)
REFUSED(fmi2SetFMUstate, void *unit, void *state)
REFUSED(fmi2FreeFMUstate, void *unit, void **state)
REFUSED(fmi2SerializedFMUstateSize, void *unit, void *state, size_t *size)
REFUSED(fmi2SerializeFMUstate, void *unit, void *state, char bytes[], size_t size)
REFUSED(fmi2DeSerializeFMUstate, void *unit, const char bytes[], size_t size, void **state)
#endif
REFUSED(fmi2GetDirectionalDerivative, void *unit, const unsigned z[], size_t nz, const unsigned v[], size_t nv, const double dv[], double dz[])
REFUSED(fmi2SetRealInputDerivatives, void *unit, const unsigned vr[], size_t count, const int order[], const double value[])
REFUSED(fmi2GetRealOutputDerivatives, void *unit, const unsigned vr[], size_t count, const int order[], double value[])
