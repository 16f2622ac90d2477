/* SPDX-License-Identifier: 0BSD -- see instance.h. */

#include "instance.h"
#include "derivatives.h"
#include "motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Positions and velocities meet the constraints up to this (m, rad), or up to rounding errors, after each step. */
static const double CONSISTENT = 1e-12, ROUNDING = 2e-15;

/* In units of the tolerance: the violation of constraints after which an importer projects a state. Each projection
   makes an integrator of several steps start anew. */
static const double DRIFT = 100.0;

fmu_status fmu_fail(fmu_instance *fmu, fmu_status status, const char *message)
{
    if (fmu->log != NULL) {
        fmu->log(fmu->owner, status, message);
    }
    return status;
}

/* What a code of the model or of an integration means */
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

fmu_status fmu_in_mode(fmu_instance *fmu, int first, int last)
{
    const int mode = (int) fmu->state[FMU_MODE];
    return mode >= first && mode <= last
               ? FMU_OK
               : fmu_fail(fmu, FMU_ERROR, "this function must not be called in the present mode of the instance");
}

fmu_instance *fmu_create(const char *token, void (*log)(void *, fmu_status, const char *), void *owner)
{
    const tisserand_model *model = fmu_model();
    const int nx = model->nq + model->nv, nu = model->ports == NULL ? 0 : model->ports->nu;
    const int nout = model->ports == NULL ? 0 : model->ports->nout;
    const int count = FMU_FIRST + nu + model->np + 2 * nx;
    const int more = model->nk + fmu_motion_work(model) + 3 * nx + nout + model->nenergy + model->nlambda;
    fmu_instance *fmu;
    double *next;

    if (token == NULL || strcmp(token, fmu_token) != 0) {
        if (log != NULL) {
            log(owner, FMU_ERROR, "the token (GUID) is that of another unit: its description belongs to other binaries");
        }
        return NULL;
    }
    fmu = (fmu_instance *) calloc(1, sizeof *fmu);
    next = (double *) calloc((size_t) (count + more + tisserand_adaptive_work(model) + tisserand_ode_work(model)
                                       + fmu_derivatives_work(model)),
                             sizeof *next);
    if (fmu == NULL || next == NULL) {
        free(fmu);
        free(next);
        if (log != NULL) {
            log(owner, FMU_ERROR, "there is no memory for an instance");
        }
        return NULL;
    }
    fmu->model = model;
    fmu->nu = nu;
    fmu->nx = nx;
    fmu->nout = nout;
    fmu->count = count;
    fmu->variables = 1 + nu + model->np + 2 * nx + nout + model->nenergy + model->nlambda;
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
    fmu->ode.work = fmu->work + tisserand_adaptive_work(model);
    fmu->derivatives = fmu->ode.work + tisserand_ode_work(model);
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

static void copy(int n, const double *from, double *to)
{
    if (n > 0) {
        memmove(to, from, (size_t) n * sizeof *to);
    }
}

void fmu_reset(fmu_instance *fmu)
{
    fmu->state[FMU_TIME] = 0.0;
    fmu->state[FMU_TOLERANCE] = fmu_tolerance;
    fmu->state[FMU_STEP] = 0.0;
    fmu->state[FMU_MODE] = FMU_INSTANTIATED;
    copy(fmu->nu, fmu_start, fmu->u);
    fmu->model->defaults(fmu->p);
    copy(fmu->nx, fmu_start + fmu->nu, fmu->start);
    copy(fmu->nx, fmu->start, fmu->x);
    fmu->set_up = fmu->evaluated = 0;
}

static double largest(int n, const double *x)
{
    double result = 0.0;
    for (int i = 0; i < n; i++) {
        result = fabs(x[i]) > result ? fabs(x[i]) : result;
    }
    return result;
}

/* Make k that of the parameters and the inputs. */
static int prepare(fmu_instance *fmu)
{
    const tisserand_model *model = fmu->model;
    int code = 0;

    if (!fmu->set_up) {
        code = model->setup(fmu->p, fmu->k);
        fmu->set_up = code == 0;
    }
    copy(fmu->nu, fmu->u, fmu->k + model->nk - fmu->nu);
    return code;
}

/* Project x onto the constraints up to a tolerance. */
static int project(fmu_instance *fmu, double tolerance, double *x)
{
    const tisserand_model *model = fmu->model;
    const double rounding = ROUNDING * largest(model->nq, x);
    tisserand_fixed_counts counts = {0, 0, 0, 0};
    int code = prepare(fmu);

    if (code == 0) {
        code = tisserand_normalise(model, x);
    }
    if (code == 0) {
        code = tisserand_project(model, fmu->state[FMU_TIME], fmu->k, tolerance > rounding ? tolerance : rounding, x,
                                 x + model->nq, fmu->work, &counts);
    }
    return code;
}

fmu_status fmu_evaluate(fmu_instance *fmu)
{
    const tisserand_model *model = fmu->model;
    int code = 0;

    if (fmu->evaluated) {
        return FMU_OK;
    }
    fmu->linearised = 0;
    if (fmu->state[FMU_MODE] <= FMU_INITIALISING) {
        copy(fmu->nx, fmu->start, fmu->x);
        code = project(fmu, CONSISTENT, fmu->x);
    } else {
        code = prepare(fmu);
    }
    if (code == 0) {
        code = tisserand_ode_evaluate(&fmu->ode, fmu->state[FMU_TIME], fmu->x, fmu->xdot, fmu->lambda, fmu->out);
    }
    if (code == 0) {
        code = model->energy(fmu->x, fmu->x + model->nq, fmu->k, fmu->energy);
    }
    fmu->evaluated = code == 0;
    /* An importer may try another state, but not before the simulation. */
    return code == 0 ? FMU_OK
                     : fmu_fail(fmu, fmu->state[FMU_MODE] == FMU_RUNNING ? FMU_DISCARD : FMU_ERROR, meaning(code));
}

/* The place of the value of a reference */
static double *place(fmu_instance *fmu, unsigned reference)
{
    const tisserand_model *model = fmu->model;
    double *const parts[] = {fmu->state + FMU_TIME, fmu->u, fmu->p, fmu->x, fmu->xdot, fmu->out, fmu->energy, fmu->lambda};
    const int sizes[] = {1, fmu->nu, model->np, fmu->nx, fmu->nx, fmu->nout, model->nenergy, model->nlambda};
    unsigned first = 0;

    for (int i = 0; i < (int) (sizeof sizes / sizeof *sizes); i++) {
        if (reference < first + (unsigned) sizes[i]) {
            return parts[i] + (reference - first);
        }
        first += (unsigned) sizes[i];
    }
    return NULL;
}

fmu_status fmu_get(fmu_instance *fmu, const unsigned *references, size_t count, double *values)
{
    const unsigned given = (unsigned) (1 + fmu->nu + fmu->model->np);

    for (size_t i = 0; i < count; i++) {
        const double *value = place(fmu, references[i]);
        if (value == NULL) {
            return fmu_fail(fmu, FMU_ERROR, "there is no real variable with this value reference");
        }
        if (references[i] >= given) {
            const fmu_status status = fmu_evaluate(fmu);
            if (status != FMU_OK) {
                return status;
            }
        }
        values[i] = *value;
    }
    return FMU_OK;
}

fmu_status fmu_set(fmu_instance *fmu, const unsigned *references, size_t count, const double *values)
{
    for (size_t i = 0; i < count; i++) {
        double *value = references[i] == 0 ? NULL : place(fmu, references[i]);
        if (!(fabs(values[i]) < HUGE_VAL)) {
            return fmu_fail(fmu, FMU_ERROR, "a value that is set is not finite");
        }
        if (value >= fmu->x && value < fmu->x + fmu->nx && fmu->state[FMU_MODE] <= FMU_INITIALISING) {
            value += fmu->start - fmu->x;
        } else if (value == NULL || value < fmu->u || value >= fmu->start) {
            return fmu_fail(fmu, FMU_ERROR, "inputs and parameters can be set, and states before the simulation; "
                                            "no other variable");
        }
        if (*value != values[i]) {
            *value = values[i];
            fmu->evaluated = 0;
            fmu->set_up = fmu->set_up && !(value >= fmu->p && value < fmu->start);
        }
    }
    return FMU_OK;
}

fmu_status fmu_initialise(fmu_instance *fmu, double t, double tolerance)
{
    if (!(fabs(t) < HUGE_VAL && tolerance >= 0.0 && tolerance < HUGE_VAL)) {
        return fmu_fail(fmu, FMU_ERROR, meaning(TISSERAND_ARGUMENT));
    }
    fmu->state[FMU_TIME] = t;
    fmu->state[FMU_MODE] = FMU_INITIALISING;
    if (tolerance > 0.0) {
        fmu->state[FMU_TOLERANCE] = tolerance;
    }
    fmu->evaluated = 0;
    return FMU_OK;
}

fmu_status fmu_begin(fmu_instance *fmu)
{
    const fmu_status status = fmu_evaluate(fmu);
    if (status == FMU_OK) {
        fmu->state[FMU_MODE] = FMU_RUNNING;
    }
    return status;
}

fmu_status fmu_set_time(fmu_instance *fmu, double t)
{
    if (!(fabs(t) < HUGE_VAL)) {
        return fmu_fail(fmu, FMU_ERROR, meaning(TISSERAND_ARGUMENT));
    }
    fmu->evaluated = fmu->evaluated && t == fmu->state[FMU_TIME];
    fmu->state[FMU_TIME] = t;
    return FMU_OK;
}

fmu_status fmu_set_states(fmu_instance *fmu, const double *x, size_t count)
{
    if (count != (size_t) fmu->nx) {
        return fmu_fail(fmu, FMU_ERROR, "this is not the number of continuous states");
    }
    copy(fmu->nx, x, fmu->x);
    fmu->evaluated = 0;
    return FMU_OK;
}

/* Copy values of the states after their evaluation, if that is needed. */
static fmu_status of_states(fmu_instance *fmu, int evaluated, const double *from, double *to, size_t count)
{
    const fmu_status status = evaluated ? fmu_evaluate(fmu) : FMU_OK;
    if (count != (size_t) fmu->nx) {
        return fmu_fail(fmu, FMU_ERROR, "this is not the number of continuous states");
    }
    if (status == FMU_OK) {
        copy(fmu->nx, from, to);
    }
    return status;
}

fmu_status fmu_states(fmu_instance *fmu, double *x, size_t count)
{
    return of_states(fmu, fmu->state[FMU_MODE] <= FMU_INITIALISING, fmu->x, x, count);
}

fmu_status fmu_derivatives(fmu_instance *fmu, double *xdot, size_t count)
{
    return of_states(fmu, 1, fmu->xdot, xdot, count);
}

/* The violation of the constraints, relative to the largest coordinate and velocity, or to 1 */
static int violation(fmu_instance *fmu, double *result)
{
    const tisserand_model *model = fmu->model;
    const double t = fmu->state[FMU_TIME], *q = fmu->x, *v = q + model->nq;
    const double large[2] = {largest(model->nq, q), largest(model->nv, v)};
    int code = prepare(fmu);

    *result = 0.0;
    copy(fmu->nx, fmu->x, fmu->trial);
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
        relative = largest(model->nlambda, fmu->work) / (large[order] > 1.0 ? large[order] : 1.0);
        *result = relative > *result ? relative : *result;
    }
    return code;
}

fmu_status fmu_drifted(fmu_instance *fmu, int *drifted)
{
    double relative;
    const int code = violation(fmu, &relative);

    *drifted = relative > DRIFT * fmu->state[FMU_TOLERANCE];
    return code == 0 ? FMU_OK : fmu_fail(fmu, FMU_DISCARD, meaning(code));
}

fmu_status fmu_event(fmu_instance *fmu, int *changed, double *next, int *has_next)
{
    double relative;
    int code = violation(fmu, &relative);

    /* Also what is less than a drift: an input that prescribes a motion may have been set to another one. */
    *changed = code == 0 && relative > fmu->state[FMU_TOLERANCE];
    if (*changed) {
        copy(fmu->nx, fmu->x, fmu->trial);
        code = project(fmu, CONSISTENT, fmu->trial);
    }
    if (code != 0) {
        return fmu_fail(fmu, FMU_ERROR, meaning(code));
    }
    if (*changed) {
        copy(fmu->nx, fmu->trial, fmu->x);
        fmu->evaluated = 0;
    }
    *has_next = 0;
    *next = 0.0;
    for (int i = 0; i < fmu_breaks && !*has_next; i++) {
        *has_next = fmu_break_times[i] > fmu->state[FMU_TIME];
        *next = fmu_break_times[i];
    }
    return FMU_OK;
}

/* The next end of a smooth part of the motion */
static double smooth_end(const fmu_instance *fmu, double t, double end, int *is_break)
{
    *is_break = 0;
    for (int i = 0; i < fmu_breaks; i++) {
        if (fmu_break_times[i] > t && fmu_break_times[i] <= end) {
            *is_break = 1;
            return fmu_break_times[i];
        }
    }
    return end;
}

fmu_status fmu_step(fmu_instance *fmu, double t, double step)
{
    const tisserand_model *model = fmu->model;
    const double now = fmu->state[FMU_TIME], end = t + step, rtol = fmu->state[FMU_TOLERANCE];
    const double consistent = CONSISTENT > ROUNDING * largest(model->nq, fmu->x) ? CONSISTENT
                                                                                : ROUNDING * largest(model->nq, fmu->x);
    tisserand_adaptive *s = &fmu->solver;
    tisserand_adaptive_options options;
    int code;

    if (!(step > 0.0 && end < HUGE_VAL && fabs(t - now) <= 1e-9 * (step + fabs(now)))) {
        return fmu_fail(fmu, FMU_ERROR, "a step begins at the end of the one before, and has a positive length");
    }
    options.rtol = rtol;
    options.atol = fmu->atol;
    options.consistent = consistent;
    options.drift = options.step_max = 0.0;
    options.steps_max = 0;
    for (int i = 0; i < fmu->nx; i++) {
        fmu->atol[i] = rtol * fmu_size[i];
    }
    code = prepare(fmu);
    if (code == 0) {
        fmu_motion_begin(fmu);
        code = tisserand_adaptive_start(s, &fmu->moving, &options, now, end > now ? end : now, fmu->k, fmu->x,
                                        fmu->x + model->nq, fmu->work);
    }
    if (code != 0) {
        return fmu_fail(fmu, FMU_DISCARD, meaning(code));
    }
    if (fmu->state[FMU_STEP] > 0.0) { /* that of the last step; inputs that jump make the integrator repeat it */
        s->step = fmu->state[FMU_STEP];
    }
    while (code == 0 && s->t < end) {
        int is_break;
        const double next = smooth_end(fmu, s->t, end, &is_break);
        while (code == 0 && s->t < next) {
            code = tisserand_adaptive_step(s, next, is_break);
        }
        if (code == 0 && is_break && next < end) {
            code = tisserand_adaptive_restart(s, end);
        }
    }
    copy(fmu->nx, s->y, fmu->x);
    fmu->state[FMU_TIME] = s->t;
    fmu->state[FMU_STEP] = code == 0 ? s->step : 0.0;
    fmu->evaluated = 0;
    return code == 0 ? FMU_OK : fmu_fail(fmu, FMU_DISCARD, meaning(code));
}

/* ---- stored states ---- */

static const int ORDER = 0x01020304; /* of the bytes of a number on this machine */
enum { HEADER = 64 };

size_t fmu_state_size(const fmu_instance *fmu)
{
    return HEADER + (size_t) fmu->count * sizeof(double);
}

void fmu_store(const fmu_instance *fmu, unsigned char *bytes)
{
    memset(bytes, 0, HEADER);
    memcpy(bytes, &ORDER, sizeof ORDER);
    memcpy(bytes + sizeof ORDER, &fmu->count, sizeof fmu->count);
    memcpy(bytes + 8, fmu_token, strlen(fmu_token));
    memcpy(bytes + HEADER, fmu->state, (size_t) fmu->count * sizeof(double));
}

fmu_status fmu_restore(fmu_instance *fmu, const unsigned char *bytes, size_t size)
{
    if (bytes == NULL || size != fmu_state_size(fmu) || memcmp(bytes, &ORDER, sizeof ORDER) != 0
        || memcmp(bytes + sizeof ORDER, &fmu->count, sizeof fmu->count) != 0
        || memcmp(bytes + 8, fmu_token, strlen(fmu_token) + 1) != 0) {
        return fmu_fail(fmu, FMU_ERROR, "this is a state of another unit, of another version of it, or of another machine");
    }
    memcpy(fmu->state, bytes + HEADER, (size_t) fmu->count * sizeof(double));
    fmu->set_up = fmu->evaluated = 0;
    return FMU_OK;
}
