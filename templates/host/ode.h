/*
 * SPDX-License-Identifier: 0BSD
 *
 * Any generated model, by its descriptor, as the ordinary differential equation ydot = f(t, y) with y = [q; v] and the
 * outputs out(t, y), and the exact derivatives of both with respect to y, to the parameters p and to the inputs u. C99 or
 * C++, and the header of a model; no allocation, no global data.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' ode.c my_scene.c my_program.c -lm
 *
 * A scene has the accelerations that keep the second time derivatives of its constraints at zero, and drifts off the
 * constraints by the errors of the integration: project the state from time to time, see tisserand_project of
 * fixed_step.h. Derivatives need a model that was generated with sensitivities (`tisserand build --sensitivities`).
 *
 * Quaternions among q have unit length; the rates keep it up to the errors of the integration. Derivatives take their four
 * components as independent, and are those of f beside unit quaternions too. Without sensitivities the accelerations of a
 * scene in space use the unit length: there differences by a component are no derivatives, unless each quaternion is
 * divided by its length before f is called, as an integrator with a Jacobian by differences has to do.
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

/* The same with the nlambda multipliers and the nout outputs, each of which may be 0. */
int tisserand_ode_evaluate(
    const tisserand_ode *ode,
    double t,
    const double *y,
    double *ydot,
    double *lambda,
    double *out);

/* Prepare the derivatives at t, y, which work keeps until the next call of this or of the functions above. */
int tisserand_ode_linearise(
    const tisserand_ode *ode,
    double t,
    const double *y);

/* The changes dydot of ydot and dout of the outputs for the changes dy of y (nq + nv) and dpu of the parameters and
   inputs [p; u] (np + nu). Each of dy, dpu and dout may be 0. t and y are those of linearise; dydot may not overlap dy. */
int tisserand_ode_directional(
    const tisserand_ode *ode,
    double t,
    const double *y,
    const double *dy,
    const double *dpu,
    double *dydot,
    double *dout);

/* The same for the change of one parameter or input by 1, without the outputs: a number below np is that of a parameter,
   np + j is input j, and -1 is none. */
int tisserand_ode_change(
    const tisserand_ode *ode,
    double t,
    const double *y,
    const double *dy,
    int parameter,
    double *dydot);

/* The products of the transposed derivatives: the gradients dy and dpu of wydot^T ydot + wout^T out with respect to y and
   to [p; u], with the weights wydot (nq + nv) and wout (nout). wout and dpu may be 0. t and y are those of linearise. */
int tisserand_ode_adjoint(
    const tisserand_ode *ode,
    double t,
    const double *y,
    const double *wydot,
    const double *wout,
    double *dy,
    double *dpu);

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
