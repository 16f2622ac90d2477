/*
 * SPDX-License-Identifier: 0BSD
 *
 * A motion in rows at given times, with the steps of adaptive.c: multipliers, outputs and drift of each row, breaks at
 * which the integration starts anew, and an event that ends it. C99 or C++; no allocation.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' adaptive_rows.c adaptive.c dormand_prince.c fixed_step.c \
 *        my_scene.c my_program.c -lm
 */

#ifndef TISSERAND_ADAPTIVE_ROWS_H
#define TISSERAND_ADAPTIVE_ROWS_H

#include "adaptive.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A function of the caller that ends an integration where its value becomes positive or, with `crossing`, where the
   value changes its sign or becomes zero. It is called with `data`; a value that is not finite ends the integration with
   TISSERAND_NOT_FINITE. */
typedef struct {
    double (*value)(void *data, double t, const double *q, const double *v);
    void *data;
    int crossing;
} tisserand_event;

/* What is computed, and where it is written. Arrays that may be 0 are not written then. With an event, arrays have
   space for count + 1 rows. */
typedef struct {
    long count;                         /* the number of rows, at least 1 */
    const double *times;                /* their times, which increase; the integration begins at times[0] */
    int nbreaks;
    const double *breaks;               /* increasing times at which functions of time are discontinuous */
    const tisserand_event *event;       /* may be 0 */
    const tisserand_observer *observer; /* of the rows, see fixed_step.h; may be 0 */
    const tisserand_observer *steps;    /* of q, v at the begin, after each step and at the end; may be 0 */
    double *rows;                       /* q, v, lambda */
    double *outputs;                    /* of the ports of the model; may be 0 */
    double *drift;                      /* |g| and |gdot| before the projection of the row, and after it; may be 0 */
} tisserand_adaptive_rows;

typedef struct {
    long rows;   /* written */
    int met;     /* whether the event has ended the integration; the last row is at its time then */
    double time; /* of the last row */
} tisserand_adaptive_result;

/* Fill rows with the motion from the state q, v at times[0]. States within steps are interpolated and projected. An event
   is looked at in eight states of each step, and its time is found to rounding errors.

   Returns 0, TISSERAND_STOPPED if an observer has ended the integration, or another code; the rows that are not reached
   are NaN then, s->y is the last state at s->t, and s->trial the state that violates the constraints if the code is
   TISSERAND_OFF. */
int tisserand_adaptive_integrate(
    tisserand_adaptive *s,
    const tisserand_model *model,
    const tisserand_adaptive_options *options,
    const tisserand_adaptive_rows *request,
    const double *k,
    const double *q,
    const double *v,
    double *work,
    tisserand_adaptive_result *result);

#ifdef __cplusplus
}
#endif

#endif
