/*
 * SPDX-License-Identifier: 0BSD
 *
 * The functions of FMI 3.0 for model exchange and co-simulation, around an instance; see instance.h. Those for what this unit
 * has not are in fmi3_absent.c.
 */

#include "component3.h"
#include "derivatives.h"
#include "exchange.h"
#include "step.h"
#include "stored.h"
#include "variables.h"

#include <math.h>
#include <stdlib.h>

static void log_message(void *owner, fmu_status status, const char *category, const char *message)
{
    const component *c = (const component *) owner;
    if (c->log != NULL) {
        c->log(c->environment, (fmi3Status) status, category, message);
    }
}

FMI3_EXPORT const char *FMI3(GetVersion)(void)
{
    return "3.0";
}

FMI3_EXPORT fmi3Status FMI3(SetDebugLogging)(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    return (fmi3Status) fmu_set_logging(of(c), on, count, categories);
}

/* ---- instances ---- */

static fmi3Instance instance(fmi3String token, int exchange, fmi3InstanceEnvironment environment,
                             fmi3LogMessageCallback log)
{
    component *c = (component *) calloc(1, sizeof *c);
    if (c == NULL) {
        return NULL;
    }
    c->environment = environment;
    c->log = log;
    c->fmu = fmu_create(token, exchange, log_message, c);
    if (c->fmu == NULL) {
        free(c);
        return NULL;
    }
    return c;
}

FMI3_EXPORT fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                        fmi3Boolean visible, fmi3Boolean logging,
                                                        fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void) name, (void) resources, (void) visible, (void) logging; /* no messages are for debugging alone */
    return instance(token, 1, environment, log);
}

FMI3_EXPORT fmi3Instance FMI3(InstantiateCoSimulation)(
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
    return instance(token, 0, environment, log);
}

FMI3_EXPORT void FMI3(FreeInstance)(fmi3Instance c)
{
    if (c != NULL) {
        fmu_free(of(c));
        free(c);
    }
}

FMI3_EXPORT fmi3Status FMI3(EnterInitializationMode)(fmi3Instance c, fmi3Boolean tolerance_defined,
                                                     fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
                                                     fmi3Float64 stop)
{
    const fmu_status status = fmu_set_up_experiment(of(c), tolerance_defined ? tolerance : 0.0, start,
                                                    stop_defined ? stop : HUGE_VAL);
    return (fmi3Status) (status == FMU_OK ? fmu_enter_initialisation(of(c)) : status);
}

FMI3_EXPORT fmi3Status FMI3(ExitInitializationMode)(fmi3Instance c)
{
    return (fmi3Status) fmu_exit_initialisation(of(c));
}

FMI3_EXPORT fmi3Status FMI3(Terminate)(fmi3Instance c)
{
    return (fmi3Status) fmu_enter(of(c), FMU_EVENT, FMU_BETWEEN_STEPS, FMU_TERMINATED);
}

FMI3_EXPORT fmi3Status FMI3(Reset)(fmi3Instance c)
{
    return (fmi3Status) fmu_reset(of(c));
}

/* ---- values of variables; all are of the type Float64 ---- */

FMI3_EXPORT fmi3Status FMI3(GetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                        fmi3Float64 values[], size_t value_count)
{
    return value_count == count ? (fmi3Status) fmu_get(of(c), vr, count, values)
                                : refuse(c, "every variable has one value");
}

FMI3_EXPORT fmi3Status FMI3(SetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                        const fmi3Float64 values[], size_t value_count)
{
    return value_count == count ? (fmi3Status) fmu_set(of(c), vr, count, values)
                                : refuse(c, "every variable has one value");
}

/* ---- stored states ---- */

FMI3_EXPORT fmi3Status FMI3(GetFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    return (fmi3Status) fmu_get_state(of(c), state);
}

FMI3_EXPORT fmi3Status FMI3(SetFMUState)(fmi3Instance c, fmi3FMUState state)
{
    return (fmi3Status) fmu_set_state(of(c), state);
}

FMI3_EXPORT fmi3Status FMI3(FreeFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    (void) c;
    return (fmi3Status) fmu_free_state(state);
}

FMI3_EXPORT fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    (void) state;
    *size = fmu_state_size(of(c));
    return fmi3OK;
}

FMI3_EXPORT fmi3Status FMI3(SerializeFMUState)(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    return (fmi3Status) fmu_serialise(of(c), state, bytes, size);
}

FMI3_EXPORT fmi3Status FMI3(DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    return (fmi3Status) fmu_deserialise(of(c), bytes, size, state);
}

/* ---- partial derivatives ---- */

FMI3_EXPORT fmi3Status FMI3(GetDirectionalDerivative)(fmi3Instance c, const fmi3ValueReference unknowns[],
                                                      size_t unknown_count, const fmi3ValueReference knowns[],
                                                      size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                      fmi3Float64 sensitivity[], size_t sensitivity_count)
{
    if (seed_count != known_count || sensitivity_count != unknown_count) {
        return refuse(c, "every variable has one value");
    }
    return (fmi3Status) fmu_directional(of(c), unknowns, unknown_count, knowns, known_count, seed, sensitivity);
}

FMI3_EXPORT fmi3Status FMI3(GetAdjointDerivative)(fmi3Instance c, const fmi3ValueReference unknowns[],
                                                  size_t unknown_count, const fmi3ValueReference knowns[],
                                                  size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                  fmi3Float64 sensitivity[], size_t sensitivity_count)
{
    if (seed_count != unknown_count || sensitivity_count != known_count) {
        return refuse(c, "every variable has one value");
    }
    return (fmi3Status) fmu_adjoint(of(c), unknowns, unknown_count, knowns, known_count, seed, sensitivity);
}

/* ---- events and model exchange ---- */

FMI3_EXPORT fmi3Status FMI3(EnterEventMode)(fmi3Instance c)
{
    return (fmi3Status) fmu_enter(of(c), FMU_CONTINUOUS, FMU_CONTINUOUS, FMU_EVENT);
}

FMI3_EXPORT fmi3Status FMI3(EvaluateDiscreteStates)(fmi3Instance c)
{
    return (fmi3Status) fmu_in_mode(of(c), FMU_INITIALISING, FMU_EVENT); /* there are none */
}

FMI3_EXPORT fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance c, fmi3Boolean *needs_update, fmi3Boolean *terminate,
                                                  fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                                  fmi3Boolean *next_defined, fmi3Float64 *next)
{
    int changed, has_next;
    const fmu_status status = fmu_event(of(c), &changed, next, &has_next);

    *needs_update = *terminate = *nominals_changed = false;
    *values_changed = changed != 0;
    *next_defined = has_next != 0;
    return (fmi3Status) status;
}

FMI3_EXPORT fmi3Status FMI3(EnterContinuousTimeMode)(fmi3Instance c)
{
    return (fmi3Status) fmu_enter(of(c), FMU_EVENT, FMU_EVENT, FMU_CONTINUOUS);
}

FMI3_EXPORT fmi3Status FMI3(CompletedIntegratorStep)(fmi3Instance c, fmi3Boolean no_state_before,
                                                     fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
{
    int drifted;
    const fmu_status status = fmu_drifted(of(c), &drifted);

    (void) no_state_before;
    *terminate = false;
    *enter_event_mode = drifted != 0;
    return (fmi3Status) status;
}

FMI3_EXPORT fmi3Status FMI3(SetTime)(fmi3Instance c, fmi3Float64 time)
{
    return (fmi3Status) fmu_set_time(of(c), time);
}

FMI3_EXPORT fmi3Status FMI3(SetContinuousStates)(fmi3Instance c, const fmi3Float64 x[], size_t count)
{
    return (fmi3Status) fmu_set_states(of(c), x, count);
}

FMI3_EXPORT fmi3Status FMI3(GetContinuousStateDerivatives)(fmi3Instance c, fmi3Float64 xdot[], size_t count)
{
    return (fmi3Status) fmu_derivatives(of(c), xdot, count);
}

FMI3_EXPORT fmi3Status FMI3(GetContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t count)
{
    return (fmi3Status) fmu_states(of(c), x, count);
}

FMI3_EXPORT fmi3Status FMI3(GetNominalsOfContinuousStates)(fmi3Instance c, fmi3Float64 nominals[], size_t count)
{
    return (fmi3Status) fmu_nominals(of(c), nominals, count);
}

FMI3_EXPORT fmi3Status FMI3(GetNumberOfContinuousStates)(fmi3Instance c, size_t *count)
{
    *count = (size_t) of(c)->nx;
    return fmi3OK;
}

/* ---- co-simulation ---- */

FMI3_EXPORT fmi3Status FMI3(DoStep)(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_state_before,
                                    fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                                    fmi3Float64 *last_time)
{
    const fmu_status status = fmu_step(of(c), time, step);

    (void) no_state_before;
    *event_needed = *terminate = *early_return = false;
    *last_time = of(c)->state[FMU_TIME];
    return (fmi3Status) status;
}
