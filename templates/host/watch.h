/*
 * SPDX-License-Identifier: 0BSD
 *
 * The largest, the mean and the mean square values of quantities along a motion. A quantity is that of some forms
 * f = sum factor_i z_i with the largest |f|, of z = q, v, outputs, t - begin, and may be multiplied by another quantity:
 * what limits the validity of a model, for example. C99 or C++, and the header of a model; no allocation.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' watch.c my_scene.c my_program.c -lm
 *
 * Call tisserand_watch_state after each step of an integrator, or give it to adaptive_rows.h as the observer of steps.
 */

#ifndef TISSERAND_WATCH_H
#define TISSERAND_WATCH_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What is watched, and where it is written. The caller sets `states` to 0 before the first state. */
typedef struct {
    const tisserand_model *model;
    const double *k;
    int count;             /* quantities */
    const int *forms;      /* count + 1: the number of the first form of each quantity, and that of all forms */
    const int *terms;      /* one more than there are forms: the number of the first term of each form, likewise */
    const int *columns;    /* of each term: the number of z_i */
    const double *factors; /* of each term */
    const int *multipliers; /* count: the number of an earlier quantity that multiplies this one, or -1 */
    double *largest;       /* count: the largest absolute value of each quantity */
    double *times;         /* count: its time */
    double *at;            /* count x nq: its q */
    double *integrals;     /* count: of each quantity over the time, by the trapezoidal rule */
    double *squares;       /* count: of the square of each quantity, likewise */
    double *last;          /* count + 1: each quantity in the last state, and its time */
    double *work;          /* nq + 2 nv + nlambda + nout + 1 */
    double begin;          /* the time of the first state */
    long states;           /* seen so far */
} tisserand_watch;

/* Look at a state y = q, v at t; `watch` is a tisserand_watch. A state in which the model has no outputs is left out.
   Returns 0. */
int tisserand_watch_state(
    void *watch,
    double t,
    const double *y);

#ifdef __cplusplus
}
#endif

#endif
