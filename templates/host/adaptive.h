/*
 * SPDX-License-Identifier: 0BSD
 *
 * The Runge-Kutta method of Dormand and Prince of order 8 with adaptive steps and dense output (DOP853), for any
 * generated model by its descriptor. After each step a scene is projected onto g = 0 and gdot = 0, as fixed_step.c
 * does. The control of steps is that of DOP853 in SciPy, with an estimate of errors that holds for fast vibrations as
 * well. C99 or C++, and the header of a model; no allocation. It needs dormand_prince.c, which has the method and the
 * estimate, and fixed_step.c; adaptive_rows.c is a loop around it that fills rows at given times.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' adaptive.c dormand_prince.c fixed_step.c \
 *        my_scene.c my_program.c -lm
 *
 * A program starts an integration, takes steps until s.t has reached the end, and reads the state s.y or, within the
 * last step, that of tisserand_adaptive_state. After a discontinuity of a function of time it starts anew.
 */

#ifndef TISSERAND_ADAPTIVE_H
#define TISSERAND_ADAPTIVE_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#include "fixed_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Return codes in addition to those of fixed_step.h. */
enum {
    TISSERAND_STEP_TOO_SHORT = 10, /* the tolerance requires steps shorter than the spacing of times */
    TISSERAND_TOO_MANY_STEPS = 11
};

typedef struct {
    double rtol;        /* relative tolerance of a step; 2.3e-14 replaces smaller values */
    const double *atol; /* nq + nv absolute tolerances of q and v, greater than 0 */
    double consistent;  /* a state is projected until |g| and |gdot| are at most this, or rounding errors; 0: it is not.
                           A motion through singular positions needs 2e-15 */
    double drift;       /* the largest |g| and |gdot| that are accepted, beside rounding errors; 0: no limit */
    double step_max;    /* the longest step; 0: no limit */
    long steps_max;     /* the largest number of steps; 0: no limit */
} tisserand_adaptive_options;

typedef struct {
    tisserand_fixed_counts fixed;
    long rejected; /* steps that were repeated with a shorter length; they are not among fixed.steps */
} tisserand_adaptive_counts;

/* How states within a step are computed: it has not been decided yet, by the interpolant, or, where the error of that
   exceeds the tolerances, each by a shorter step from the begin of the step. */
typedef enum { TISSERAND_NOT_YET, TISSERAND_INTERPOLATES, TISSERAND_OWN_STEPS } tisserand_within;

/* An integration in progress, whose arrays are parts of `work`. Read it; only the functions below write it. */
typedef struct {
    const tisserand_model *model;
    const double *k;
    tisserand_adaptive_options options;
    double t;         /* the time of the state */
    double *y;        /* the state q, v on the constraints */
    double last;      /* the time at which the last step began */
    double step;      /* the length of the next step that is tried */
    double limit;     /* the model is asked for accelerations at times up to this one */
    int refused;      /* the code with which a state was refused last, since the last step; 0: none was */
    double refused_t; /* its time */
    double *f;        /* the time derivatives of the state */
    double *begin;    /* the state at `last` */
    double *end;      /* the state at t before its projection */
    double *stages;   /* the stages of the last step */
    double *interpolant;
    tisserand_within within;
    double *trial;    /* a state that is computed */
    double *work;     /* of fixed_step.c */
    tisserand_adaptive_counts counts;
} tisserand_adaptive;

/* The number of doubles of `work`. */
int tisserand_adaptive_work(
    const tisserand_model *model);

/* Begin an integration at t with the state q, v, which is projected; `end` bounds the first step. The caller keeps the
   arrays. Counts are set to 0. */
int tisserand_adaptive_start(
    tisserand_adaptive *s,
    const tisserand_model *model,
    const tisserand_adaptive_options *options,
    double t,
    double end,
    const double *k,
    const double *q,
    const double *v,
    double *work);

/* Begin anew in the present state, as after a discontinuity at s->t, and keep the counts. */
int tisserand_adaptive_restart(
    tisserand_adaptive *s,
    double end);

/* Advance by a step that does not pass `end`. A step whose error is too large, in which the model refuses a state, or
   whose end cannot be projected, is repeated with a shorter length. If before_break is not 0, `end` is a discontinuity
   of a function of time, and the model is asked for accelerations before it alone. If the code is not 0, the state is
   that before the step; if it is TISSERAND_OFF, s->trial is the state that violates the constraints, at s->refused_t. */
int tisserand_adaptive_step(
    tisserand_adaptive *s,
    double end,
    int before_break);

/* Compute the state y = q, v at a time within the last step, by interpolation or, where that is less exact than the
   tolerances, by a shorter step from the begin of the last one; its error is of order 8. It is not projected. */
int tisserand_adaptive_state(
    tisserand_adaptive *s,
    double t,
    double *y);

/* Project a state y = q, v at t onto the constraints, and write the remaining |g| and |gdot| into drift. Returns
   TISSERAND_OFF if they exceed their limit. */
int tisserand_adaptive_project(
    tisserand_adaptive *s,
    double t,
    double *y,
    double drift[2]);

/* Compute |g| and |gdot| of a state y = q, v at t, their largest elements; 0 without constraints. */
int tisserand_adaptive_drift(
    tisserand_adaptive *s,
    double t,
    const double *y,
    double drift[2]);

#ifdef __cplusplus
}
#endif

#endif
