/* SPDX-License-Identifier: 0BSD -- see sundials.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "fixed_step.h"
#include "sundials.h"

#include <sunmatrix/sunmatrix_dense.h>

static const double consistent = 1e-12;

int tisserand_sundials_rates(sunrealtype t, N_Vector y, N_Vector ydot, void *ode)
{
    return tisserand_ode_rates((const tisserand_ode *) ode, t, N_VGetArrayPointer(y), N_VGetArrayPointer(ydot));
}

int tisserand_sundials_jacobian(sunrealtype t, N_Vector y, N_Vector ydot, SUNMatrix J, void *ode, N_Vector unused1,
                                N_Vector unused2, N_Vector unused3)
{
    const tisserand_ode *own = (const tisserand_ode *) ode;
    const int n = own->model->nq + own->model->nv;
    double *dy = N_VGetArrayPointer(unused1);
    int code = tisserand_ode_linearise(own, t, N_VGetArrayPointer(y));

    (void) ydot, (void) unused2, (void) unused3;
    N_VConst(0.0, unused1);
    for (int j = 0; j < n && code == 0; j++) {
        dy[j] = 1.0;
        code = tisserand_ode_change(own, t, N_VGetArrayPointer(y), dy, -1, SUNDenseMatrix_Column(J, j));
        dy[j] = 0.0;
    }
    return code;
}

int tisserand_sundials_sensitivities(int count, sunrealtype t, N_Vector y, N_Vector ydot, N_Vector *dy, N_Vector *dydot,
                                     void *ode, N_Vector unused1, N_Vector unused2)
{
    const tisserand_ode *own = (const tisserand_ode *) ode;
    int code = tisserand_ode_linearise(own, t, N_VGetArrayPointer(y));

    (void) ydot, (void) unused1, (void) unused2;
    for (int i = 0; i < count && code == 0; i++) {
        code = tisserand_ode_change(own, t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy[i]), i,
                                    N_VGetArrayPointer(dydot[i]));
    }
    return code;
}

int tisserand_sundials_postprocess(sunrealtype t, N_Vector y, void *ode)
{
    const tisserand_ode *own = (const tisserand_ode *) ode;
    const tisserand_model *model = own->model;
    double *q = N_VGetArrayPointer(y);
    tisserand_fixed_counts ignored = {0, 0, 0, 0};
    const int code = tisserand_normalise(model, q);
    return code != 0 ? code : tisserand_project(model, t, own->k, consistent, q, q + model->nq, own->work, &ignored);
}

int tisserand_sundials_projection(sunrealtype t, N_Vector y, N_Vector correction, sunrealtype tolerance, N_Vector error,
                                  void *ode)
{
    int code;

    (void) tolerance, (void) error;
    N_VScale(1.0, y, correction);
    code = tisserand_sundials_postprocess(t, correction, ode);
    N_VLinearSum(1.0, correction, -1.0, y, correction);
    return code;
}
