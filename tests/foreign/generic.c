/* An FMI 2.0 co-simulation unit whose calls run C code from the compiler's command line.
 *
 * A variable of value reference k is R[k] (Real), I[k] (Integer and Enumeration), B[k] (Boolean) or S[k] (String).
 * Code comes in as -DINSTANTIATE_CODE, SETUP_CODE, ENTER_CODE, EXIT_CODE, SET_CODE, GET_CODE, STEP_CODE,
 * TERMINATE_CODE, FREE_CODE and RESET_CODE; -DINCLUDES="..." is a header that it needs, -DFUNCTIONS="..." a file of
 * functions that it calls with `unit`, -DCOUNT=... how many values of each type there are. In it, T is the time at the
 * begin of the step (s), H its size (s), START the start time that was set up, STEPS the number of steps so far,
 * MODE 0 (instantiated), 1 (initialization) or 2 (stepping), `status` what the call returns (not in INSTANTIATE_CODE
 * and FREE_CODE), and SAY(status, format, ...) logs. -DWITH_STATES saves and restores what R, I, B, S, T, H and STEPS are.
 */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef INCLUDES
#include INCLUDES
#endif

#define EXPORT __attribute__((visibility("default")))
#ifndef COUNT
#define COUNT 64
#endif
#define LENGTH 256

typedef void (*logger_function)(void *, const char *, int, const char *, const char *, ...);

struct callbacks {
    logger_function logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *step_finished;
    void *environment;
};

struct values {
    double reals[COUNT];
    int integers[COUNT], booleans[COUNT];
    char texts[COUNT][LENGTH];
    double time, step;
    long steps;
};

struct unit {
    struct values values;
    struct callbacks callbacks;
    char name[LENGTH];
    double start;
    int mode;
};

#define R unit->values.reals
#define I unit->values.integers
#define B unit->values.booleans
#define S unit->values.texts
#define T unit->values.time
#define H unit->values.step
#define STEPS unit->values.steps
#define START unit->start
#define MODE unit->mode
#define SAY(status, ...) \
    unit->callbacks.logger(unit->callbacks.environment, unit->name, status, "logAll", __VA_ARGS__)

enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };

#ifdef FUNCTIONS
#include FUNCTIONS
#endif

#ifndef INSTANTIATE_CODE
#define INSTANTIATE_CODE
#endif
#ifndef SETUP_CODE
#define SETUP_CODE
#endif
#ifndef ENTER_CODE
#define ENTER_CODE
#endif
#ifndef EXIT_CODE
#define EXIT_CODE
#endif
#ifndef SET_CODE
#define SET_CODE
#endif
#ifndef GET_CODE
#define GET_CODE
#endif
#ifndef STEP_CODE
#define STEP_CODE
#endif
#ifndef TERMINATE_CODE
#define TERMINATE_CODE
#endif
#ifndef RESET_CODE
#define RESET_CODE
#endif
#ifndef FREE_CODE
#define FREE_CODE
#endif

#define CALL(name, arguments, ...) \
    EXPORT int name arguments { int status = OK; __VA_ARGS__; return status; }

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const struct callbacks *callbacks, int visible, int logging) {
    struct unit *unit = calloc(1, sizeof *unit);
    unit->callbacks = *callbacks;
    snprintf(unit->name, LENGTH, "%s", name);
    INSTANTIATE_CODE;
    return unit;
}

EXPORT void fmi2FreeInstance(struct unit *unit) {
    if (!unit) return;
    FREE_CODE;
    free(unit);
}

CALL(fmi2SetDebugLogging, (struct unit *unit, int on, size_t count, const char *const *categories), )
CALL(fmi2SetupExperiment, (struct unit *unit, int has_tolerance, double tolerance, double start, int has_stop, double stop),
     START = T = start; SETUP_CODE)
CALL(fmi2EnterInitializationMode, (struct unit *unit), MODE = 1; ENTER_CODE)
CALL(fmi2ExitInitializationMode, (struct unit *unit), MODE = 2; EXIT_CODE)
CALL(fmi2Terminate, (struct unit *unit), TERMINATE_CODE)
CALL(fmi2Reset, (struct unit *unit), memset(&unit->values, 0, sizeof unit->values); MODE = 0; RESET_CODE)
CALL(fmi2DoStep, (struct unit *unit, double time, double step, int no_set_state_before),
     T = time; H = step; STEPS++; STEP_CODE)
CALL(fmi2CancelStep, (struct unit *unit), status = ERROR)

#define GET_EACH(target) \
    GET_CODE; for (size_t i = 0; i < count; i++) { if (references[i] >= COUNT) return ERROR; values[i] = target[references[i]]; }
#define SET_EACH(assign) \
    for (size_t i = 0; i < count; i++) { if (references[i] >= COUNT) return ERROR; assign; } SET_CODE

#define REFERENCES struct unit *unit, const unsigned *references, size_t count

CALL(fmi2GetReal, (REFERENCES, double *values), GET_EACH(R))
CALL(fmi2GetInteger, (REFERENCES, int *values), GET_EACH(I))
CALL(fmi2GetBoolean, (REFERENCES, int *values), GET_EACH(B))
CALL(fmi2GetString, (REFERENCES, const char **values), GET_EACH(S))
CALL(fmi2SetReal, (REFERENCES, const double *values), SET_EACH(R[references[i]] = values[i]))
CALL(fmi2SetInteger, (REFERENCES, const int *values), SET_EACH(I[references[i]] = values[i]))
CALL(fmi2SetBoolean, (REFERENCES, const int *values), SET_EACH(B[references[i]] = values[i]))
CALL(fmi2SetString, (REFERENCES, const char *const *values), SET_EACH(snprintf(S[references[i]], LENGTH, "%s", values[i])))

CALL(fmi2GetStatus, (struct unit *unit, int kind, int *value), status = DISCARD)
CALL(fmi2GetRealStatus, (struct unit *unit, int kind, double *value), status = DISCARD)
CALL(fmi2GetIntegerStatus, (struct unit *unit, int kind, int *value), status = DISCARD)
CALL(fmi2GetBooleanStatus, (struct unit *unit, int kind, int *value), status = DISCARD)
CALL(fmi2GetStringStatus, (struct unit *unit, int kind, const char **value), status = DISCARD)

#ifdef WITH_STATES
#define STATE(...) __VA_ARGS__
#else
#define STATE(...) status = ERROR
#endif
CALL(fmi2GetFMUstate, (struct unit *unit, struct values **state),
     STATE(if (!*state) *state = malloc(sizeof **state); **state = unit->values))
CALL(fmi2SetFMUstate, (struct unit *unit, struct values *state), STATE(unit->values = *state))
CALL(fmi2FreeFMUstate, (struct unit *unit, struct values **state), STATE(free(*state); *state = NULL))
CALL(fmi2SerializedFMUstateSize, (struct unit *unit, struct values *state, size_t *size), STATE(*size = sizeof *state))
CALL(fmi2SerializeFMUstate, (struct unit *unit, struct values *state, char *bytes, size_t size),
     STATE(memcpy(bytes, state, size)))
CALL(fmi2DeSerializeFMUstate, (struct unit *unit, const char *bytes, size_t size, struct values **state),
     STATE(*state = malloc(size); memcpy(*state, bytes, size)))

CALL(fmi2GetDirectionalDerivative, (struct unit *unit, const unsigned *unknowns, size_t unknown_count,
     const unsigned *knowns, size_t known_count, const double *seeds, double *derivatives), status = ERROR)
CALL(fmi2SetRealInputDerivatives, (REFERENCES, const int *orders, const double *values), status = ERROR)
CALL(fmi2GetRealOutputDerivatives, (REFERENCES, const int *orders, double *values), status = ERROR)
