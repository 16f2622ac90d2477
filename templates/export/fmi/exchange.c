/* SPDX-License-Identifier: 0BSD -- see exchange.h. */

#include "exchange.h"

#include <math.h>

/* In units of the tolerance: the violation of constraints after which an importer projects a state. Each projection
   makes an integrator of several steps start anew. */
static const double DRIFT = 100.0;

static fmu_status refuse_count(fmu_instance *fmu, size_t count)
{
    return count == (size_t) fmu->nx ? FMU_OK : fmu_fail(fmu, FMU_ERROR, "this is not the number of continuous states");
}

fmu_status fmu_set_time(fmu_instance *fmu, double t)
{
    const fmu_status status = fmu_in_mode(fmu, FMU_EVENT, FMU_CONTINUOUS);
    if (status == FMU_OK && !(fabs(t) < HUGE_VAL)) {
        return fmu_failed(fmu, FMU_ERROR, TISSERAND_ARGUMENT);
    }
    if (status == FMU_OK) {
        fmu->evaluated = fmu->evaluated && t == fmu->state[FMU_TIME];
        fmu->state[FMU_TIME] = t;
    }
    return status;
}

fmu_status fmu_set_states(fmu_instance *fmu, const double *x, size_t count)
{
    fmu_status status = fmu_in_mode(fmu, FMU_CONTINUOUS, FMU_CONTINUOUS);
    if (status == FMU_OK) {
        status = refuse_count(fmu, count);
    }
    if (status == FMU_OK) {
        fmu_copy(fmu->nx, x, fmu->x);
        fmu->evaluated = 0;
    }
    return status;
}

/* Copy values of the states after their evaluation, if that is needed. */
static fmu_status copied(fmu_instance *fmu, int evaluated, const double *from, double *to, size_t count)
{
    fmu_status status = refuse_count(fmu, count);
    if (status == FMU_OK && evaluated) {
        status = fmu_evaluate(fmu);
    }
    if (status == FMU_OK) {
        fmu_copy(fmu->nx, from, to);
    }
    return status;
}

fmu_status fmu_states(fmu_instance *fmu, double *x, size_t count)
{
    return copied(fmu, fmu->state[FMU_MODE] <= FMU_INITIALISING, fmu->x, x, count);
}

fmu_status fmu_derivatives(fmu_instance *fmu, double *xdot, size_t count)
{
    return copied(fmu, 1, fmu->xdot, xdot, count);
}

fmu_status fmu_nominals(fmu_instance *fmu, double *nominals, size_t count)
{
    return copied(fmu, 0, fmu_size, nominals, count);
}

/* The violation of the constraints, relative to the largest coordinate and velocity, or to 1 */
static int violation(fmu_instance *fmu, double *result)
{
    const tisserand_model *model = fmu->model;
    const double t = fmu->state[FMU_TIME], *q = fmu->x, *v = q + model->nq;
    const double large[2] = {fmu_largest(model->nq, q), fmu_largest(model->nv, v)};
    int code = fmu_prepare(fmu);

    *result = 0.0;
    fmu_copy(fmu->nx, fmu->x, fmu->trial);
    if (code == 0) {
        code = tisserand_normalise(model, fmu->trial);
    }
    for (int i = 0; i < model->nq; i++) {
        *result = fabs(fmu->trial[i] - q[i]) > *result ? fabs(fmu->trial[i] - q[i]) : *result;
    }
    for (int order = 0; order < 2 && code == 0 && model->scene != NULL; order++) {
        double relative;
        code = order == 0 ? model->scene->constraints(t, q, fmu->k, fmu->work)
                          : model->scene->constraint_rates(t, q, v, fmu->k, fmu->work);
        relative = fmu_largest(model->nlambda, fmu->work) / (large[order] > 1.0 ? large[order] : 1.0);
        *result = relative > *result ? relative : *result;
    }
    return code;
}

fmu_status fmu_drifted(fmu_instance *fmu, int *drifted)
{
    const fmu_status status = fmu_in_mode(fmu, FMU_CONTINUOUS, FMU_CONTINUOUS);
    double relative = 0.0;
    const int code = status == FMU_OK ? violation(fmu, &relative) : 0;

    *drifted = relative > DRIFT * fmu->state[FMU_TOLERANCE];
    return code == 0 ? status : fmu_failed(fmu, FMU_DISCARD, code);
}

fmu_status fmu_event(fmu_instance *fmu, int *changed, double *next, int *has_next)
{
    const fmu_status status = fmu_in_mode(fmu, FMU_EVENT, FMU_EVENT);
    double relative = 0.0;
    int code = status == FMU_OK ? violation(fmu, &relative) : 0;

    /* Also what is less than a drift: an input that prescribes a motion may have been set to another one. */
    *changed = code == 0 && relative > fmu->state[FMU_TOLERANCE];
    *has_next = 0;
    *next = 0.0;
    if (status != FMU_OK) {
        return status;
    }
    if (*changed) {
        fmu_copy(fmu->nx, fmu->x, fmu->trial);
        code = fmu_project(fmu, fmu->trial);
    }
    if (code != 0) {
        return fmu_failed(fmu, FMU_ERROR, code);
    }
    if (*changed) {
        fmu_copy(fmu->nx, fmu->trial, fmu->x);
        fmu->evaluated = 0;
    }
    fmu_find_break(fmu);
    *has_next = fmu->state[FMU_NEXT] < HUGE_VAL;
    *next = *has_next ? fmu->state[FMU_NEXT] : 0.0;
    return FMU_OK;
}
