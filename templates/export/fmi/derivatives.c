/* SPDX-License-Identifier: 0BSD -- see derivatives.h. */

#include "derivatives.h"

#include <string.h>

/* The equations as F(t, y, ydot) = 0 with y = [q; v; lambda]: of a scene, those of index 1 */
typedef struct {
    const tisserand_pattern *pattern;
    int (*jacobian)(double t, const double *y, const double *ydot, double cj, const double *k, double *jac);
    int size;
} equations;

static equations equations_of(const tisserand_model *model)
{
    equations result = {model->jacobian_pattern, model->jacobian, model->nq + model->nv};

    for (int i = 0; model->scene != NULL && i < model->scene->nforms; i++) {
        const tisserand_dae *form = model->scene->forms + i;
        if (strcmp(form->name, "index1") == 0) {
            result.pattern = form->pattern;
            result.jacobian = form->jacobian;
            result.size = form->size;
        }
    }
    return result;
}

/* The arrays of a computation: the values of the three Jacobians, and vectors. Changes of the rows of the equations of
   motion, of the constraints and of the outputs, and the solution of the equations for accelerations and multipliers. */
typedef struct {
    double *by_state, *by_given, *of_outputs; /* by_given: with respect to [p; u] */
    double *y, *ydot, *rows;                  /* of the equations */
    double *given_rows;                       /* of the derivatives with respect to [p; u] */
    double *given;                            /* [p; u] */
    double *at;                               /* the arguments of outputs: q, v, vdot, lambda, u */
    double *out, *a, *b, *x, *lambda;
} arrays;

static int outputs_entries(const tisserand_model *model)
{
    return model->ports != NULL && model->ports->nout > 0 ? model->ports->pattern->nnz : 0;
}

static int divide(const tisserand_model *model, double *work, arrays *parts)
{
    const equations form = equations_of(model);
    const int nu = model->ports == NULL ? 0 : model->ports->nu, nout = model->ports == NULL ? 0 : model->ports->nout;
    double **const starts[] = {&parts->by_state, &parts->by_given,   &parts->of_outputs, &parts->y, &parts->ydot,
                               &parts->rows,     &parts->given_rows, &parts->given,      &parts->at, &parts->out,
                               &parts->a,        &parts->b,          &parts->x,          &parts->lambda};
    const int sizes[] = {form.pattern->nnz,
                         model->parameter_pattern->nnz,
                         outputs_entries(model),
                         form.size,
                         form.size,
                         form.size,
                         model->parameter_pattern->rows,
                         model->np + nu,
                         model->nq + 2 * model->nv + model->nlambda + nu,
                         nout,
                         model->nv,
                         model->nlambda,
                         model->nv,
                         model->nlambda};
    int total = 0;

    for (int i = 0; i < (int) (sizeof sizes / sizeof *sizes); i++) {
        *starts[i] = work == NULL ? NULL : work + total;
        total += sizes[i];
    }
    return total;
}

int fmu_derivatives_work(const tisserand_model *model)
{
    arrays parts;
    return model->parameter_jacobian == NULL ? 0 : divide(model, NULL, &parts);
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

/* y += A x */
static void multiply(const tisserand_pattern *pattern, const double *values, const double *x, double *y)
{
    for (int j = 0; j < pattern->cols; j++) {
        for (int i = pattern->colptr[j]; i < pattern->colptr[j + 1]; i++) {
            y[pattern->rowidx[i]] += values[i] * x[j];
        }
    }
}

/* x += A^T y */
static void multiply_transposed(const tisserand_pattern *pattern, const double *values, const double *y, double *x)
{
    for (int j = 0; j < pattern->cols; j++) {
        for (int i = pattern->colptr[j]; i < pattern->colptr[j + 1]; i++) {
            x[j] += values[i] * y[pattern->rowidx[i]];
        }
    }
}

/* The Jacobians in the present state, which has been evaluated */
static int linearise(fmu_instance *fmu, const equations *form, arrays *parts)
{
    const tisserand_model *model = fmu->model;
    const double t = fmu->state[FMU_TIME], *q = fmu->x, *v = q + model->nq, *vdot = fmu->xdot + model->nq;
    int code;

    if (fmu->linearised) {
        return 0;
    }
    zero(form->size, parts->y);
    zero(form->size, parts->ydot);
    copy(fmu->nx, fmu->x, parts->y);
    copy(form->size - fmu->nx, fmu->lambda, parts->y + fmu->nx);
    copy(fmu->nx, fmu->xdot, parts->ydot);
    code = form->jacobian(t, parts->y, parts->ydot, 0.0, fmu->k, parts->by_state);
    if (code == 0) {
        code = model->parameter_jacobian(t, parts->y, parts->ydot, fmu->k, parts->by_given);
    }
    if (code == 0 && outputs_entries(model) > 0) {
        code = model->ports->outputs_jacobian(t, q, v, vdot, fmu->lambda, fmu->k, parts->of_outputs);
    }
    fmu->linearised = code == 0;
    return code;
}

enum { NONE, INPUT, PARAMETER, STATE, DERIVATIVE, OUTPUT };

/* What a value reference is, and its index among its kind */
static int kind_of(const fmu_instance *fmu, unsigned reference, int *index)
{
    const int sizes[] = {1, fmu->nu, fmu->model->np, fmu->nx, fmu->nx, fmu->nout};
    unsigned first = 0;

    for (int kind = NONE; kind <= OUTPUT; kind++) {
        if (reference < first + (unsigned) sizes[kind]) {
            *index = (int) (reference - first);
            return kind;
        }
        first += (unsigned) sizes[kind];
    }
    return NONE;
}

static fmu_status begin(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                        size_t known_count, equations *form, arrays *parts)
{
    fmu_status status;
    int index;

    if (fmu->model->parameter_jacobian == NULL) {
        return fmu_fail(fmu, FMU_ERROR, "this unit has no partial derivatives");
    }
    for (size_t i = 0; i < unknown_count; i++) {
        if (kind_of(fmu, unknowns[i], &index) < DERIVATIVE) {
            return fmu_fail(fmu, FMU_ERROR, "there are partial derivatives of outputs and of derivatives of states alone");
        }
    }
    for (size_t i = 0; i < known_count; i++) {
        const int kind = kind_of(fmu, knowns[i], &index);
        if (kind == NONE || kind > STATE) {
            return fmu_fail(fmu, FMU_ERROR,
                            "there are partial derivatives with respect to inputs, parameters and states alone");
        }
    }
    status = fmu_evaluate(fmu);
    if (status == FMU_OK) {
        *form = equations_of(fmu->model);
        divide(fmu->model, fmu->derivatives, parts);
        if (linearise(fmu, form, parts) != 0) {
            status = fmu_fail(fmu, FMU_DISCARD, "the derivatives have no value in this state");
        }
    }
    return status;
}

static fmu_status unsolved(fmu_instance *fmu, int code)
{
    return code == 0 ? FMU_OK : fmu_fail(fmu, FMU_DISCARD, "the equations of motion have no unique solution here");
}

/* The first of the rows of by_given for G vdot - gamma, and for the outputs */
static int bias_rows(const tisserand_model *model)
{
    return model->nv + 2 * model->nlambda;
}

static int output_rows(const tisserand_model *model)
{
    return model->nv + 3 * model->nlambda;
}

fmu_status fmu_directional(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                           size_t known_count, const double *seed, double *result)
{
    const tisserand_model *model = fmu->model;
    const int nq = model->nq, nv = model->nv, nx = fmu->nx, nlambda = model->nlambda;
    equations form;
    arrays parts;
    fmu_status status = begin(fmu, unknowns, unknown_count, knowns, known_count, &form, &parts);

    if (status != FMU_OK) {
        return status;
    }
    zero(form.size, parts.y);
    zero(model->np + fmu->nu, parts.given);
    for (size_t i = 0; i < known_count; i++) {
        int index;
        const int kind = kind_of(fmu, knowns[i], &index);
        double *part = kind == STATE ? parts.y : kind == PARAMETER ? parts.given : parts.given + model->np;
        part[index] += seed[i];
    }
    zero(form.size, parts.rows);
    zero(model->parameter_pattern->rows, parts.given_rows);
    multiply(form.pattern, parts.by_state, parts.y, parts.rows);
    multiply(model->parameter_pattern, parts.by_given, parts.given, parts.given_rows);
    for (int i = 0; i < nv; i++) {
        parts.a[i] = -parts.rows[nq + i] - parts.given_rows[i];
    }
    for (int i = 0; i < nlambda; i++) {
        parts.b[i] = -parts.rows[nx + i] - parts.given_rows[bias_rows(model) + i];
    }
    status = unsolved(fmu, model->solve_kkt(fmu->state[FMU_TIME], fmu->x, fmu->k, parts.a, parts.b, parts.x, parts.lambda));
    if (status != FMU_OK) {
        return status;
    }
    if (fmu->nout > 0) {
        copy(nx, parts.y, parts.at);
        copy(nv, parts.x, parts.at + nx);
        copy(nlambda, parts.lambda, parts.at + nx + nv);
        zero(fmu->nu, parts.at + nx + nv + nlambda); /* u is in given_rows */
        copy(fmu->nout, parts.given_rows + output_rows(model), parts.out);
        multiply(model->ports->pattern, parts.of_outputs, parts.at, parts.out);
    }
    for (size_t i = 0; i < unknown_count; i++) {
        int index;
        const int kind = kind_of(fmu, unknowns[i], &index);
        result[i] = kind == OUTPUT ? parts.out[index] : index < nq ? -parts.rows[index] : parts.x[index - nq];
    }
    return FMU_OK;
}

/* With the matrix K of the equations for accelerations and multipliers, K^T [m; -n] = [a; -b] is K [m; n] = [a; -b]. */
fmu_status fmu_adjoint(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                       size_t known_count, const double *seed, double *result)
{
    const tisserand_model *model = fmu->model;
    const int nq = model->nq, nv = model->nv, nx = fmu->nx, nlambda = model->nlambda;
    equations form;
    arrays parts;
    fmu_status status = begin(fmu, unknowns, unknown_count, knowns, known_count, &form, &parts);

    if (status != FMU_OK) {
        return status;
    }
    zero(form.size, parts.rows);
    zero(nv, parts.a);
    zero(fmu->nout, parts.out);
    for (size_t i = 0; i < unknown_count; i++) {
        int index;
        const int kind = kind_of(fmu, unknowns[i], &index);
        if (kind == OUTPUT) {
            parts.out[index] += seed[i];
        } else if (index < nq) {
            parts.rows[index] -= seed[i];
        } else {
            parts.a[index - nq] += seed[i];
        }
    }
    zero(nx + nv + nlambda + fmu->nu, parts.at);
    if (fmu->nout > 0) {
        multiply_transposed(model->ports->pattern, parts.of_outputs, parts.out, parts.at);
    }
    for (int i = 0; i < nv; i++) {
        parts.a[i] += parts.at[nx + i];
    }
    for (int i = 0; i < nlambda; i++) {
        parts.b[i] = -parts.at[nx + nv + i];
    }
    status = unsolved(fmu, model->solve_kkt(fmu->state[FMU_TIME], fmu->x, fmu->k, parts.a, parts.b, parts.x, parts.lambda));
    if (status != FMU_OK) {
        return status;
    }
    zero(model->parameter_pattern->rows, parts.given_rows);
    for (int i = 0; i < nv; i++) {
        parts.rows[nq + i] = parts.given_rows[i] = -parts.x[i];
    }
    for (int i = 0; i < nlambda; i++) {
        parts.rows[nx + i] = parts.given_rows[bias_rows(model) + i] = parts.lambda[i];
    }
    copy(fmu->nout, parts.out, parts.given_rows + output_rows(model));
    zero(form.size, parts.y);
    copy(nx, parts.at, parts.y);
    zero(model->np + fmu->nu, parts.given);
    multiply_transposed(form.pattern, parts.by_state, parts.rows, parts.y);
    multiply_transposed(model->parameter_pattern, parts.by_given, parts.given_rows, parts.given);
    for (size_t i = 0; i < known_count; i++) {
        int index;
        const int kind = kind_of(fmu, knowns[i], &index);
        result[i] = kind == STATE ? parts.y[index] : parts.given[kind == PARAMETER ? index : model->np + index];
    }
    return FMU_OK;
}
