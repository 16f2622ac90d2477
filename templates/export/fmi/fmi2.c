/*
 * SPDX-License-Identifier: 0BSD
 *
 * The functions of FMI 2.0 for model exchange and co-simulation, around an instance; see instance.h.
 */

#include "derivatives.h"
#include "exchange.h"
#include "fmi2.h"
#include "step.h"
#include "stored.h"
#include "variables.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fmu_instance *fmu;
    fmi2Status last; /* of a step */
    fmi2CallbackFunctions callbacks;
    char name[]; /* of the instance */
} component;

static fmu_instance *of(fmi2Component c)
{
    return ((component *) c)->fmu;
}

static void log_message(void *owner, fmu_status status, const char *category, const char *message)
{
    const component *c = (const component *) owner;
    if (c->callbacks.logger != NULL) {
        c->callbacks.logger(c->callbacks.componentEnvironment, c->name, (fmi2Status) status, category, message);
    }
}

static fmi2Status refuse(fmi2Component c, const char *message)
{
    return (fmi2Status) fmu_fail(of(c), FMU_ERROR, message);
}

/* Refuse what this unit has none of. */
static fmi2Status none(fmi2Component c, size_t count, const char *message)
{
    return count == 0 ? fmi2OK : refuse(c, message);
}

FMI2_EXPORT const char *FMI2(GetTypesPlatform)(void) { return "default"; }
FMI2_EXPORT const char *FMI2(GetVersion)(void) { return "2.0"; }

FMI2_EXPORT fmi2Status FMI2(SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    return (fmi2Status) fmu_set_logging(of(c), on, count, categories);
}

FMI2_EXPORT fmi2Component FMI2(Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                            const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                            fmi2Boolean logging)
{
    const size_t length = name == NULL ? 0 : strlen(name);
    component *c = (component *) calloc(1, sizeof *c + length + 1);

    (void) resources, (void) visible, (void) logging; /* there are no messages that are for debugging alone */
    if (c == NULL) {
        return NULL;
    }
    memcpy(c->name, name == NULL ? "" : name, length);
    if (callbacks != NULL) {
        c->callbacks = *callbacks;
    }
    c->fmu = fmu_create(guid, type == fmi2ModelExchange, log_message, c);
    if (c->fmu != NULL) {
        return c;
    }
    free(c);
    return NULL;
}

FMI2_EXPORT void FMI2(FreeInstance)(fmi2Component c)
{
    if (c != NULL) {
        fmu_free(of(c));
        free(c);
    }
}

FMI2_EXPORT fmi2Status FMI2(SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                             fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    return (fmi2Status) fmu_set_up_experiment(of(c), tolerance_defined ? tolerance : 0.0, start,
                                              stop_defined ? stop : HUGE_VAL);
}

FMI2_EXPORT fmi2Status FMI2(EnterInitializationMode)(fmi2Component c)
{
    return (fmi2Status) fmu_enter_initialisation(of(c));
}

FMI2_EXPORT fmi2Status FMI2(ExitInitializationMode)(fmi2Component c)
{
    return (fmi2Status) fmu_exit_initialisation(of(c));
}

FMI2_EXPORT fmi2Status FMI2(Terminate)(fmi2Component c)
{
    return (fmi2Status) fmu_enter(of(c), FMU_EVENT, FMU_BETWEEN_STEPS, FMU_TERMINATED);
}

FMI2_EXPORT fmi2Status FMI2(Reset)(fmi2Component c)
{
    ((component *) c)->last = fmi2OK;
    return (fmi2Status) fmu_reset(of(c));
}

/* ---- values of variables; all are real ---- */

FMI2_EXPORT fmi2Status FMI2(GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real values[])
{
    return (fmi2Status) fmu_get(of(c), vr, count, values);
}

FMI2_EXPORT fmi2Status FMI2(SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real values[])
{
    return (fmi2Status) fmu_set(of(c), vr, count, values);
}

#define NO_VARIABLES(Type, T)                                                                                         \
    FMI2_EXPORT fmi2Status FMI2(Get##Type)(fmi2Component c, const fmi2ValueReference vr[], size_t count, T values[])   \
    {                                                                                                                  \
        return (void) vr, (void) values, none(c, count, "all variables are real");                                     \
    }                                                                                                                  \
    FMI2_EXPORT fmi2Status FMI2(Set##Type)(fmi2Component c, const fmi2ValueReference vr[], size_t count,               \
                                           const T values[])                                                           \
    {                                                                                                                  \
        return (void) vr, (void) values, none(c, count, "all variables are real");                                     \
    }

NO_VARIABLES(Integer, fmi2Integer)
NO_VARIABLES(Boolean, fmi2Boolean)
NO_VARIABLES(String, fmi2String)

/* ---- stored states and derivatives ---- */

FMI2_EXPORT fmi2Status FMI2(GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    return (fmi2Status) fmu_get_state(of(c), state);
}

FMI2_EXPORT fmi2Status FMI2(SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    return (fmi2Status) fmu_set_state(of(c), state);
}

FMI2_EXPORT fmi2Status FMI2(FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    return (void) c, (fmi2Status) fmu_free_state(state);
}

FMI2_EXPORT fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    *size = fmu_state_size(of(c));
    return (void) state, fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return (fmi2Status) fmu_serialise(of(c), state, (unsigned char *) bytes, size);
}

FMI2_EXPORT fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                                 fmi2FMUstate *state)
{
    return (fmi2Status) fmu_deserialise(of(c), (const unsigned char *) bytes, size, state);
}

FMI2_EXPORT fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknowns[],
                                                      size_t unknown_count, const fmi2ValueReference knowns[],
                                                      size_t known_count, const fmi2Real seed[], fmi2Real result[])
{
    return (fmi2Status) fmu_directional(of(c), unknowns, unknown_count, knowns, known_count, seed, result);
}

/* ---- model exchange ---- */

FMI2_EXPORT fmi2Status FMI2(EnterEventMode)(fmi2Component c)
{
    return (fmi2Status) fmu_enter(of(c), FMU_CONTINUOUS, FMU_CONTINUOUS, FMU_EVENT);
}

FMI2_EXPORT fmi2Status FMI2(NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info)
{
    int changed, has_next;
    const fmu_status status = fmu_event(of(c), &changed, &info->nextEventTime, &has_next);

    info->newDiscreteStatesNeeded = info->terminateSimulation = info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = changed;
    info->nextEventTimeDefined = has_next;
    return (fmi2Status) status;
}

FMI2_EXPORT fmi2Status FMI2(EnterContinuousTimeMode)(fmi2Component c)
{
    return (fmi2Status) fmu_enter(of(c), FMU_EVENT, FMU_EVENT, FMU_CONTINUOUS);
}

FMI2_EXPORT fmi2Status FMI2(CompletedIntegratorStep)(fmi2Component c, fmi2Boolean no_state_before,
                                                     fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
{
    *terminate = fmi2False;
    return (void) no_state_before, (fmi2Status) fmu_drifted(of(c), enter_event_mode);
}

FMI2_EXPORT fmi2Status FMI2(SetTime)(fmi2Component c, fmi2Real time)
{
    return (fmi2Status) fmu_set_time(of(c), time);
}

FMI2_EXPORT fmi2Status FMI2(SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t count)
{
    return (fmi2Status) fmu_set_states(of(c), x, count);
}

FMI2_EXPORT fmi2Status FMI2(GetDerivatives)(fmi2Component c, fmi2Real xdot[], size_t count)
{
    return (fmi2Status) fmu_derivatives(of(c), xdot, count);
}

FMI2_EXPORT fmi2Status FMI2(GetEventIndicators)(fmi2Component c, fmi2Real z[], size_t count)
{
    return (void) z, none(c, count, "there are no event indicators");
}

FMI2_EXPORT fmi2Status FMI2(GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t count)
{
    return (fmi2Status) fmu_states(of(c), x, count);
}

FMI2_EXPORT fmi2Status FMI2(GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominals[], size_t count)
{
    return (fmi2Status) fmu_nominals(of(c), nominals, count);
}

/* ---- co-simulation ---- */

FMI2_EXPORT fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                                     const fmi2Integer order[], const fmi2Real values[])
{
    return (void) vr, (void) order, (void) values, none(c, count, "inputs are constant in a step");
}

FMI2_EXPORT fmi2Status FMI2(GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                                      const fmi2Integer order[], fmi2Real values[])
{
    return (void) vr, (void) order, (void) values, none(c, count, "there are no derivatives of outputs");
}

FMI2_EXPORT fmi2Status FMI2(DoStep)(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_before)
{
    return (void) no_state_before, ((component *) c)->last = (fmi2Status) fmu_step(of(c), time, step);
}

FMI2_EXPORT fmi2Status FMI2(CancelStep)(fmi2Component c)
{
    return refuse(c, "a step is complete when its function returns");
}

FMI2_EXPORT fmi2Status FMI2(GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    *value = ((component *) c)->last;
    return kind == fmi2DoStepStatus ? fmi2OK : fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2(GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = of(c)->state[FMU_TIME];
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2(GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    *value = fmi2False;
    return (void) c, kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

#define NO_STATUS(Type, T, nothing)                                                                                    \
    FMI2_EXPORT fmi2Status FMI2(Get##Type##Status)(fmi2Component c, const fmi2StatusKind kind, T *value)               \
    {                                                                                                                  \
        *value = nothing;                                                                                              \
        return (void) c, (void) kind, fmi2Discard;                                                                     \
    }

NO_STATUS(Integer, fmi2Integer, 0)
NO_STATUS(String, fmi2String, "")
