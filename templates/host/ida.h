/*
 * SPDX-License-Identifier: 0BSD
 *
 * Integration of any generated model, by its descriptor, with IDA of SUNDIALS (6.2 or later) and the sparse solver KLU.
 * It needs fixed_step.c to project the initial state. With Debian or Ubuntu: apt-get install libsundials-dev
 * libsuitesparse-dev, then
 *
 *     cc -std=c99 -isystem /usr/include/suitesparse -DTISSERAND_HEADER='"my_scene.h"' ida.c fixed_step.c my_scene.c \
 *        my_program.c -lsundials_ida -lsundials_sunlinsolklu -lsundials_sunmatrixsparse -lsundials_nvecserial -lm
 */

#ifndef TISSERAND_IDA_H
#define TISSERAND_IDA_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#include "fixed_step.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    const char *form; /* of a scene, "ggl" (index 2, stabilised) or "index1"; of a body without joints 0 */
    double rtol;      /* relative tolerance */
    double atol;      /* absolute tolerance of q and v, which determine the accuracy of the multipliers */
    const double *weights; /* nq + nv factors of atol for the elements of q and v, in proportion to their sizes; 0: 1 */
    int order;        /* highest order of the method, 1 to 5; 0: 5. Orders 3 to 5 need steps that resolve every
                         undamped vibration; order 2 can step over vibrations below the tolerance. */
    double start;     /* the initial q and v are projected onto |g|, |gdot| <= start; 0: they are not projected */
    double step_max;  /* the longest step; 0: no limit */
    long steps_max;   /* the largest number of steps between two rows; 0: no limit */
    double proximal;  /* for redundant joints, 1e-9: the part of each multiplier's compliance that the iteration matrix
                         has on its diagonal, whose effect Newton's method removes; then multipliers of redundant joints
                         are some that give the motion. Singular positions stop IDA. 0: joints are not redundant */
} tisserand_ida_options;

typedef struct {
    long steps;
    long residuals;
    long jacobians;
    long factorisations;
    long iterations;           /* of Newton's method */
    long error_failures;       /* steps that failed the error test and were repeated */
    long convergence_failures; /* steps in which Newton's method did not converge, repeated */
} tisserand_ida_counts;

enum { TISSERAND_NO_FORM = 5 }; /* the model has no such form */

/* Fill `rows` with q, v, lambda at t0 + i * interval, i = 0 ... nrows - 1, from the state q, v at t0. The observer of
   fixed_step.h, which may be 0, is called with each row. Returns 0; a code of fixed_step.h, or TISSERAND_NO_FORM, if it cannot start; or a negative code of IDA (ida/ida.h), in which case
   the rows that are not reached are NaN. q and v become the last state. */
int tisserand_ida(
    const tisserand_model *model,
    const tisserand_ida_options *options,
    double t0,
    double interval,
    long nrows,
    const double *k,
    double *q,
    double *v,
    double *rows,
    const tisserand_observer *observer,
    tisserand_ida_counts *counts);

#ifdef __cplusplus
}
#endif

#endif
