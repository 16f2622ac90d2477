/*
 * SPDX-License-Identifier: 0BSD
 *
 * Fixed steps of the classical Runge-Kutta method of order 4 for any model that Tisserand generates, known by
 * its descriptor alone. Scenes have joints, g(t, q) = 0: after each step q and v are brought back to g = 0
 * and gdot = 0 by the smallest change in the metric of M. C99 or C++, and the header of a model; no allocation.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' fixed_step.c my_scene.c my_program.c -lm
 *
 * Copy it into your program. A step of your own takes tisserand_rk4_step and tisserand_project; tisserand_rk4
 * is a loop around them.
 */

#ifndef TISSERAND_FIXED_STEP_H
#define TISSERAND_FIXED_STEP_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What the functions return. 1 and 2 come from the model. */
enum {
    TISSERAND_OK = 0,
    TISSERAND_PIVOT = 1,      /* a pivot vanished: the joints are redundant or in a singular position */
    TISSERAND_NOT_FINITE = 2, /* a value is not finite */
    TISSERAND_OFF = 3,        /* g could not be brought below the tolerance */
    TISSERAND_ARGUMENT = 4    /* an argument makes no sense: negative numbers of steps, every < 1 */
};

/* What was done; functions add to it. */
typedef struct {
    long steps;
    long accelerations; /* calls of accel and solve */
    long constraints;   /* calls of constraints and constraint_rates */
    long corrections;   /* calls of project_velocity, each about as dear as one of accel */
} tisserand_fixed_counts;

/* Doubles that the functions need as `work`; its contents need not survive between calls. */
int tisserand_fixed_work(
    const tisserand_model *model);

/* Doubles in one row of results: q, v, lambda. */
int tisserand_fixed_row(
    const tisserand_model *model);

/* Bring q to |g| <= tolerance by Newton's method, then v to |gdot| <= tolerance; each is left alone where it is
   so already. |.| is the largest element, in the units of g and gdot. It also makes a first state consistent. */
int tisserand_project(
    const tisserand_model *model,
    double t,
    const double *k,
    double tolerance,
    double *q,
    double *v,
    double *work,
    tisserand_fixed_counts *counts);

/* One step from t to t + step, in place, without projection. */
int tisserand_rk4_step(
    const tisserand_model *model,
    double t,
    double step,
    const double *k,
    double *q,
    double *v,
    double *work,
    tisserand_fixed_counts *counts);

/* The row of results at a state. */
int tisserand_fixed_result(
    const tisserand_model *model,
    double t,
    const double *k,
    const double *q,
    const double *v,
    double *row,
    double *work,
    tisserand_fixed_counts *counts);

/* All the steps from t0 on, of a scene with projection at t0 and after each step where tolerance > 0. `rows` gets
   one row at t0 and after every `every` steps, steps / every + 1 in all; it may be 0. When the code is not 0,
   q and v hold nothing of use, and the rows from the failure on hold NaN. */
int tisserand_rk4(
    const tisserand_model *model,
    double t0,
    double step,
    long steps,
    long every,
    const double *k,
    double tolerance,
    double *q,
    double *v,
    double *rows,
    double *work,
    tisserand_fixed_counts *counts);

/* The same of n states that have nothing to do with each other, and share t0 and the constants: state b is at
   q + b * nq and v + b * nv, its rows follow those of state b - 1. A state that fails does not stop the others; its
   code is codes[b]. Returns the first code that is not 0 (TISSERAND_ARGUMENT: codes are not written). Counts are sums. */
int tisserand_rk4_batch(
    const tisserand_model *model,
    int n,
    double t0,
    double step,
    long steps,
    long every,
    const double *k,
    double tolerance,
    double *q,
    double *v,
    double *rows,
    int *codes,
    double *work,
    tisserand_fixed_counts *counts);

#ifdef __cplusplus
}
#endif

#endif
