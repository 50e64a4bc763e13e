/* A unit of almost no cost: each y[i] is half of u[i] plus one. PORTS is the number of inputs and of outputs.
 * Value references: u from 0, y from PORTS. */
#include <stddef.h>
#include <stdlib.h>

#define EXPORT __attribute__((visibility("default")))

struct unit {
    double values[2 * PORTS];
};

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return calloc(1, sizeof(struct unit));
}

EXPORT void fmi2FreeInstance(void *unit) { free(unit); }

EXPORT int fmi2SetupExperiment(void *unit, int tolerance_defined, double tolerance, double start, int stop_defined,
                               double stop) {
    (void)unit, (void)tolerance_defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return 0;
}

EXPORT int fmi2EnterInitializationMode(void *unit) { return unit == NULL; }
EXPORT int fmi2ExitInitializationMode(void *unit) { return unit == NULL; }
EXPORT int fmi2Terminate(void *unit) { return unit == NULL; }

EXPORT int fmi2GetReal(void *unit, const unsigned *references, size_t count, double *values) {
    const struct unit *self = unit;
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= 2 * PORTS) return 3;
        values[i] = self->values[references[i]];
    }
    return 0;
}

EXPORT int fmi2SetReal(void *unit, const unsigned *references, size_t count, const double *values) {
    struct unit *self = unit;
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= PORTS) return 3;
        self->values[references[i]] = values[i];
    }
    return 0;
}

EXPORT int fmi2DoStep(void *unit, double time, double step, int no_return) {
    struct unit *self = unit;
    (void)time, (void)step, (void)no_return;
    for (size_t i = 0; i < PORTS; i++) self->values[PORTS + i] = 0.5 * self->values[i] + 1.0;
    return 0;
}

#define ABSENT(name) \
    EXPORT int name(void *unit, const unsigned *references, size_t count, void *values) { \
        (void)unit, (void)references, (void)count, (void)values; \
        return 3; \
    }
ABSENT(fmi2GetInteger)
ABSENT(fmi2GetBoolean)
ABSENT(fmi2GetString)
ABSENT(fmi2SetInteger)
ABSENT(fmi2SetBoolean)
ABSENT(fmi2SetString)
