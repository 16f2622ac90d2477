/* SPDX-License-Identifier: 0BSD -- see instance.h. */

#include "instance.h"
#include "derivatives.h"
#include "step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the largest coordinate: what rounding errors of constraints are at most */
static const double ROUNDING = 2e-15;

static const char *const CATEGORIES[] = {"logStatusError", "logStatusDiscard"};

static int category_of(fmu_status status)
{
    return status == FMU_ERROR ? 0 : 1;
}

fmu_status fmu_fail(fmu_instance *fmu, fmu_status status, const char *message)
{
    if (fmu->log != NULL && !fmu->silent[category_of(status)]) {
        fmu->log(fmu->owner, status, CATEGORIES[category_of(status)], message);
    }
    return status;
}

static const char *meaning(int code)
{
    switch (code) {
    case TISSERAND_PIVOT:
        return "a pivot vanished: the joints are redundant or in a singular position";
    case TISSERAND_NOT_FINITE:
        return "a value is not finite or not positive, such as a parameter, or a quaternion is zero";
    case TISSERAND_OFF:
        return "no state near this one meets the constraints";
    case TISSERAND_ARGUMENT:
        return "a time, a step or a tolerance is not valid";
    case TISSERAND_STEP_TOO_SHORT:
        return "the tolerance requires steps that are shorter than the spacing of times";
    default:
        return "the model returned an unknown code";
    }
}

fmu_status fmu_failed(fmu_instance *fmu, fmu_status status, int code)
{
    return fmu_fail(fmu, status, meaning(code));
}

fmu_status fmu_set_logging(fmu_instance *fmu, int on, size_t count, const char *const *categories)
{
    for (int i = 0; i < 2 && count == 0; i++) {
        fmu->silent[i] = !on;
    }
    for (size_t j = 0; j < count; j++) {
        int i = 0;
        while (i < 2 && strcmp(categories[j], CATEGORIES[i]) != 0) {
            i++;
        }
        if (i == 2) {
            return fmu_fail(fmu, FMU_ERROR, "there is no such category of messages");
        }
        fmu->silent[i] = !on;
    }
    return FMU_OK;
}

fmu_status fmu_in_mode(fmu_instance *fmu, int first, int last)
{
    const int mode = (int) fmu->state[FMU_MODE];
    return mode >= first && mode <= last
               ? FMU_OK
               : fmu_fail(fmu, FMU_ERROR, "this function must not be called in the present mode of the instance");
}

fmu_status fmu_enter(fmu_instance *fmu, int first, int last, int mode)
{
    const fmu_status status = fmu_in_mode(fmu, first, last);
    if (status == FMU_OK) {
        fmu->evaluated = fmu->evaluated && mode != FMU_EVENT && mode != FMU_CONTINUOUS; /* see fmu_smooth_time */
        fmu->state[FMU_MODE] = mode;
    }
    return status;
}

fmu_instance *fmu_create(const char *token, int exchange, fmu_log *log, void *owner)
{
    const tisserand_model *model = fmu_model();
    const int nx = model->nq + model->nv, nu = model->ports == NULL ? 0 : model->ports->nu;
    const int nout = model->ports == NULL ? 0 : model->ports->nout;
    const int count = FMU_FIRST + nu + model->np + 2 * nx;
    const int more = model->nk + fmu_motion_work(model) + 3 * nx + nout + model->nenergy + model->nlambda;
    const int work = tisserand_adaptive_work(model), linear = tisserand_ode_work(model);
    const int valid = token != NULL && strcmp(token, fmu_token) == 0;
    fmu_instance *fmu = valid ? (fmu_instance *) calloc(1, sizeof *fmu) : NULL;
    double *next = valid ? (double *) calloc((size_t) (count + more + work + linear + fmu_derivatives_work(model)),
                                             sizeof *next)
                         : NULL;

    if (fmu == NULL || next == NULL) {
        free(fmu);
        free(next);
        if (log != NULL) {
            log(owner, FMU_ERROR, CATEGORIES[0],
                valid ? "there is no memory for an instance"
                      : "the token (GUID) is that of another unit: its description belongs to other binaries");
        }
        return NULL;
    }
    fmu->model = model;
    fmu->nu = nu;
    fmu->nx = nx;
    fmu->nout = nout;
    fmu->exchange = exchange;
    fmu->count = count;
    fmu->state = next;
    fmu->u = next + FMU_FIRST;
    fmu->p = fmu->u + nu;
    fmu->start = fmu->p + model->np;
    fmu->x = fmu->start + nx;
    fmu->k = fmu->x + nx;
    fmu->xdot = fmu->k + model->nk + fmu_motion_work(model);
    fmu->out = fmu->xdot + nx;
    fmu->energy = fmu->out + nout;
    fmu->lambda = fmu->energy + model->nenergy;
    fmu->atol = fmu->lambda + model->nlambda;
    fmu->trial = fmu->atol + nx;
    fmu->work = fmu->trial + nx;
    fmu->ode.model = model;
    fmu->ode.k = fmu->k;
    fmu->ode.work = fmu->work + work;
    fmu->derivatives = fmu->ode.work + linear;
    fmu->log = log;
    fmu->owner = owner;
    fmu_reset(fmu);
    return fmu;
}

void fmu_free(fmu_instance *fmu)
{
    if (fmu != NULL) {
        free(fmu->state);
        free(fmu);
    }
}

void fmu_copy(int n, const double *from, double *to)
{
    if (n > 0) {
        memmove(to, from, (size_t) n * sizeof *to);
    }
}

fmu_status fmu_reset(fmu_instance *fmu)
{
    const double first[] = {0.0, HUGE_VAL, fmu_tolerance, HUGE_VAL, 0.0, FMU_INSTANTIATED};

    fmu_copy(FMU_FIRST, first, fmu->state);
    fmu_copy(fmu->nu, fmu_start, fmu->u);
    fmu->model->defaults(fmu->p);
    fmu_copy(fmu->nx, fmu_start + fmu->nu, fmu->start);
    fmu_copy(fmu->nx, fmu->start, fmu->x);
    fmu->set_up = fmu->evaluated = 0;
    return FMU_OK;
}

fmu_status fmu_set_up_experiment(fmu_instance *fmu, double tolerance, double t, double stop)
{
    const fmu_status status = fmu_in_mode(fmu, FMU_INSTANTIATED, FMU_INSTANTIATED);
    if (status == FMU_OK && !(fabs(t) < HUGE_VAL && tolerance >= 0.0 && tolerance < HUGE_VAL && stop >= t)) {
        return fmu_failed(fmu, FMU_ERROR, TISSERAND_ARGUMENT);
    }
    if (status == FMU_OK) {
        fmu->state[FMU_TIME] = t;
        fmu->state[FMU_STOP] = stop;
        fmu->state[FMU_TOLERANCE] = tolerance > 0.0 ? tolerance : fmu_tolerance;
        fmu->evaluated = 0;
    }
    return status;
}

fmu_status fmu_enter_initialisation(fmu_instance *fmu)
{
    return fmu_enter(fmu, FMU_INSTANTIATED, FMU_INSTANTIATED, FMU_INITIALISING);
}

fmu_status fmu_exit_initialisation(fmu_instance *fmu)
{
    fmu_status status = fmu_in_mode(fmu, FMU_INITIALISING, FMU_INITIALISING);
    if (status == FMU_OK) {
        status = fmu_evaluate(fmu);
    }
    if (status == FMU_OK) {
        fmu_find_break(fmu);
        fmu->state[FMU_MODE] = fmu->exchange ? FMU_EVENT : FMU_BETWEEN_STEPS;
    }
    return status;
}

double fmu_largest(int n, const double *x)
{
    double result = 0.0;
    for (int i = 0; i < n; i++) {
        result = fabs(x[i]) > result ? fabs(x[i]) : result;
    }
    return result;
}

double fmu_consistent(const fmu_instance *fmu, const double *x)
{
    const double rounding = ROUNDING * fmu_largest(fmu->model->nq, x);
    return rounding > FMU_CONSISTENT ? rounding : FMU_CONSISTENT;
}

int fmu_prepare(fmu_instance *fmu)
{
    const tisserand_model *model = fmu->model;
    int code = 0;

    if (!fmu->set_up) {
        code = model->setup(fmu->p, fmu->k);
        fmu->set_up = code == 0;
    }
    fmu_copy(fmu->nu, fmu->u, fmu->k + model->nk - fmu->nu);
    return code;
}

int fmu_project(fmu_instance *fmu, double *x)
{
    const tisserand_model *model = fmu->model;
    const double tolerance = fmu_consistent(fmu, x);
    tisserand_fixed_counts counts = {0, 0, 0, 0};
    int code = fmu_prepare(fmu);

    code = code != 0 ? code : tisserand_normalise(model, x);
    return code != 0 ? code
                     : tisserand_project(model, fmu->state[FMU_TIME], fmu->k, tolerance, x, x + model->nq, fmu->work, &counts);
}

void fmu_find_break(fmu_instance *fmu)
{
    fmu->state[FMU_NEXT] = HUGE_VAL;
    for (int i = fmu_breaks - 1; i >= 0 && fmu_break_times[i] > fmu->state[FMU_TIME]; i--) {
        fmu->state[FMU_NEXT] = fmu_break_times[i];
    }
}

double fmu_smooth_time(const fmu_instance *fmu)
{
    const double t = fmu->state[FMU_TIME];
    return fmu->state[FMU_MODE] == FMU_CONTINUOUS && t == fmu->state[FMU_NEXT] ? nextafter(t, -HUGE_VAL) : t;
}

fmu_status fmu_evaluate(fmu_instance *fmu)
{
    const tisserand_model *model = fmu->model;
    const int mode = (int) fmu->state[FMU_MODE];
    int code;

    if (fmu->evaluated) {
        return FMU_OK;
    }
    fmu->linearised = 0;
    if (mode <= FMU_INITIALISING) {
        fmu_copy(fmu->nx, fmu->start, fmu->x);
        code = fmu_project(fmu, fmu->x);
    } else {
        code = fmu_prepare(fmu);
    }
    if (code == 0) {
        code = tisserand_ode_evaluate(&fmu->ode, fmu_smooth_time(fmu), fmu->x, fmu->xdot, fmu->lambda, fmu->out);
    }
    if (code == 0) {
        code = model->energy(fmu->x, fmu->x + model->nq, fmu->k, fmu->energy);
    }
    fmu->evaluated = code == 0;
    /* An importer may try another state, but not before the simulation. */
    return code == 0 ? FMU_OK
                     : fmu_failed(fmu, mode >= FMU_EVENT && mode <= FMU_BETWEEN_STEPS ? FMU_DISCARD : FMU_ERROR, code);
}
