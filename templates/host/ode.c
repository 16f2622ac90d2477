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

/* The parts of work. The form of index 1 of a scene, and the one of a body, is F = [qdot - rates; M vdot + h - G^T lambda;
   G vdot - gamma] = 0 with the state z = [q; v; lambda]. The rows of parameter_jacobian are others: [M vdot + h - G^T
   lambda; g; gdot; G vdot - gamma; outputs]. */
typedef struct {
    double *z, *zdot; /* of the stabilised form, which has nlambda elements more */
    double *by_state; /* values of dF/dz */
    double *by_given; /* of the derivatives with respect to [p; u] */
    double *of_outputs;
    double *dF, *dgiven; /* changes of the rows of both */
    double *right, *x;   /* of the equations for vdot and lambda */
    double *args;        /* changes of the arguments q, v, vdot, lambda of the outputs */
    double *pu;
} parts;

/* The numbers of inputs and outputs */
static int inputs(const tisserand_model *model)
{
    return model->ports == NULL ? 0 : model->ports->nu;
}

static int outputs(const tisserand_model *model)
{
    return model->ports == NULL ? 0 : model->ports->nout;
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

/* The parts of work, if there is any, and their length together */
static int divide(const tisserand_model *model, double *work, parts *own)
{
    const tisserand_pattern *given = model->parameter_pattern;
    const int n = model->nq + model->nv, size = n + 2 * model->nlambda, forces = model->nv + model->nlambda;
    double **const starts[] = {&own->z,      &own->zdot,  &own->by_state, &own->by_given, &own->of_outputs, &own->dF,
                               &own->dgiven, &own->right, &own->x,        &own->args,     &own->pu};
    const int by_given = given == NULL ? 0 : given->nnz, rows = given == NULL ? 0 : given->rows;
    const int of_outputs = outputs(model) == 0 ? 0 : model->ports->pattern->nnz, pu = model->np + inputs(model);
    const int sizes[] = {size, size, most_values(model), by_given, of_outputs, size,
                         rows, forces, forces, n + forces, pu};
    int total = 0;

    for (int i = 0; i < (int) (sizeof sizes / sizeof *sizes); i++) {
        *starts[i] = work == NULL ? NULL : work + total;
        total += sizes[i];
    }
    return total;
}

/* The parts of work, and the form of that name; a body has a single form, which is part of the model. */
static int begin(const tisserand_ode *ode, const char *name, parts *own, tisserand_dae *form)
{
    const tisserand_model *model = ode->model;
    const int forms = model->scene == NULL ? 0 : model->scene->nforms;
    const tisserand_dae of_body = {"ode", model->nq + model->nv, model->jacobian_pattern, model->residual, model->jacobian};
    int code = model->parameter_jacobian == NULL || model->scene != NULL ? TISSERAND_NO_SENSITIVITIES : 0;

    divide(model, ode->work, own);
    *form = of_body;
    for (int i = 0; i < forms && model->parameter_jacobian != NULL; i++) {
        if (strcmp(model->scene->forms[i].name, name) == 0) {
            *form = model->scene->forms[i];
            code = 0;
        }
    }
    return code;
}

int tisserand_ode_work(const tisserand_model *model)
{
    parts own;
    return divide(model, NULL, &own);
}

static void zero(int n, double *x)
{
    for (int i = 0; i < n; i++) {
        x[i] = 0.0;
    }
}

static void copy(int n, const double *from, double *to)
{
    for (int i = 0; i < n; i++) {
        to[i] = from[i];
    }
}

int tisserand_ode_evaluate(const tisserand_ode *ode, double t, const double *y, double *ydot, double *lambda, double *out)
{
    const tisserand_model *model = ode->model;
    const double *q = y, *v = y + model->nq;
    double *vdot = ydot + model->nq, *multipliers = lambda == NULL ? ode->work : lambda;
    int code = model->rates(q, v, ode->k, ydot);

    if (code == 0) {
        code = model->scene == NULL ? model->accel(t, q, v, ode->k, vdot)
                                    : model->scene->solve(t, q, v, ode->k, vdot, multipliers);
    }
    if (code == 0 && out != NULL && outputs(model) > 0) {
        code = model->ports->outputs(t, q, v, vdot, multipliers, ode->k, out);
    }
    return code;
}

int tisserand_ode_rates(const tisserand_ode *ode, double t, const double *y, double *ydot)
{
    return tisserand_ode_evaluate(ode, t, y, ydot, NULL, NULL);
}

int tisserand_ode_linearise(const tisserand_ode *ode, double t, const double *y)
{
    const tisserand_model *model = ode->model;
    const int n = model->nq + model->nv;
    parts own;
    tisserand_dae form;
    int code = begin(ode, "index1", &own, &form);

    if (code != 0) {
        return code;
    }
    zero(n + model->nlambda, own.zdot);
    copy(n, y, own.z);
    code = tisserand_ode_evaluate(ode, t, y, own.zdot, own.z + n, NULL);
    code = code != 0 ? code : form.jacobian(t, own.z, own.zdot, 0.0, ode->k, own.by_state);
    if (code == 0 && outputs(model) > 0) {
        code = model->ports->outputs_jacobian(t, y, y + model->nq, own.zdot + model->nq, own.z + n, ode->k, own.of_outputs);
    }
    return code != 0 ? code : model->parameter_jacobian(t, own.z, own.zdot, ode->k, own.by_given);
}

/* y += A x for the first columns of a sparse matrix. */
static void multiply(const tisserand_pattern *A, const double *values, int columns, const double *x, double *y)
{
    for (int j = 0; j < columns; j++) {
        for (int i = A->colptr[j]; i < A->colptr[j + 1]; i++) {
            y[A->rowidx[i]] += values[i] * x[j];
        }
    }
}

/* x += A^T y for the first columns. */
static void multiply_transposed(const tisserand_pattern *A, const double *values, int columns, const double *y, double *x)
{
    for (int j = 0; j < columns; j++) {
        for (int i = A->colptr[j]; i < A->colptr[j + 1]; i++) {
            x[j] += values[i] * y[A->rowidx[i]];
        }
    }
}

int tisserand_ode_directional(const tisserand_ode *ode, double t, const double *y, const double *dy, const double *dpu,
                              double *dydot, double *dout)
{
    const tisserand_model *model = ode->model;
    const int nq = model->nq, nv = model->nv, nlambda = model->nlambda, n = nq + nv, nout = outputs(model);
    parts own;
    tisserand_dae form;
    int code = begin(ode, "index1", &own, &form);

    if (code != 0) {
        return code;
    }
    zero(n + nlambda, own.dF);
    zero(model->parameter_pattern->rows, own.dgiven);
    if (dy != NULL) {
        multiply(form.pattern, own.by_state, n, dy, own.dF);
    }
    if (dpu != NULL) {
        multiply(model->parameter_pattern, own.by_given, model->np + inputs(model), dpu, own.dgiven);
    }
    for (int i = 0; i < nv + nlambda; i++) {
        own.right[i] = -own.dF[nq + i] - own.dgiven[i < nv ? i : i + 2 * nlambda];
    }
    code = model->solve_kkt(t, y, ode->k, own.right, own.right + nv, own.x, own.x + nv);
    for (int i = 0; i < nq; i++) {
        dydot[i] = -own.dF[i];
    }
    copy(nv, own.x, dydot + nq);
    if (dout != NULL && nout > 0) { /* their derivatives by u are among those by [p; u] */
        zero(n, own.args);
        copy(dy == NULL ? 0 : n, dy, own.args);
        copy(nv + nlambda, own.x, own.args + n);
        copy(nout, own.dgiven + nv + 3 * nlambda, dout);
        multiply(model->ports->pattern, own.of_outputs, n + nv + nlambda, own.args, dout);
    }
    return code;
}

int tisserand_ode_change(const tisserand_ode *ode, double t, const double *y, const double *dy, int parameter,
                         double *dydot)
{
    parts own;
    const int count = ode->model->np + inputs(ode->model);

    divide(ode->model, ode->work, &own);
    for (int i = 0; i < count; i++) {
        own.pu[i] = i == parameter;
    }
    return tisserand_ode_directional(ode, t, y, dy, parameter < 0 ? NULL : own.pu, dydot, NULL);
}

/* With the matrix K of the equations for vdot and lambda, K^T [m; -l] = [a; -b] is K [m; l] = [a; -b]. */
int tisserand_ode_adjoint(const tisserand_ode *ode, double t, const double *y, const double *wydot, const double *wout,
                          double *dy, double *dpu)
{
    const tisserand_model *model = ode->model;
    const int nq = model->nq, nv = model->nv, nlambda = model->nlambda, n = nq + nv, nout = outputs(model);
    parts own;
    tisserand_dae form;
    int code = begin(ode, "index1", &own, &form);
    if (code != 0) {
        return code;
    }
    zero(n + nv + nlambda, own.args);
    zero(model->parameter_pattern->rows, own.dgiven);
    if (wout != NULL && nout > 0) {
        multiply_transposed(model->ports->pattern, own.of_outputs, n + nv + nlambda, wout, own.args);
        copy(nout, wout, own.dgiven + nv + 3 * nlambda);
    }
    for (int i = 0; i < nv + nlambda; i++) {
        own.right[i] = i < nv ? wydot[nq + i] + own.args[n + i] : -own.args[n + i];
    }
    code = model->solve_kkt(t, y, ode->k, own.right, own.right + nv, own.x, own.x + nv);
    for (int i = 0; i < nq; i++) {
        own.dF[i] = -wydot[i];
    }
    for (int i = 0; i < nv + nlambda; i++) {
        own.dF[nq + i] = own.dgiven[i < nv ? i : i + 2 * nlambda] = i < nv ? -own.x[i] : own.x[i];
    }
    copy(n, own.args, dy);
    multiply_transposed(form.pattern, own.by_state, n, own.dF, dy);
    if (dpu != NULL) {
        zero(model->np + inputs(model), dpu);
        multiply_transposed(model->parameter_pattern, own.by_given, model->np + inputs(model), own.dgiven, dpu);
    }
    return code;
}

int tisserand_ode_start_change(const tisserand_ode *ode, double t, const double *y, int parameter, double *dy)
{
    const tisserand_model *model = ode->model;
    const tisserand_scene *scene = model->scene;
    const int nq = model->nq, nv = model->nv, nlambda = model->nlambda, n = nq + nv;
    parts own;
    tisserand_dae form;
    int code = begin(ode, "ggl", &own, &form); /* F = [qdot - v + G^T mu; M vdot + h - G^T lambda; gdot; g] */

    zero(n, dy);
    if (code != 0 || nlambda == 0) {
        return nlambda == 0 && model->parameter_jacobian != NULL ? 0 : code;
    }
    zero(n + 2 * nlambda, own.z);
    zero(n + 2 * nlambda, own.zdot);
    copy(n, y, own.z);
    code = model->parameter_jacobian(t, own.z, own.zdot, ode->k, own.by_given);
    code = code != 0 ? code : form.jacobian(t, own.z, own.zdot, 0.0, ode->k, own.by_state);
    if (code != 0) {
        return code;
    }
    /* The derivatives of g and gdot by the parameter; z is not needed any more. */
    double *dg = own.z, *dgdot = own.z + nlambda;
    zero(model->parameter_pattern->rows, own.dgiven);
    zero(model->np + inputs(model), own.pu);
    own.pu[parameter] = 1.0;
    multiply(model->parameter_pattern, own.by_given, model->np + inputs(model), own.pu, own.dgiven);
    for (int i = 0; i < nlambda; i++) {
        dg[i] = -own.dgiven[nv + i];
        dgdot[i] = own.dgiven[nv + nlambda + i];
    }
    code = scene->project_velocity(t, y, ode->k, dg, dy); /* G = dg/dq, since qdot = v in a scene */
    zero(n + 2 * nlambda, own.dF);
    multiply(form.pattern, own.by_state, nq, dy, own.dF);
    for (int i = 0; i < nlambda; i++) {
        dgdot[i] = -(dgdot[i] + own.dF[n + i]);
    }
    return code != 0 ? code : scene->project_velocity(t, y, ode->k, dgdot, dy + nq);
}
