/* SPDX-License-Identifier: 0BSD -- see ode.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "ode.h"

#include <stddef.h>
#include <string.h>

/* The parts of work. Its form is that of index 1 of a scene, and the one of a body: F = [qdot - rates; M vdot + h - G^T
   lambda; G vdot - gamma] = 0 with the state z = [q; v; lambda]. */
typedef struct {
    double *z, *zdot; /* nq + nv + nlambda each */
    double *by_state; /* values of dF/dz */
    double *by_parameter;
    double *dF; /* the rows of parameter_jacobian, more than z has */
    double *x;  /* nv + nlambda */
} parts;


/* The form of that name; a body has a single form, which is part of the model. */
static int find_form(const tisserand_model *model, const char *name, tisserand_dae *form)
{
    if (model->scene == NULL) {
        const tisserand_dae own = {"ode", model->nq + model->nv, model->jacobian_pattern, model->residual, model->jacobian};
        *form = own;
        return 0;
    }
    for (int i = 0; i < model->scene->nforms; i++) {
        if (strcmp(model->scene->forms[i].name, name) == 0) {
            *form = model->scene->forms[i];
            return 0;
        }
    }
    return TISSERAND_NO_SENSITIVITIES;
}

/* The largest number of values of a form's iteration matrix. */
static int most_values(const tisserand_model *model)
{
    int most = model->jacobian_pattern->nnz;
    for (int i = 0; model->scene != NULL && i < model->scene->nforms; i++) {
        const int nnz = model->scene->forms[i].pattern->nnz;
        most = nnz > most ? nnz : most;
    }
    return most;
}

/* z of the stabilised form has nlambda elements more. */
static int state_size(const tisserand_model *model)
{
    return model->nq + model->nv + 2 * model->nlambda;
}

static int rows(const tisserand_model *model)
{
    const int size = state_size(model), others = model->parameter_pattern == NULL ? 0 : model->parameter_pattern->rows;
    return size > others ? size : others;
}

int tisserand_ode_work(const tisserand_model *model)
{
    const int values = model->parameter_pattern == NULL ? 0 : model->parameter_pattern->nnz;
    return 2 * state_size(model) + most_values(model) + values + rows(model) + model->nv + model->nlambda;
}

static parts parts_of(const tisserand_ode *ode)
{
    const tisserand_model *model = ode->model;
    parts own;
    own.z = ode->work;
    own.zdot = own.z + state_size(model);
    own.by_state = own.zdot + state_size(model);
    own.by_parameter = own.by_state + most_values(model);
    own.dF = own.by_parameter + (model->parameter_pattern == NULL ? 0 : model->parameter_pattern->nnz);
    own.x = own.dF + rows(model);
    return own;
}

/* vdot and lambda */
static int accelerations(const tisserand_ode *ode, double t, const double *y, double *vdot, double *lambda)
{
    const tisserand_model *model = ode->model;
    return model->scene == NULL ? model->accel(t, y, y + model->nq, ode->k, vdot)
                                : model->scene->solve(t, y, y + model->nq, ode->k, vdot, lambda);
}

int tisserand_ode_rates(const tisserand_ode *ode, double t, const double *y, double *ydot)
{
    const tisserand_model *model = ode->model;
    const int code = model->rates(y, y + model->nq, ode->k, ydot);
    return code != 0 ? code : accelerations(ode, t, y, ydot + model->nq, ode->work);
}

/* dF += the product of columns [first, first + count) of a matrix and a vector, or of one column and 1 if that is 0 */
static void multiply(const tisserand_pattern *pattern, const double *values, int first, int count, const double *x,
                     double *dF)
{
    for (int j = 0; j < count; j++) {
        const double factor = x == NULL ? 1.0 : x[j];
        for (int i = pattern->colptr[first + j]; i < pattern->colptr[first + j + 1]; i++) {
            dF[pattern->rowidx[i]] += values[i] * factor;
        }
    }
}

int tisserand_ode_linearise(const tisserand_ode *ode, double t, const double *y)
{
    const tisserand_model *model = ode->model;
    const int n = model->nq + model->nv;
    const parts own = parts_of(ode);
    tisserand_dae form;
    int code = model->parameter_jacobian == NULL ? TISSERAND_NO_SENSITIVITIES : find_form(model, "index1", &form);

    if (code != 0) {
        return code;
    }
    memset(own.zdot, 0, (size_t) state_size(model) * sizeof(double));
    memcpy(own.z, y, (size_t) n * sizeof(double));
    code = model->rates(y, y + model->nq, ode->k, own.zdot);
    code = code != 0 ? code : accelerations(ode, t, y, own.zdot + model->nq, own.z + n);
    code = code != 0 ? code : form.jacobian(t, own.z, own.zdot, 0.0, ode->k, own.by_state);
    return code != 0 ? code : model->parameter_jacobian(t, own.z, own.zdot, ode->k, own.by_parameter);
}

int tisserand_ode_change(const tisserand_ode *ode, double t, const double *y, const double *dy, int parameter,
                         double *dydot)
{
    const tisserand_model *model = ode->model;
    const int nq = model->nq, nv = model->nv, nlambda = model->nlambda, n = nq + nv;
    const parts own = parts_of(ode);
    tisserand_dae form;
    int code = model->parameter_jacobian == NULL ? TISSERAND_NO_SENSITIVITIES : find_form(model, "index1", &form);

    if (code != 0) {
        return code;
    }
    for (int i = 0; i < n; i++) {
        dydot[i] = 0.0;
    }
    memset(own.dF, 0, (size_t) rows(model) * sizeof(double));
    if (parameter >= 0) { /* rows of M vdot + h - G^T lambda, g, gdot, G vdot - gamma: the last behind the first */
        multiply(model->parameter_pattern, own.by_parameter, parameter, 1, NULL, own.dF);
        memmove(own.dF + nv, own.dF + nv + 2 * nlambda, (size_t) nlambda * sizeof(double));
        memmove(own.dF + nq, own.dF, (size_t) (nv + nlambda) * sizeof(double));
        memset(own.dF, 0, (size_t) nq * sizeof(double));
    }
    if (dy != NULL) {
        multiply(form.pattern, own.by_state, 0, n, dy, own.dF);
    }
    for (int i = 0; i < n + nlambda; i++) {
        own.dF[i] = -own.dF[i];
    }
    memcpy(dydot, own.dF, (size_t) nq * sizeof(double));
    return model->solve_kkt(t, y, ode->k, own.dF + nq, own.dF + n, dydot + nq, own.x);
}

int tisserand_ode_start_change(const tisserand_ode *ode, double t, const double *y, int parameter, double *dy)
{
    const tisserand_model *model = ode->model;
    const tisserand_scene *scene = model->scene;
    const int nq = model->nq, nv = model->nv, nlambda = model->nlambda, n = nq + nv;
    const parts own = parts_of(ode);
    tisserand_dae form;
    int code = model->parameter_jacobian == NULL ? TISSERAND_NO_SENSITIVITIES : 0;

    for (int i = 0; i < n; i++) {
        dy[i] = 0.0;
    }
    if (code != 0 || nlambda == 0) {
        return code;
    }
    memset(own.z, 0, (size_t) (2 * state_size(model)) * sizeof(double)); /* and zdot */
    memset(own.dF, 0, (size_t) rows(model) * sizeof(double));
    memcpy(own.z, y, (size_t) n * sizeof(double));
    code = find_form(model, "ggl", &form); /* F = [qdot - v + G^T mu; M vdot + h - G^T lambda; gdot; g] */
    code = code != 0 ? code : model->parameter_jacobian(t, own.z, own.zdot, ode->k, own.by_parameter);
    code = code != 0 ? code : form.jacobian(t, own.z, own.zdot, 0.0, ode->k, own.by_state);
    if (code != 0) {
        return code;
    }
    multiply(model->parameter_pattern, own.by_parameter, parameter, 1, NULL, own.dF);
    double *dg = own.z, *dgdot = own.z + nlambda; /* z is not needed any more */
    for (int i = 0; i < nlambda; i++) {
        dg[i] = -own.dF[nv + i];
        dgdot[i] = own.dF[nv + nlambda + i];
    }
    code = scene->project_velocity(t, y, ode->k, dg, dy); /* G = dg/dq, since qdot = v in a scene */
    memset(own.dF, 0, (size_t) rows(model) * sizeof(double));
    multiply(form.pattern, own.by_state, 0, nq, dy, own.dF);
    for (int i = 0; i < nlambda; i++) {
        dgdot[i] = -(dgdot[i] + own.dF[n + i]);
    }
    return code != 0 ? code : scene->project_velocity(t, y, ode->k, dgdot, dy + nq);
}
