/*
 * SPDX-License-Identifier: 0BSD
 *
 * Any model that Tisserand generates, known by its descriptor alone, integrated by IDA of SUNDIALS (6.2 or
 * later) with the sparse solver KLU. Needs fixed_step.c, for a consistent start. With Debian or Ubuntu: apt-get install
 * libsundials-dev libsuitesparse-dev, then
 *
 *     cc -std=c99 -isystem /usr/include/suitesparse -DTISSERAND_HEADER='"my_scene.h"' ida.c fixed_step.c my_scene.c \
 *        my_program.c -lsundials_ida -lsundials_sunlinsolklu -lsundials_sunmatrixsparse -lsundials_nvecserial -lm
 */

#ifndef TISSERAND_IDA_H
#define TISSERAND_IDA_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    const char *form; /* of a scene, "ggl" (index 2, stabilised) or "index1"; of a body without joints 0 */
    double rtol;      /* relative tolerance */
    double atol;      /* absolute one of q and v; the multipliers come out as exact as these make them */
    int order;        /* highest order of the method, 1 to 5; 0: 5. Orders 3 to 5 need steps short enough to follow
                         every vibration that is not damped; order 2 steps over those that stay below the tolerance. */
    double start;     /* q and v are brought to |g|, |gdot| <= start at first; 0: they are taken as they are */
    double step_max;  /* longest step; 0: any */
    long steps_max;   /* most steps between two rows; 0: any number */
} tisserand_ida_options;

typedef struct {
    long steps;
    long residuals;
    long jacobians;
    long factorisations;
    long iterations;           /* of Newton's method */
    long error_failures;       /* steps that were too inexact and taken again */
    long convergence_failures; /* steps where Newton's method failed, taken again */
} tisserand_ida_counts;

enum { TISSERAND_NO_FORM = 5 }; /* the model has no such form */

/* Fill `rows` with q, v, lambda at t0 + i * interval, i = 0 ... nrows - 1, from the state q, v at t0. Returns 0; a
   code of fixed_step.h, or TISSERAND_NO_FORM, when there is no start; a negative code of IDA (ida/ida.h), and then
   the rows that were not reached hold NaN. q and v become the last state. */
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
    tisserand_ida_counts *counts);

#ifdef __cplusplus
}
#endif

#endif
