/* SPDX-License-Identifier: 0BSD -- see ida.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "ida.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_types.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if SUNDIALS_VERSION_MAJOR >= 7
#  define TISSERAND_COMM SUN_COMM_NULL
#else
#  define TISSERAND_COMM NULL
#endif

/* The least compliance of a constraint, relative to that if each coordinate moved it by 1 m or 1 rad. */
static const double LEAST = 1.0 / 1024.0;

/* The user data that IDA passes to the functions below. */
typedef struct {
    const tisserand_dae *form;
    const double *k;
    int state;       /* nq + nv: the elements of y before the multipliers */
    double proximal; /* the term of the diagonal of multipliers, relative to their compliance; 0: none */
    sunindextype *colptr;
    sunindextype *rowidx;
} problem;

/* All objects that have to be freed. */
typedef struct {
    SUNContext context;
    void *ida;
    N_Vector y, ydot, atol, id;
    SUNMatrix matrix;
    SUNLinearSolver solver;
    problem given;
    double *work;
} machine;

static int residual(sunrealtype t, N_Vector y, N_Vector ydot, N_Vector F, void *data)
{
    const problem *own = (const problem *) data;
    /* Positive codes of a model are recoverable errors of IDA, which then tries a shorter step. */
    return own->form->residual(t, N_VGetArrayPointer(y), N_VGetArrayPointer(ydot), own->k, N_VGetArrayPointer(F));
}

/* An entry of the iteration matrix; NULL if it is a structural zero. */
static double *entry(const problem *own, double *matrix, sunindextype row, sunindextype column)
{
    for (sunindextype i = own->colptr[column]; i < own->colptr[column + 1]; i++) {
        if (own->rowidx[i] == row) {
            return matrix + i;
        }
    }
    return NULL;
}

/* Add the proximal term to the diagonal of the multipliers in the iteration matrix [A, B; C, 0]: a part of the compliance
   C A^-1 B of the constraint, estimated by the diagonal of A. A correction of Newton's method is off by this part of
   itself, which the next one mends; corrections of redundant joints that balance each other are finite. */
static void add_proximal(const problem *own, double *matrix)
{
    const sunindextype state = own->state;

    for (sunindextype j = state; j < own->form->size; j++) {
        double compliance = 0.0, full = 0.0, size;
        for (sunindextype i = own->colptr[j]; i < own->colptr[j + 1] && own->rowidx[i] < state; i++) {
            const double *across = entry(own, matrix, j, own->rowidx[i]);
            if (across != NULL) {
                const double inverse = 1.0 / *entry(own, matrix, own->rowidx[i], own->rowidx[i]);
                compliance += matrix[i] * *across * inverse;
                full += fabs(inverse);
            }
        }
        size = full > 0.0 ? fmax(fabs(compliance), LEAST * full) : 1.0;
        *entry(own, matrix, j, j) -= own->proximal * (compliance < 0.0 ? -size : size);
    }
}

static int jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector ydot, N_Vector F, SUNMatrix J, void *data,
                    N_Vector t1, N_Vector t2, N_Vector t3)
{
    const problem *own = (const problem *) data;
    const tisserand_pattern *pattern = own->form->pattern;
    double *matrix = SUNSparseMatrix_Data(J);
    int code;
    (void) F, (void) t1, (void) t2, (void) t3;
    /* IDA clears the pattern together with the values. */
    memcpy(SUNSparseMatrix_IndexPointers(J), own->colptr, (size_t) (pattern->cols + 1) * sizeof(sunindextype));
    memcpy(SUNSparseMatrix_IndexValues(J), own->rowidx, (size_t) pattern->nnz * sizeof(sunindextype));
    code = own->form->jacobian(t, N_VGetArrayPointer(y), N_VGetArrayPointer(ydot), cj, own->k, matrix);
    if (code == 0 && own->proximal > 0.0) {
        add_proximal(own, matrix);
    }
    return code;
}

/* The form of that name; a body without joints has a single form, which is part of the model. */
static int find_form(const tisserand_model *model, const char *name, tisserand_dae *form)
{
    if (model->scene == NULL) {
        form->name = "ode";
        form->size = model->nq + model->nv;
        form->pattern = model->jacobian_pattern;
        form->residual = model->residual;
        form->jacobian = model->jacobian;
        return name == NULL ? 0 : TISSERAND_NO_FORM;
    }
    for (int i = 0; i < model->scene->nforms && name != NULL; i++) {
        if (strcmp(model->scene->forms[i].name, name) == 0) {
            *form = model->scene->forms[i];
            return 0;
        }
    }
    return TISSERAND_NO_FORM;
}

/* The pattern as integers of SUNDIALS, which usually have 64 bits. */
static int copy_pattern(const tisserand_pattern *pattern, problem *own)
{
    const int n = pattern->cols, nnz = pattern->nnz;
    const int *colptr = pattern->colptr, *rowidx = pattern->rowidx;
    int *filled = NULL;

    own->colptr = (sunindextype *) calloc((size_t) (n + 1 + nnz), sizeof(sunindextype));
    if (own->colptr == NULL) {
        return IDA_MEM_FAIL;
    }
    own->rowidx = own->colptr + n + 1;
    if (colptr == NULL) {
        filled = (int *) calloc((size_t) (n + 1 + nnz), sizeof(int));
        if (filled == NULL) {
            return IDA_MEM_FAIL;
        }
        pattern->fill(filled, filled + n + 1);
        colptr = filled;
        rowidx = filled + n + 1;
    }
    for (int i = 0; i <= n; i++) {
        own->colptr[i] = colptr[i];
    }
    for (int i = 0; i < nnz; i++) {
        own->rowidx[i] = rowidx[i];
    }
    free(filled);
    return 0;
}

/* y and ydot from q and v; the model computes lambda and vdot, and the multipliers of the stabilisation are 0. */
static int start(const tisserand_model *model, double t, double tolerance, const double *k, double *q, double *v,
                 machine *own)
{
    double *y = N_VGetArrayPointer(own->y), *ydot = N_VGetArrayPointer(own->ydot);
    const int nq = model->nq, nv = model->nv;
    tisserand_fixed_counts ignored = {0, 0, 0, 0};
    int code = tisserand_normalise(model, q);

    if (code == 0 && tolerance > 0.0) {
        code = tisserand_project(model, t, k, tolerance, q, v, own->work, &ignored);
    }
    N_VConst(0.0, own->y);
    N_VConst(0.0, own->ydot);
    memcpy(y, q, (size_t) nq * sizeof(double));
    memcpy(y + nq, v, (size_t) nv * sizeof(double));
    if (code == 0) {
        code = model->rates(q, v, k, ydot);
    }
    if (code == 0) {
        code = model->scene == NULL ? model->accel(t, q, v, k, ydot + nq)
                                    : model->scene->solve(t, q, v, k, ydot + nq, y + nq + nv);
    }
    return code;
}

static int allocate(const tisserand_model *model, machine *own)
{
    const sunindextype n = own->given.form->size, nnz = own->given.form->pattern->nnz;

    own->work = (double *) calloc((size_t) tisserand_fixed_work(model), sizeof(double));
    if (own->work == NULL || SUNContext_Create(TISSERAND_COMM, &own->context) != 0) {
        return IDA_MEM_FAIL;
    }
    own->ida = IDACreate(own->context);
    own->y = N_VNew_Serial(n, own->context);
    own->ydot = N_VNew_Serial(n, own->context);
    own->atol = N_VNew_Serial(n, own->context);
    own->id = N_VNew_Serial(n, own->context);
    own->matrix = SUNSparseMatrix(n, n, nnz, CSC_MAT, own->context);
    if (own->ida == NULL || own->y == NULL || own->ydot == NULL || own->atol == NULL || own->id == NULL ||
        own->matrix == NULL) {
        return IDA_MEM_FAIL;
    }
    own->solver = SUNLinSol_KLU(own->y, own->matrix, own->context);
    return own->solver == NULL ? IDA_MEM_FAIL : copy_pattern(own->given.form->pattern, &own->given);
}

static int configure(const tisserand_model *model, const tisserand_ida_options *options, double t0, machine *own)
{
    double *atol = N_VGetArrayPointer(own->atol), *id = N_VGetArrayPointer(own->id);
    const int differential = model->nq + model->nv;
    int code;

    for (int i = 0; i < own->given.form->size; i++) {
        id[i] = i < differential ? 1.0 : 0.0;
        /* Errors of the multipliers are those of v or q times M or the unit matrix, divided by the step: rounding
           errors of q and v exceed the tolerance in the multipliers, the more so the shorter the step. Norms therefore
           exclude the multipliers; otherwise tight tolerances would fail in the first step. */
        atol[i] = i >= differential ? 1e30 : options->atol * (options->weights == NULL ? 1.0 : options->weights[i]);
    }
    if ((code = IDAInit(own->ida, residual, t0, own->y, own->ydot)) < 0 ||
        (code = IDASVtolerances(own->ida, options->rtol, own->atol)) < 0 ||
        (code = IDASetUserData(own->ida, &own->given)) < 0 || (code = IDASetId(own->ida, own->id)) < 0 ||
        (code = IDASetSuppressAlg(own->ida, SUNTRUE)) < 0 ||
        (code = IDASetMaxOrd(own->ida, options->order > 0 ? options->order : 5)) < 0 ||
        (code = IDASetMaxNumSteps(own->ida, options->steps_max > 0 ? options->steps_max : -1)) < 0 ||
        (code = IDASetMaxStep(own->ida, options->step_max)) < 0 ||
        (code = IDASetLinearSolver(own->ida, own->solver, own->matrix)) < 0 ||
        (code = IDASetJacFn(own->ida, jacobian)) < 0 ||
        /* A new Jacobian whenever the step changes: if it were kept up to changes by a quarter, Newton's method would
           take twice as many iterations, which cost more than the Jacobians. */
        (code = IDASetDeltaCjLSetup(own->ida, 0.0)) < 0) {
        return code;
    }
    return 0;
}

static void count(void *ida, tisserand_ida_counts *counts)
{
    IDAGetNumSteps(ida, &counts->steps);
    IDAGetNumResEvals(ida, &counts->residuals);
    IDAGetNumJacEvals(ida, &counts->jacobians);
    IDAGetNumLinSolvSetups(ida, &counts->factorisations);
    IDAGetNumNonlinSolvIters(ida, &counts->iterations);
    IDAGetNumErrTestFails(ida, &counts->error_failures);
    IDAGetNumNonlinSolvConvFails(ida, &counts->convergence_failures);
}

static void release(machine *own)
{
    free(own->given.colptr);
    free(own->work);
    if (own->ida != NULL) {
        IDAFree(&own->ida);
    }
    if (own->solver != NULL) {
        SUNLinSolFree(own->solver);
    }
    if (own->matrix != NULL) {
        SUNMatDestroy(own->matrix);
    }
    N_Vector vectors[4] = {own->y, own->ydot, own->atol, own->id};
    for (int i = 0; i < 4; i++) {
        if (vectors[i] != NULL) {
            N_VDestroy(vectors[i]);
        }
    }
    if (own->context != NULL) {
        SUNContext_Free(&own->context);
    }
}

int tisserand_ida(const tisserand_model *model, const tisserand_ida_options *options, double t0, double interval,
                  long nrows, const double *k, double *q, double *v, double *rows, const tisserand_observer *observer,
                  tisserand_ida_counts *counts)
{
    const int width = tisserand_fixed_row(model);
    tisserand_dae form;
    machine own;
    long reached = 0;
    int code, configured = 0;

    memset(&own, 0, sizeof own);
    own.given.form = &form;
    own.given.k = k;
    own.given.state = model->nq + model->nv;
    own.given.proximal = options->proximal;
    if (nrows < 1 || !(interval > 0.0 && interval < HUGE_VAL && fabs(t0) < HUGE_VAL) || !(options->start >= 0.0) ||
        !(options->rtol >= 0.0) || !(options->atol >= 0.0) || !(options->step_max >= 0.0) ||
        !(options->proximal >= 0.0)) {
        return TISSERAND_ARGUMENT;
    }
    code = find_form(model, options->form, &form);
    if (code == 0) {
        code = allocate(model, &own);
    }
    if (code == 0) {
        code = start(model, t0, options->start, k, q, v, &own);
    }
    if (code == 0) {
        code = configure(model, options, t0, &own);
        configured = code == 0;
    }
    for (; code == 0 && reached < nrows; reached++) {
        const double *y = N_VGetArrayPointer(own.y);
        const double last = t0 + (double) (nrows - 1) * interval, next = t0 + (double) reached * interval;
        sunrealtype t = t0;
        if (reached > 0) {
            int flag = IDASetStopTime(own.ida, last); /* the equations may not be defined beyond */
            if (flag >= 0) {
                flag = IDASolve(own.ida, next < last ? next : last, &t, own.y, own.ydot, IDA_NORMAL);
            }
            if (flag < 0) {
                code = flag;
                break;
            }
        }
        memcpy(rows + reached * width, y, (size_t) width * sizeof(double));
        memcpy(q, y, (size_t) model->nq * sizeof(double));
        memcpy(v, y + model->nq, (size_t) model->nv * sizeof(double));
        code = tisserand_observe(observer, next, rows + reached * width);
    }
    for (long i = reached * width; i < nrows * width; i++) {
        rows[i] = (double) NAN;
    }
    if (configured) {
        count(own.ida, counts);
    }
    release(&own);
    return code;
}
