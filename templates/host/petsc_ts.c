/* SPDX-License-Identifier: 0BSD -- see petsc_ts.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "fixed_step.h"
#include "petsc_ts.h"

#include <petscdmshell.h>

#include <math.h>
#include <string.h>

#define SUCCESS ((PetscErrorCode) 0) /* PETSC_SUCCESS since PETSc 3.19 */

/* The form of that name; a body without joints has a single form, which is part of the model. */
static int find_form(const tisserand_model *model, const char *name, tisserand_dae *form)
{
    if (model->scene == NULL) {
        const tisserand_dae own = {"ode", model->nq + model->nv, model->jacobian_pattern, model->residual, model->jacobian};
        *form = own;
        return strcmp(name, form->name) == 0;
    }
    for (int i = 0; i < model->scene->nforms; i++) {
        if (strcmp(model->scene->forms[i].name, name) == 0) {
            *form = model->scene->forms[i];
            return 1;
        }
    }
    return 0;
}

/* The columns and rows of the values, as integers of PETSc. */
static PetscErrorCode copy_pattern(tisserand_petsc *own)
{
    const tisserand_pattern *pattern = own->form.pattern;
    const int n = pattern->cols, nnz = pattern->nnz;
    const int *colptr = pattern->colptr, *rowidx = pattern->rowidx;
    int *filled = NULL;

    PetscFunctionBeginUser;
    PetscCall(PetscMalloc2((size_t) n + 1, &own->colptr, (size_t) nnz, &own->rowidx));
    if (colptr == NULL) {
        PetscCall(PetscMalloc1((size_t) (n + 1 + nnz), &filled));
        pattern->fill(filled, filled + n + 1);
        colptr = filled;
        rowidx = filled + n + 1;
    }
    for (int j = 0; j <= n; j++) {
        own->colptr[j] = colptr[j];
    }
    for (int i = 0; i < nnz; i++) {
        own->rowidx[i] = rowidx[i];
    }
    PetscCall(PetscFree(filled));
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_create(const tisserand_model *model, const char *form, const double *k,
                                      tisserand_petsc *own)
{
    PetscFunctionBeginUser;
    memset(own, 0, sizeof *own);
    own->model = model;
    own->k = k;
    PetscCheck(model->abi == TISSERAND_ABI, PETSC_COMM_SELF, PETSC_ERR_LIB, "the model %s is of another version",
               model->name);
    PetscCheck(find_form(model, form, &own->form), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG,
               "the model %s has no form %s", model->name, form);
    PetscCall(PetscCalloc1((size_t) own->form.pattern->nnz, &own->values));
    PetscCall(copy_pattern(own));
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_destroy(tisserand_petsc *own)
{
    PetscFunctionBeginUser;
    PetscCall(PetscFree(own->values));
    PetscCall(PetscFree2(own->colptr, own->rowidx));
    PetscFunctionReturn(SUCCESS);
}

/* The values of the Jacobian by columns into a matrix of any type. */
static PetscErrorCode set_values(const tisserand_petsc *own, Mat J)
{
    PetscFunctionBeginUser;
    for (PetscInt j = 0; j < own->form.size; j++) {
        const PetscInt first = own->colptr[j];
        PetscCall(MatSetValues(J, own->colptr[j + 1] - first, own->rowidx + first, 1, &j, own->values + first,
                               INSERT_VALUES));
    }
    PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_matrix(const tisserand_petsc *own, Mat *J)
{
    const PetscInt n = own->form.size;
    PetscInt *lengths;

    PetscFunctionBeginUser;
    PetscCall(PetscCalloc1((size_t) n, &lengths));
    for (PetscInt i = 0; i < own->colptr[n]; i++) {
        lengths[own->rowidx[i]]++;
    }
    PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, lengths, J));
    PetscCall(PetscFree(lengths));
    PetscCall(set_values(own, *J));
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_residual(TS ts, PetscReal t, Vec y, Vec ydot, Vec F, void *data)
{
    tisserand_petsc *own = (tisserand_petsc *) data;
    const PetscScalar *y_values, *ydot_values;
    PetscScalar *F_values;
    SNES snes;

    PetscFunctionBeginUser;
    PetscCall(VecGetArrayRead(y, &y_values));
    PetscCall(VecGetArrayRead(ydot, &ydot_values));
    PetscCall(VecGetArrayWrite(F, &F_values));
    own->residual_code = own->form.residual(t, y_values, ydot_values, own->k, F_values);
    PetscCall(VecRestoreArrayWrite(F, &F_values));
    PetscCall(VecRestoreArrayRead(ydot, &ydot_values));
    PetscCall(VecRestoreArrayRead(y, &y_values));
    if (own->residual_code != 0) {
        PetscCall(PetscInfo(ts, "the residual of %s: code %d\n", own->model->name, own->residual_code));
        PetscCall(VecSet(F, (double) NAN)); /* by its norm solvers notice a domain error */
        PetscCall(TSGetSNES(ts, &snes));
        PetscCall(SNESSetFunctionDomainError(snes));
    }
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_jacobian(TS ts, PetscReal t, Vec y, Vec ydot, PetscReal shift, Mat J, Mat P, void *data)
{
    tisserand_petsc *own = (tisserand_petsc *) data;
    const PetscScalar *y_values, *ydot_values;

    PetscFunctionBeginUser;
    PetscCall(VecGetArrayRead(y, &y_values));
    PetscCall(VecGetArrayRead(ydot, &ydot_values));
    own->jacobian_code = own->form.jacobian(t, y_values, ydot_values, shift, own->k, own->values);
    PetscCall(VecRestoreArrayRead(ydot, &ydot_values));
    PetscCall(VecRestoreArrayRead(y, &y_values));
    if (own->jacobian_code == 0) {
        PetscCall(set_values(own, P));
    } else {
        PetscCall(PetscInfo(ts, "the Jacobian of %s: code %d\n", own->model->name, own->jacobian_code));
    }
    if (J != P) { /* products by differences of F, see -snes_mf_operator */
        PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
        PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
    }
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_domain(TS ts, PetscReal t, Vec y, PetscBool *accept)
{
    TSIFunction function;
    void *data;

    PetscFunctionBeginUser;
    (void) t, (void) y;
    PetscCall(TSGetIFunction(ts, NULL, &function, &data));
    *accept = PETSC_TRUE;
    if (function == tisserand_petsc_residual) {
        const tisserand_petsc *own = (const tisserand_petsc *) data;
        *accept = (PetscBool) (own->residual_code == 0 && own->jacobian_code == 0);
    }
    PetscFunctionReturn(SUCCESS);
}

PetscErrorCode tisserand_petsc_start(tisserand_petsc *own, PetscReal t, PetscReal tolerance, const double *q,
                                     const double *v, Vec y)
{
    const tisserand_model *model = own->model;
    const int nq = model->nq, nv = model->nv;
    tisserand_fixed_counts ignored = {0, 0, 0, 0};
    double *work, *vdot;
    PetscScalar *values;
    int code;

    PetscFunctionBeginUser;
    PetscCall(PetscMalloc2((size_t) tisserand_fixed_work(model), &work, (size_t) nv, &vdot));
    PetscCall(VecSet(y, 0.0));
    PetscCall(VecGetArray(y, &values));
    memcpy(values, q, (size_t) nq * sizeof(double));
    memcpy(values + nq, v, (size_t) nv * sizeof(double));
    code = tisserand_normalise(model, values);
    if (code == 0 && tolerance > 0.0) {
        code = tisserand_project(model, t, own->k, tolerance, values, values + nq, work, &ignored);
    }
    if (code == 0 && model->scene != NULL) {
        code = model->scene->solve(t, values, values + nq, own->k, vdot, values + nq + nv);
    }
    PetscCall(VecRestoreArray(y, &values));
    PetscCall(PetscFree2(work, vdot));
    PetscCheck(code == 0, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
               "the start state of %s: code %d, see fixed_step.h", model->name, code);
    PetscFunctionReturn(SUCCESS);
}

/* Newton's method has converged when its last change of q and v is below a tenth of the tolerances of ts. Norms of F, by
   which PETSc decides, mix rows of different units, so that errors of q and v remain that the control of steps sees. */
static PetscErrorCode converged(SNES snes, PetscInt iteration, PetscReal size, PetscReal unused, PetscReal norm,
                                SNESConvergedReason *reason, void *data)
{
    const tisserand_petsc *own = (const tisserand_petsc *) data;
    const PetscScalar *change, *value;
    PetscReal atol, rtol, largest = 0.0;
    PetscInt most;
    Vec y, dy;

    PetscFunctionBeginUser;
    (void) size, (void) unused;
    *reason = SNES_CONVERGED_ITERATING;
    if (PetscIsInfOrNanReal(norm)) {
        *reason = SNES_DIVERGED_FNORM_NAN;
        PetscFunctionReturn(SUCCESS);
    }
    if (iteration == 0) {
        PetscFunctionReturn(SUCCESS);
    }
    PetscCall(TSGetTolerances(own->ts, &atol, NULL, &rtol, NULL));
    PetscCall(SNESGetSolution(snes, &y));
    PetscCall(SNESGetSolutionUpdate(snes, &dy));
    PetscCall(VecGetArrayRead(y, &value));
    PetscCall(VecGetArrayRead(dy, &change));
    for (int i = 0; i < own->model->nq + own->model->nv; i++) {
        const double ratio = fabs(change[i]) / (atol + rtol * fabs(value[i]));
        largest = ratio <= largest ? largest : ratio;
    }
    PetscCall(VecRestoreArrayRead(dy, &change));
    PetscCall(VecRestoreArrayRead(y, &value));
    PetscCall(SNESGetTolerances(snes, NULL, NULL, NULL, &most, NULL));
    if (largest < 0.1) {
        *reason = SNES_CONVERGED_SNORM_RELATIVE;
    } else if (iteration >= most) {
        *reason = SNES_DIVERGED_MAX_IT;
    }
    PetscFunctionReturn(SUCCESS);
}

/* The linear solver: a sparse LU factorisation. */
static PetscErrorCode set_linear_solver(SNES snes)
{
    KSP ksp;
    PC pc;

    PetscFunctionBeginUser;
    PetscCall(SNESGetKSP(snes, &ksp));
    PetscCall(KSPGetPC(ksp, &pc));
    PetscCall(KSPSetType(ksp, KSPPREONLY));
    PetscCall(PCSetType(pc, PCLU));
#ifdef PETSC_HAVE_SUITESPARSE
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERKLU));
#else
    /* PETSc's own factorisation does not look for pivots: in this order multipliers are behind their coordinates. */
    PetscCall(PCFactorSetMatOrderingType(pc, MATORDERINGNATURAL));
#endif
    PetscFunctionReturn(SUCCESS);
}

/* The kind of the equations, by which methods with explicit stages decide how they begin. */
static TSEquationType equation_type(const tisserand_petsc *own)
{
    if (own->form.size == own->model->nq + own->model->nv) {
        return TS_EQ_IMPLICIT;
    }
    if (strcmp(own->form.name, "index1") == 0) {
        return TS_EQ_DAE_IMPLICIT_INDEX1;
    }
    return strcmp(own->form.name, "ggl") == 0 ? TS_EQ_DAE_IMPLICIT_INDEX2 : TS_EQ_DAE_IMPLICIT_INDEX3;
}

PetscErrorCode tisserand_petsc_configure(TS ts, PetscReal rtol, PetscReal atol, tisserand_petsc *own)
{
    const int differential = own->model->nq + own->model->nv;
    PetscScalar *values;
    SNESLineSearch search;
    SNES snes;
    Vec tolerances;
    Mat J;
    DM dm;

    PetscFunctionBeginUser;
    own->ts = ts;
    PetscCall(tisserand_petsc_matrix(own, &J));
    PetscCall(TSSetIFunction(ts, NULL, tisserand_petsc_residual, own));
    PetscCall(TSSetIJacobian(ts, J, J, tisserand_petsc_jacobian, own));
    PetscCall(TSGetDM(ts, &dm));
    PetscCall(DMShellSetMatrix(dm, J)); /* methods such as ARKIMEX create further matrices */
    PetscCall(TSSetEquationType(ts, equation_type(own)));
    /* Errors of the multipliers are those of v or q times M or the unit matrix, divided by the step: rounding errors of
       q and v exceed the tolerance in the multipliers, the more so the shorter the step. Norms therefore exclude them. */
    PetscCall(MatCreateVecs(J, &tolerances, NULL));
    PetscCall(VecGetArrayWrite(tolerances, &values));
    for (int i = 0; i < own->form.size; i++) {
        values[i] = i < differential ? atol : 1e30;
    }
    PetscCall(VecRestoreArrayWrite(tolerances, &values));
    PetscCall(TSSetTolerances(ts, atol, tolerances, rtol, NULL));
    PetscCall(VecDestroy(&tolerances));
    PetscCall(MatDestroy(&J));
    /* A step in which Newton's method or the model fails is repeated, up to ten times, see TSSetMaxStepRejections; by
       default it would end the integration. */
    PetscCall(TSSetMaxSNESFailures(ts, -1));
    PetscCall(TSSetFunctionDomainError(ts, tisserand_petsc_domain));
    PetscCall(TSGetSNES(ts, &snes));
    PetscCall(SNESSetTolerances(snes, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 8, PETSC_DEFAULT));
    PetscCall(SNESSetConvergenceTest(snes, converged, own, NULL));
    PetscCall(SNESGetLineSearch(snes, &search));
    PetscCall(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));
    PetscCall(set_linear_solver(snes));
    PetscFunctionReturn(SUCCESS);
}
