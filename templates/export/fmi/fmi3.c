/*
 * SPDX-License-Identifier: 0BSD
 *
 * The functions of FMI 3.0 for model exchange and co-simulation, around an instance; see instance.h.
 */

#include "derivatives.h"
#include "fmi3.h"
#include "instance.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    fmu_instance *fmu;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} component;

static fmu_instance *of(fmi3Instance c)
{
    return ((component *) c)->fmu;
}

static void log_message(void *owner, fmu_status status, const char *message)
{
    const component *c = (const component *) owner;
    if (c->log != NULL) {
        c->log(c->environment, status == FMU_ERROR ? fmi3Error : fmi3Discard,
               status == FMU_ERROR ? "logStatusError" : "logStatusDiscard", message);
    }
}

static fmi3Status status_of(fmu_status status)
{
    return status == FMU_OK ? fmi3OK : status == FMU_DISCARD ? fmi3Discard : fmi3Error;
}

static fmi3Status refuse(fmi3Instance c, const char *message)
{
    return status_of(fmu_fail(of(c), FMU_ERROR, message));
}

/* Return an error from the calling function unless the mode is between two. */
#define IN_MODE(first, last)                                                                                          \
    do {                                                                                                               \
        if (fmu_in_mode(of(c), first, last) != FMU_OK) {                                                               \
            return fmi3Error;                                                                                          \
        }                                                                                                              \
    } while (0)

FMI3_EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    (void) c, (void) on, (void) count, (void) categories; /* errors alone are logged, whatever is set */
    return fmi3OK;
}

/* ---- instances ---- */

static fmi3Instance instance(fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    component *c = (component *) calloc(1, sizeof *c);
    if (c == NULL) {
        return NULL;
    }
    c->environment = environment;
    c->log = log;
    c->fmu = fmu_create(token, log_message, c);
    if (c->fmu == NULL) {
        free(c);
        return NULL;
    }
    return c;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void) name, (void) resources, (void) visible, (void) logging;
    return instance(token, environment, log);
}

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void) name, (void) resources, (void) visible, (void) logging, (void) early_return, (void) intermediate;
    (void) intermediate_count, (void) update;
    if (event_mode) {
        if (log != NULL) {
            log(environment, fmi3Error, "logStatusError", "co-simulation has no event mode in this unit");
        }
        return NULL;
    }
    return instance(token, environment, log);
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void) name, (void) token, (void) resources, (void) visible, (void) logging, (void) clock, (void) lock, (void) unlock;
    if (log != NULL) {
        log(environment, fmi3Error, "logStatusError", "this unit has no scheduled execution");
    }
    return NULL;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance c)
{
    if (c != NULL) {
        fmu_free(of(c));
        free(c);
    }
}

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                                   fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop)
{
    (void) stop_defined, (void) stop;
    IN_MODE(FMU_INSTANTIATED, FMU_INSTANTIATED);
    return status_of(fmu_initialise(of(c), start, tolerance_defined ? tolerance : 0.0));
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    IN_MODE(FMU_INITIALISING, FMU_INITIALISING);
    return status_of(fmu_begin(of(c)));
}

FMI3_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance c)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    of(c)->state[FMU_MODE] = FMU_TERMINATED;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance c)
{
    fmu_reset(of(c));
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return refuse(c, "there are no structural parameters");
}

FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return refuse(c, "there are no structural parameters");
}

/* ---- values of variables; all are of the type Float64 ---- */

FMI3_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Float64 values[],
                                      size_t value_count)
{
    if (value_count != count) {
        return refuse(c, "every variable has one value");
    }
    return status_of(fmu_get(of(c), vr, count, values));
}

FMI3_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                      const fmi3Float64 values[], size_t value_count)
{
    IN_MODE(FMU_INSTANTIATED, FMU_RUNNING);
    if (value_count != count) {
        return refuse(c, "every variable has one value");
    }
    return status_of(fmu_set(of(c), vr, count, values));
}

static const char NO_SUCH_TYPE[] = "all variables are of the type Float64";

#define NO_VARIABLES(Type)                                                                                            \
    FMI3_EXPORT fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t count,                  \
                                         fmi3##Type values[], size_t value_count)                                      \
    {                                                                                                                  \
        (void) vr, (void) values, (void) value_count;                                                                  \
        return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);                                                          \
    }                                                                                                                  \
    FMI3_EXPORT fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t count,                  \
                                         const fmi3##Type values[], size_t value_count)                                \
    {                                                                                                                  \
        (void) vr, (void) values, (void) value_count;                                                                  \
        return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);                                                          \
    }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t count, size_t sizes[],
                                     fmi3Binary values[], size_t value_count)
{
    (void) vr, (void) sizes, (void) values, (void) value_count;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const size_t sizes[],
                                     const fmi3Binary values[], size_t value_count)
{
    (void) vr, (void) sizes, (void) values, (void) value_count;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Clock values[])
{
    (void) vr, (void) values;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const fmi3Clock values[])
{
    (void) vr, (void) values;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *count)
{
    (void) vr;
    *count = 0;
    return refuse(c, "the dependencies of elements are not provided");
}

FMI3_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
                                                   fmi3ValueReference independents[], size_t independent_elements[],
                                                   fmi3DependencyKind kinds[], size_t count)
{
    (void) dependent, (void) elements, (void) independents, (void) independent_elements, (void) kinds, (void) count;
    return refuse(c, "the dependencies of elements are not provided");
}

/* ---- stored states ---- */

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    if (*state == NULL) {
        *state = malloc(fmu_state_size(of(c)));
    }
    if (*state == NULL) {
        return refuse(c, "there is no memory for a state");
    }
    fmu_store(of(c), (unsigned char *) *state);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    return status_of(fmu_restore(of(c), (const unsigned char *) state, fmu_state_size(of(c))));
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    (void) c;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    (void) state;
    *size = fmu_state_size(of(c));
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    if (state == NULL || size < fmu_state_size(of(c))) {
        return refuse(c, "there is no state, or no space for its bytes");
    }
    memcpy(bytes, state, fmu_state_size(of(c)));
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    if (size != fmu_state_size(of(c))) {
        return refuse(c, "these are not the bytes of a state of this unit");
    }
    if (*state == NULL) {
        *state = malloc(size);
    }
    if (*state == NULL) {
        return refuse(c, "there is no memory for a state");
    }
    memcpy(*state, bytes, size); /* what they are is checked where the state is set */
    return fmi3OK;
}

/* ---- partial derivatives ---- */

FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[],
                                                    size_t unknown_count, const fmi3ValueReference knowns[],
                                                    size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                    fmi3Float64 sensitivity[], size_t sensitivity_count)
{
    IN_MODE(FMU_INITIALISING, FMU_TERMINATED);
    if (seed_count != known_count || sensitivity_count != unknown_count) {
        return refuse(c, "every variable has one value");
    }
    return status_of(fmu_directional(of(c), unknowns, unknown_count, knowns, known_count, seed, sensitivity));
}

FMI3_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[],
                                                size_t unknown_count, const fmi3ValueReference knowns[],
                                                size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                fmi3Float64 sensitivity[], size_t sensitivity_count)
{
    IN_MODE(FMU_INITIALISING, FMU_TERMINATED);
    if (seed_count != unknown_count || sensitivity_count != known_count) {
        return refuse(c, "every variable has one value");
    }
    return status_of(fmu_adjoint(of(c), unknowns, unknown_count, knowns, known_count, seed, sensitivity));
}

/* ---- clocks, of which there are none ---- */

static fmi3Status no_clocks(fmi3Instance c, size_t count)
{
    return count == 0 ? fmi3OK : refuse(c, "there are no clocks");
}

FMI3_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                              fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    (void) vr, (void) intervals, (void) qualifiers;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                               fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                               fmi3IntervalQualifier qualifiers[])
{
    (void) vr, (void) counters, (void) resolutions, (void) qualifiers;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                           fmi3Float64 shifts[])
{
    (void) vr, (void) shifts;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                            fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void) vr, (void) counters, (void) resolutions;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                              const fmi3Float64 intervals[])
{
    (void) vr, (void) intervals;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                               const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void) vr, (void) counters, (void) resolutions;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                           const fmi3Float64 shifts[])
{
    (void) vr, (void) shifts;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                            const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void) vr, (void) counters, (void) resolutions;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void) clock, (void) time;
    return no_clocks(c, 1);
}

/* ---- events and model exchange ---- */

FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    (void) c;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *needs_update, fmi3Boolean *terminate,
                                                fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                                fmi3Boolean *next_defined, fmi3Float64 *next)
{
    int changed, has_next;
    fmu_status status;

    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    *needs_update = *terminate = *nominals_changed = false;
    status = fmu_event(of(c), &changed, next, &has_next);
    *values_changed = changed != 0;
    *next_defined = has_next != 0;
    return status_of(status);
}

FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_state_before,
                                                   fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
{
    int drifted;
    fmu_status status;

    (void) no_state_before;
    *enter_event_mode = *terminate = false;
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    status = fmu_drifted(of(c), &drifted);
    *enter_event_mode = drifted != 0;
    return status_of(status);
}

FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return status_of(fmu_set_time(of(c), time));
}

FMI3_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t count)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return status_of(fmu_set_states(of(c), x, count));
}

FMI3_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 xdot[], size_t count)
{
    IN_MODE(FMU_INITIALISING, FMU_TERMINATED);
    return status_of(fmu_derivatives(of(c), xdot, count));
}

FMI3_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 z[], size_t count)
{
    (void) z;
    return count == 0 ? fmi3OK : refuse(c, "there are no event indicators");
}

FMI3_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t count)
{
    return status_of(fmu_states(of(c), x, count));
}

FMI3_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t count)
{
    if (count != (size_t) of(c)->nx) {
        return refuse(c, "this is not the number of continuous states");
    }
    memcpy(nominals, fmu_size, count * sizeof *nominals);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *count)
{
    (void) c;
    *count = 0;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *count)
{
    *count = (size_t) of(c)->nx;
    return fmi3OK;
}

/* ---- co-simulation ---- */

FMI3_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    return refuse(c, "co-simulation has no event mode in this unit");
}

FMI3_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                                const fmi3Int32 orders[], fmi3Float64 values[], size_t value_count)
{
    (void) vr, (void) orders, (void) values, (void) value_count;
    return count == 0 ? fmi3OK : refuse(c, "there are no derivatives of outputs");
}

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_state_before,
                                  fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                                  fmi3Float64 *last_time)
{
    fmu_status status;

    (void) no_state_before;
    *event_needed = *terminate = *early_return = false;
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    status = fmu_step(of(c), time, step);
    *last_time = of(c)->state[FMU_TIME];
    return status_of(status);
}
