/*
 * SPDX-License-Identifier: 0BSD
 *
 * The classical Runge-Kutta method of order 4 with fixed steps, for any generated model by its descriptor. Scenes have
 * constraints g(t, q) = 0: after each step q and v are projected onto g = 0 and gdot = 0 by the smallest change in
 * the metric of M. C99 or C++, and the header of a model; no allocation.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' fixed_step.c my_scene.c my_program.c -lm
 *
 * Copy it into your program. To control each step, call tisserand_rk4_step and tisserand_project yourself;
 * tisserand_rk4 is a loop around them.
 */

#ifndef TISSERAND_FIXED_STEP_H
#define TISSERAND_FIXED_STEP_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Return codes. The model returns 1 and 2. */
enum {
    TISSERAND_OK = 0,
    TISSERAND_PIVOT = 1,      /* a pivot vanished: the joints are redundant or in a singular position */
    TISSERAND_NOT_FINITE = 2, /* a value is not finite, or a quaternion is zero */
    TISSERAND_OFF = 3,        /* projection cannot reduce |g| below the tolerance */
    TISSERAND_ARGUMENT = 4,   /* an argument is not valid: negative numbers of steps, every < 1, a negative tolerance, a
                                 time, a step or a tolerance that is not finite; nothing is written then */
    TISSERAND_STOPPED = 9     /* the observer has ended the integration */
};

/* A function of the caller that follows an integration, to show its progress or to end it. It is called with `data`, the
   time of a row and the row (q, v, lambda) as soon as the row is written. If it returns other than 0, the integration
   ends with TISSERAND_STOPPED: this row is the last one, and those after it are NaN. */
typedef struct {
    int (*call)(void *data, double t, const double *row);
    void *data;
} tisserand_observer;

/* Statistics, to which functions add. */
typedef struct {
    long steps;
    long accelerations; /* calls of accel and solve */
    long constraints;   /* calls of constraints and constraint_rates */
    long corrections;   /* calls of project_velocity; each costs about as much as one of accel */
} tisserand_fixed_counts;

/* The number of doubles of `work`, whose contents need not be preserved between calls. */
int tisserand_fixed_work(
    const tisserand_model *model);

/* The number of doubles in a row of results: q, v, lambda. */
int tisserand_fixed_row(
    const tisserand_model *model);

/* Normalise the quaternion of a body in space, whose length has to be 1. */
int tisserand_normalise(
    const tisserand_model *model,
    double *q);

/* Project q onto |g| <= tolerance by Newton's method, then v onto |gdot| <= tolerance; q and v do not change if they
   meet this already. |.| is the largest element, in the units of g and gdot. Use it for the initial state as well. */
int tisserand_project(
    const tisserand_model *model,
    double t,
    const double *k,
    double tolerance,
    double *q,
    double *v,
    double *work,
    tisserand_fixed_counts *counts);

/* Advance q and v by a step from t to t + step, without projection; a quaternion is normalised after it. */
int tisserand_rk4_step(
    const tisserand_model *model,
    double t,
    double step,
    const double *k,
    double *q,
    double *v,
    double *work,
    tisserand_fixed_counts *counts);

/* Call an observer, which may be 0, with a row at t. Returns 0 or TISSERAND_STOPPED. */
int tisserand_observe(
    const tisserand_observer *observer,
    double t,
    const double *row);

/* Compute the row of results of a state. */
int tisserand_fixed_result(
    const tisserand_model *model,
    double t,
    const double *k,
    const double *q,
    const double *v,
    double *row,
    double *work,
    tisserand_fixed_counts *counts);

/* Integrate from t0 by a number of steps. If tolerance > 0, a scene is projected at t0 and after each step. A quaternion
   is normalised at t0 and after each step. `rows` gets a row at t0 and after every `every` steps, steps / every + 1 in
   all; it may be 0. The observer is called with each row; it may be 0. If the code is not 0, q and v are undefined, and
   the rows from the failure on are NaN. */
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
    const tisserand_observer *observer,
    double *work,
    tisserand_fixed_counts *counts);

/* The same for n independent states with the same t0 and constants: state b is at q + b * nq and v + b * nv, and its
   rows follow those of state b - 1. The failure of a state does not stop the others; its code is codes[b]. Returns the
   first code that is not 0 (after TISSERAND_ARGUMENT codes are not set). Counts are sums over the states. */
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
