/* SPDX-License-Identifier: 0BSD -- see motion.h. */

#include "motion.h"

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

void fmu_motion_begin(fmu_instance *fmu)
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
