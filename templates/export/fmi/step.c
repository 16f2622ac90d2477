/* SPDX-License-Identifier: 0BSD -- see step.h. */

#include "step.h"

#include <math.h>

int fmu_motion_work(const tisserand_model *model)
{
    return 1 + (model->ports == NULL ? 0 : model->ports->nu);
}

/* Set the motions in k for the time t. Behind the constants are the time at which inputs were set, and their values. */
static const tisserand_model *at(double t, const double *k)
{
    const tisserand_model *model = fmu_model();
    const int nu = model->ports == NULL ? 0 : model->ports->nu;
    const double *set = k + model->nk + 1;
    double *u = (double *) k + model->nk - nu; /* k belongs to an instance */
    const double s = t - k[model->nk];

    for (int i = 0; i + 2 < nu; i++) {
        if (fmu_orders[i + 1] == 1) {
            u[i] = set[i] + s * (set[i + 1] + 0.5 * s * set[i + 2]);
            u[i + 1] = set[i + 1] + s * set[i + 2];
        }
    }
    return model;
}

static int accel(double t, const double *q, const double *v, const double *k, double *vdot)
{
    return at(t, k)->accel(t, q, v, k, vdot);
}

static int constraints(double t, const double *q, const double *k, double *g)
{
    return at(t, k)->scene->constraints(t, q, k, g);
}

static int constraint_rates(double t, const double *q, const double *v, const double *k, double *gdot)
{
    return at(t, k)->scene->constraint_rates(t, q, v, k, gdot);
}

static int project_velocity(double t, const double *q, const double *k, const double *r, double *dv)
{
    return at(t, k)->scene->project_velocity(t, q, k, r, dv);
}

/* Make the model of a step, whose functions set the inputs in k for the time with which they are called. */
static void begin_motion(fmu_instance *fmu)
{
    const tisserand_model *model = fmu->model;
    double *behind = fmu->k + model->nk;

    behind[0] = fmu->state[FMU_TIME];
    for (int i = 0; i < fmu->nu; i++) {
        behind[1 + i] = fmu->u[i];
    }
    fmu->moving = *model;
    fmu->moving.accel = accel;
    if (model->scene != NULL) {
        fmu->moving_scene = *model->scene;
        fmu->moving_scene.constraints = constraints;
        fmu->moving_scene.constraint_rates = constraint_rates;
        fmu->moving_scene.project_velocity = project_velocity;
        fmu->moving.scene = &fmu->moving_scene;
    }
}

/* The next end of a smooth part of the motion */
static double smooth_end(double t, double end, int *is_break)
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

/* Why a step must not be made; NULL if it may be */
static const char *wrong(const fmu_instance *fmu, double t, double step)
{
    const double now = fmu->state[FMU_TIME], end = t + step, near = 1e-9 * (step + fabs(now));

    if (!(step > 0.0 && end < HUGE_VAL && fabs(t - now) <= near)) {
        return "a step begins at the end of the one before, and has a positive length";
    }
    return end > fmu->state[FMU_STOP] + near ? "a step must not pass the stop time of the experiment" : NULL;
}

fmu_status fmu_step(fmu_instance *fmu, double t, double step)
{
    const double now = fmu->state[FMU_TIME], end = t + step;
    const fmu_status status = fmu_in_mode(fmu, FMU_BETWEEN_STEPS, FMU_BETWEEN_STEPS);
    const char *refused = status == FMU_OK ? wrong(fmu, t, step) : NULL;
    tisserand_adaptive *s = &fmu->solver;
    tisserand_adaptive_options options;
    int code;

    if (status != FMU_OK || refused != NULL) {
        return status != FMU_OK ? status : fmu_fail(fmu, FMU_ERROR, refused);
    }
    options.rtol = fmu->state[FMU_TOLERANCE];
    options.atol = fmu->atol;
    options.consistent = fmu_consistent(fmu, fmu->x);
    options.drift = options.step_max = 0.0;
    options.steps_max = 0;
    for (int i = 0; i < fmu->nx; i++) {
        fmu->atol[i] = options.rtol * fmu_size[i];
    }
    code = fmu_prepare(fmu);
    if (code == 0) {
        begin_motion(fmu);
        code = tisserand_adaptive_start(s, &fmu->moving, &options, now, end > now ? end : now, fmu->k, fmu->x,
                                        fmu->x + fmu->model->nq, fmu->work);
    }
    if (code != 0) {
        return fmu_failed(fmu, FMU_DISCARD, code);
    }
    if (fmu->state[FMU_LENGTH] > 0.0) { /* that of the last step; inputs that jump make the integrator repeat it */
        s->step = fmu->state[FMU_LENGTH];
    }
    while (code == 0 && s->t < end) {
        int is_break;
        const double next = smooth_end(s->t, end, &is_break);
        while (code == 0 && s->t < next) {
            code = tisserand_adaptive_step(s, next, is_break);
        }
        if (code == 0 && is_break && next < end) {
            code = tisserand_adaptive_restart(s, end);
        }
    }
    fmu_copy(fmu->nx, s->y, fmu->x);
    fmu->state[FMU_TIME] = s->t;
    fmu->state[FMU_LENGTH] = code == 0 ? s->step : 0.0;
    fmu->evaluated = 0;
    return code == 0 ? FMU_OK : fmu_failed(fmu, FMU_DISCARD, code);
}
