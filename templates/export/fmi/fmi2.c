/*
 * SPDX-License-Identifier: 0BSD
 *
 * The functions of FMI 2.0 for model exchange and co-simulation, around an instance; see instance.h.
 */

#include "derivatives.h"
#include "fmi2.h"
#include "instance.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    fmu_instance *fmu;
    fmi2Type type;
    double start, tolerance; /* of the experiment */
    fmi2Status last;         /* of a step */
    fmi2CallbackFunctions callbacks;
    char name[]; /* of the instance */
} component;

static void log_message(void *owner, fmu_status status, const char *message)
{
    const component *c = (const component *) owner;
    if (c->callbacks.logger != NULL) {
        c->callbacks.logger(c->callbacks.componentEnvironment, c->name, status == FMU_ERROR ? fmi2Error : fmi2Discard,
                            status == FMU_ERROR ? "logStatusError" : "logStatusDiscard", message);
    }
}

static fmi2Status status_of(fmu_status status)
{
    return status == FMU_OK ? fmi2OK : status == FMU_DISCARD ? fmi2Discard : fmi2Error;
}

static fmi2Status refuse(fmi2Component c, const char *message)
{
    return status_of(fmu_fail(((component *) c)->fmu, FMU_ERROR, message));
}

/* Return an error from the calling function unless the mode is between two. */
#define IN_MODE(first, last)                                                                                          \
    do {                                                                                                               \
        if (fmu_in_mode(((component *) c)->fmu, first, last) != FMU_OK) {                                   \
            return fmi2Error;                                                                                          \
        }                                                                                                              \
    } while (0)

FMI2_EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

FMI2_EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    (void) c, (void) on, (void) count, (void) categories; /* errors alone are logged, whatever is set */
    return fmi2OK;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging)
{
    const size_t length = name == NULL ? 0 : strlen(name);
    component *c = (component *) calloc(1, sizeof *c + length + 1);

    (void) resources, (void) visible, (void) logging;
    if (c == NULL) {
        return NULL;
    }
    memcpy(c->name, name == NULL ? "" : name, length);
    if (callbacks != NULL) {
        c->callbacks = *callbacks;
    }
    c->type = type;
    c->fmu = fmu_create(guid, log_message, c);
    if (c->fmu == NULL) {
        free(c);
        return NULL;
    }
    return c;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c)
{
    if (c != NULL) {
        fmu_free(((component *) c)->fmu);
        free(c);
    }
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    component *own = (component *) c;

    (void) stop_defined, (void) stop;
    IN_MODE(FMU_INSTANTIATED, FMU_INSTANTIATED);
    own->start = start;
    own->tolerance = tolerance_defined ? tolerance : 0.0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    const component *own = (const component *) c;
    IN_MODE(FMU_INSTANTIATED, FMU_INSTANTIATED);
    return status_of(fmu_initialise(own->fmu, own->start, own->tolerance));
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    IN_MODE(FMU_INITIALISING, FMU_INITIALISING);
    return status_of(fmu_begin(((component *) c)->fmu));
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    ((component *) c)->fmu->state[FMU_MODE] = FMU_TERMINATED;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    component *own = (component *) c;
    own->start = own->tolerance = 0.0;
    own->last = fmi2OK;
    fmu_reset(own->fmu);
    return fmi2OK;
}

/* ---- values of variables; all are real ---- */

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real values[])
{
    return status_of(fmu_get(((component *) c)->fmu, vr, count, values));
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real values[])
{
    IN_MODE(FMU_INSTANTIATED, FMU_RUNNING);
    return status_of(fmu_set(((component *) c)->fmu, vr, count, values));
}

#define NO_VARIABLES(Type, values_type)                                                                               \
    FMI2_EXPORT fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference vr[], size_t count,                 \
                                         values_type values[])                                                         \
    {                                                                                                                  \
        (void) vr, (void) values;                                                                                      \
        return count == 0 ? fmi2OK : refuse(c, "all variables are real");                                              \
    }                                                                                                                  \
    FMI2_EXPORT fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference vr[], size_t count,                 \
                                         const values_type values[])                                                   \
    {                                                                                                                  \
        (void) vr, (void) values;                                                                                      \
        return count == 0 ? fmi2OK : refuse(c, "all variables are real");                                              \
    }

NO_VARIABLES(Integer, fmi2Integer)
NO_VARIABLES(Boolean, fmi2Boolean)
NO_VARIABLES(String, fmi2String)

/* ---- stored states ---- */

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    const fmu_instance *fmu = ((component *) c)->fmu;
    if (*state == NULL) {
        *state = malloc(fmu_state_size(fmu));
    }
    if (*state == NULL) {
        return refuse(c, "there is no memory for a state");
    }
    fmu_store(fmu, (unsigned char *) *state);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    fmu_instance *fmu = ((component *) c)->fmu;
    return status_of(fmu_restore(fmu, (const unsigned char *) state, fmu_state_size(fmu)));
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void) c;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void) state;
    *size = fmu_state_size(((component *) c)->fmu);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    if (state == NULL || size < fmu_state_size(((component *) c)->fmu)) {
        return refuse(c, "there is no state, or no space for its bytes");
    }
    memcpy(bytes, state, fmu_state_size(((component *) c)->fmu));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    if (size != fmu_state_size(((component *) c)->fmu)) {
        return refuse(c, "these are not the bytes of a state of this unit");
    }
    if (*state == NULL) {
        *state = malloc(size);
    }
    if (*state == NULL) {
        return refuse(c, "there is no memory for a state");
    }
    memcpy(*state, bytes, size); /* what they are is checked where the state is set */
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                                    size_t unknown_count, const fmi2ValueReference knowns[],
                                                    size_t known_count, const fmi2Real seed[], fmi2Real result[])
{
    IN_MODE(FMU_INITIALISING, FMU_TERMINATED);
    return status_of(
        fmu_directional(((component *) c)->fmu, unknowns, unknown_count, knowns, known_count, seed, result));
}

/* ---- model exchange ---- */

FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    int changed, has_next;
    fmu_status status;

    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    info->newDiscreteStatesNeeded = info->terminateSimulation = info->nominalsOfContinuousStatesChanged = fmi2False;
    status = fmu_event(((component *) c)->fmu, &changed, &info->nextEventTime, &has_next);
    info->valuesOfContinuousStatesChanged = changed;
    info->nextEventTimeDefined = has_next;
    return status_of(status);
}

FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_state_before,
                                                   fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
{
    (void) no_state_before;
    *enter_event_mode = *terminate = fmi2False;
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return status_of(fmu_drifted(((component *) c)->fmu, enter_event_mode));
}

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return status_of(fmu_set_time(((component *) c)->fmu, time));
}

FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count)
{
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    return status_of(fmu_set_states(((component *) c)->fmu, x, count));
}

FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real xdot[], size_t count)
{
    IN_MODE(FMU_INITIALISING, FMU_TERMINATED);
    return status_of(fmu_derivatives(((component *) c)->fmu, xdot, count));
}

FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t count)
{
    (void) z;
    return count == 0 ? fmi2OK : refuse(c, "there are no event indicators");
}

FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t count)
{
    return status_of(fmu_states(((component *) c)->fmu, x, count));
}

FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t count)
{
    if (count != (size_t) ((component *) c)->fmu->nx) {
        return refuse(c, "this is not the number of continuous states");
    }
    memcpy(nominals, fmu_size, count * sizeof *nominals);
    return fmi2OK;
}

/* ---- co-simulation ---- */

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                                   const fmi2Integer order[], const fmi2Real values[])
{
    (void) vr, (void) order, (void) values;
    return count == 0 ? fmi2OK : refuse(c, "inputs are constant in a step");
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                                    const fmi2Integer order[], fmi2Real values[])
{
    (void) vr, (void) order, (void) values;
    return count == 0 ? fmi2OK : refuse(c, "there are no derivatives of outputs");
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_before)
{
    component *own = (component *) c;
    (void) no_state_before;
    IN_MODE(FMU_RUNNING, FMU_RUNNING);
    own->last = status_of(fmu_step(own->fmu, time, step));
    return own->last;
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return refuse(c, "a step is complete when its function returns");
}

FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    *value = ((component *) c)->last;
    return kind == fmi2DoStepStatus ? fmi2OK : fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = ((component *) c)->fmu->state[FMU_TIME];
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void) c, (void) kind, (void) value;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void) c;
    *value = fmi2False;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void) c, (void) kind, (void) value;
    return fmi2Discard;
}
