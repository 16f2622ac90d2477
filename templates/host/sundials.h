/*
 * SPDX-License-Identifier: 0BSD
 *
 * What CVODE, CVODES and ARKODE of SUNDIALS (6.2 or later) call, for any generated model by its descriptor: their user data
 * is a pointer to a tisserand_ode of ode.h, and their state is y = [q; v]. For IDA see ida.h. It needs ode.c and fixed_step.c.
 *
 *     cc -std=c99 -DTISSERAND_HEADER='"my_scene.h"' sundials.c ode.c fixed_step.c my_scene.c my_program.c \
 *        -lsundials_cvodes -lsundials_nvecserial -lsundials_sunmatrixdense -lm
 *
 * A positive code of a model, which is returned as it is, makes SUNDIALS try a shorter step.
 */

#ifndef TISSERAND_SUNDIALS_H
#define TISSERAND_SUNDIALS_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#include "ode.h"

#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>
#include <sundials/sundials_types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The right-hand side, for CVodeInit, ERKStepCreate and ARKStepCreate. */
int tisserand_sundials_rates(
    sunrealtype t,
    N_Vector y,
    N_Vector ydot,
    void *ode);

/* Its Jacobian as a dense matrix, for CVodeSetJacFn and ARKStepSetJacFn. It needs a model with sensitivities. */
int tisserand_sundials_jacobian(
    sunrealtype t,
    N_Vector y,
    N_Vector ydot,
    SUNMatrix J,
    void *ode,
    N_Vector unused1,
    N_Vector unused2,
    N_Vector unused3);

/* The right-hand sides of the sensitivities to the first `count` of the parameters and inputs [p; u], for CVodeSensInit.
   It needs a model with sensitivities. */
int tisserand_sundials_sensitivities(
    int count,
    sunrealtype t,
    N_Vector y,
    N_Vector ydot,
    N_Vector *dy,
    N_Vector *dydot,
    void *ode,
    N_Vector unused1,
    N_Vector unused2);

/* The correction with which y + correction meets the constraints and their rates, for CVodeSetProjFn; the tolerance is
   1e-12 m and rad, and the error estimate is not projected. */
int tisserand_sundials_projection(
    sunrealtype t,
    N_Vector y,
    N_Vector correction,
    sunrealtype tolerance,
    N_Vector error,
    void *ode);

/* The same for ARKStepSetPostprocessStepFn, which changes y itself. */
int tisserand_sundials_postprocess(
    sunrealtype t,
    N_Vector y,
    void *ode);

#ifdef __cplusplus
}
#endif

#endif
