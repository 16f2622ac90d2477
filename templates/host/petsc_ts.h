/*
 * SPDX-License-Identifier: 0BSD
 *
 * Any generated model, by its descriptor, for TS of PETSc (3.18 or later, real numbers of double precision): the implicit
 * equations F(t, y, ydot) = 0 with their generated Jacobian dF/dy + shift dF/dydot as a sparse matrix of one process. It
 * needs fixed_step.c to project the initial state. With Debian or Ubuntu: apt-get install petsc-dev, then
 *
 *     mpicc -std=c99 $(pkg-config --cflags PETSc) -DTISSERAND_HEADER='"my_scene.h"' petsc_ts.c fixed_step.c my_scene.c \
 *        my_program.c $(pkg-config --libs PETSc) -lm
 *
 * All functions return the codes of PETSc. A code of the model in a step is a domain error, after which TS repeats the
 * step with a quarter of its length, as often as TSSetMaxStepRejections admits; the option -info prints it.
 */

#ifndef TISSERAND_PETSC_TS_H
#define TISSERAND_PETSC_TS_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#include <petscts.h>

#if defined(PETSC_USE_COMPLEX) || !defined(PETSC_USE_REAL_DOUBLE)
#  error "generated code needs a PETSc with real numbers of double precision"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A model with its constants and one of its forms. The functions write to it, so that each TS needs a structure of its
   own; constants may be shared. */
typedef struct {
    const tisserand_model *model;
    const double *k;    /* nk constants, those of setup; inputs are behind them, from k[nk - nu] on */
    tisserand_dae form; /* y = [q; v; lambda], in form "ggl" [q; v; lambda; mu], form.size elements */
    PetscInt *colptr;   /* the pattern of the Jacobian by columns */
    PetscInt *rowidx;
    double *values;     /* those of the Jacobian by columns */
    int residual_code;  /* of the last evaluation; 0 if it succeeded */
    int jacobian_code;
    TS ts;              /* that of tisserand_petsc_configure */
} tisserand_petsc;

/* Choose a form: of a scene "ggl" (index 2, stabilised), "index1" or "index3"; of a body without joints "ode". k has to live
   as long as the structure. Call tisserand_petsc_destroy at the end. */
PetscErrorCode tisserand_petsc_create(
    const tisserand_model *model,
    const char *form,
    const double *k,
    tisserand_petsc *own);

PetscErrorCode tisserand_petsc_destroy(
    tisserand_petsc *own);

/* A sparse matrix (MATSEQAIJ) with the pattern of the Jacobian. */
PetscErrorCode tisserand_petsc_matrix(
    const tisserand_petsc *own,
    Mat *J);

/* The residual, for TSSetIFunction. */
PetscErrorCode tisserand_petsc_residual(
    TS ts,
    PetscReal t,
    Vec y,
    Vec ydot,
    Vec F,
    void *own);

/* Its Jacobian, for TSSetIJacobian. P is a matrix of tisserand_petsc_matrix, or another that takes its values. */
PetscErrorCode tisserand_petsc_jacobian(
    TS ts,
    PetscReal t,
    Vec y,
    Vec ydot,
    PetscReal shift,
    Mat J,
    Mat P,
    void *own);

/* Whether the last residual and the last Jacobian succeeded, for TSSetFunctionDomainError, by which steps in which a Jacobian
   fails are repeated. */
PetscErrorCode tisserand_petsc_domain(
    TS ts,
    PetscReal t,
    Vec y,
    PetscBool *accept);

/* The initial y from q and v, which are first projected onto |g|, |gdot| <= tolerance; 0: they are not projected. The
   model computes lambda. */
PetscErrorCode tisserand_petsc_start(
    tisserand_petsc *own,
    PetscReal t,
    PetscReal tolerance,
    const double *q,
    const double *v,
    Vec y);

/* Give ts the functions above, and what these equations need: see petsc_ts.c. rtol and atol, which has to be positive, are the
   tolerances of q and v. TSSetFromOptions may follow and change all of it. */
PetscErrorCode tisserand_petsc_configure(
    TS ts,
    PetscReal rtol,
    PetscReal atol,
    tisserand_petsc *own);

#ifdef __cplusplus
}
#endif

#endif
