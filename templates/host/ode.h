/*
 * SPDX-License-Identifier: 0BSD
 *
 * Any generated model, by its descriptor, as the ordinary differential equation ydot = f(t, y) with y = [q; v], and the
 * exact derivatives of f with respect to y, to the parameters p and to the inputs u. C99 or C++, and the header of a
 * model; no allocation, no global data.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' ode.c my_scene.c my_program.c -lm
 *
 * A scene has the accelerations that keep the second time derivatives of its constraints at zero, and drifts off the
 * constraints by the errors of the integration: project the state from time to time, see tisserand_project of
 * fixed_step.h. Derivatives need a model that was generated with sensitivities (`tisserand build --sensitivities`).
 */

#ifndef TISSERAND_ODE_H
#define TISSERAND_ODE_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A model with its constants. The functions write to work alone, so that threads need a structure each. */
typedef struct {
    const tisserand_model *model;
    double *k;    /* nk constants, those of setup; inputs are behind them, from k[nk - nu] on */
    double *work; /* tisserand_ode_work(model) doubles */
} tisserand_ode;

enum { TISSERAND_NO_SENSITIVITIES = 6 }; /* the model was generated without what derivatives need */

/* The number of doubles of work. */
int tisserand_ode_work(
    const tisserand_model *model);

/* ydot = f(t, y), nq + nv each. Returns the code of the model: 1 a pivot vanished, 2 a value is not finite. */
int tisserand_ode_rates(
    const tisserand_ode *ode,
    double t,
    const double *y,
    double *ydot);

/* Prepare the derivatives of f at t, y, which work keeps until the next call of this or of the function above. */
int tisserand_ode_linearise(
    const tisserand_ode *ode,
    double t,
    const double *y);

/* The change dydot of ydot for the changes dy of y (nq + nv), and of one parameter or input by 1: a number below np
   is that of a parameter, np + j is input j, and -1 is none. dy may be 0. t and y are those of linearise; dydot may not
   overlap dy. */
int tisserand_ode_change(
    const tisserand_ode *ode,
    double t,
    const double *y,
    const double *dy,
    int parameter,
    double *dydot);

/* Of a consistent state y at t, which depends on a parameter or an input where constraints do: its change dy when the
   constraints and their rates stay zero and q, then v, change as little as possible. linearise is not needed. */
int tisserand_ode_start_change(
    const tisserand_ode *ode,
    double t,
    const double *y,
    int parameter,
    double *dy);

#ifdef __cplusplus
}
#endif

#endif
