/*
 * SPDX-License-Identifier: 0BSD
 *
 * The explicit Runge-Kutta method of Dormand and Prince of order 8, with error estimates of orders 5 and 3 and an
 * interpolant of order 7, for any ydot = f(t, y): Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
 * 1993, sections II.5 and II.6 (DOP853). C99 or C++; no allocation. adaptive.c controls its steps.
 */

#ifndef TISSERAND_DORMAND_PRINCE_H
#define TISSERAND_DORMAND_PRINCE_H

#ifdef __cplusplus
extern "C" {
#endif

enum {
    TISSERAND_STAGES = 16, /* vectors: 12 stages of a step, the derivatives at its end, 3 stages of the interpolant */
    TISSERAND_DEGREE = 7   /* of the interpolant, which has as many vectors of coefficients */
};

/* ydot = f(t, y) with n elements; f is called with `data`, and returns 0 or a code that ends the computation. */
typedef struct {
    int (*f)(void *data, double t, const double *y, double *ydot);
    void *data;
    int n;
} tisserand_equations;

/* Compute the state `end` at t + h from y at t. `stages` has TISSERAND_STAGES * n doubles and begins with f(t, y);
   `trial` has n. Returns the code of f. */
int tisserand_stages(
    const tisserand_equations *equations,
    double t,
    double h,
    const double *y,
    double *stages,
    double *trial,
    double *end);

/* The estimate of the error of a step, as the root mean square over the elements, each relative to atol + rtol |y|: that
   of order 5, weighted by that of order 3, so that it is of order 7. That of order 5 alone is too small at some phases of
   a vibration: in a step with omega h between 3 and the limit of stability, 5.96, it vanishes twice per period, and a
   step beyond the limit may pass. That of order 6 is added to it, which is large there. The error is at most 2.3 times
   the estimate at any phase and any omega h from 3 to 8. */
double tisserand_step_error(
    int n,
    double h,
    const double *y,
    const double *end,
    const double *stages,
    double rtol,
    const double *atol);

/* Compute the interpolant of a step, TISSERAND_DEGREE * n doubles, with four calls of f, the first at t + h. */
int tisserand_interpolant(
    const tisserand_equations *equations,
    double t,
    double h,
    const double *y,
    const double *end,
    double *stages,
    double *trial,
    double *interpolant);

/* The estimate of the largest error of the interpolant within its step, likewise, from its coefficients, but relative to
   twice the tolerance: if it is below 1, the interpolant is as exact as a state within a step has to be. In a step with
   omega h between 3 and 8 the interpolant is 8 to 27 times as inexact as the end. */
double tisserand_interpolant_error(
    int n,
    const double *y,
    const double *end,
    const double *interpolant,
    double rtol,
    const double *atol);

/* The state at t + x h with 0 <= x <= 1, from y at t. */
void tisserand_interpolate(
    int n,
    double x,
    const double *y,
    const double *interpolant,
    double *state);

#ifdef __cplusplus
}
#endif

#endif
