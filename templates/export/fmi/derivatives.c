/* SPDX-License-Identifier: 0BSD -- see derivatives.h. */

#include "derivatives.h"

/* Knowns are the inputs, parameters and states, unknowns the derivatives of states and the outputs, which follow. */
enum { FIRST_KNOWN = 1 };

static unsigned first_unknown(const fmu_instance *fmu)
{
    return (unsigned) (FIRST_KNOWN + fmu->nu + fmu->model->np + fmu->nx);
}

static unsigned end_of_unknowns(const fmu_instance *fmu)
{
    return first_unknown(fmu) + (unsigned) (fmu->nx + fmu->nout);
}

int fmu_derivatives_work(const tisserand_model *model)
{
    const int nu = model->ports == NULL ? 0 : model->ports->nu, nout = model->ports == NULL ? 0 : model->ports->nout;
    return FIRST_KNOWN + 2 * (nu + model->np) + 2 * (model->nq + model->nv) + nout;
}

/* The changes of all variables by their references, and those of [p; u] behind them, which are zero */
typedef struct {
    double *all, *x, *xdot, *out, *pu;
} changes;

static changes no_changes(fmu_instance *fmu)
{
    changes d;
    d.all = fmu->derivatives;
    d.x = d.all + FIRST_KNOWN + fmu->nu + fmu->model->np;
    d.xdot = d.x + fmu->nx;
    d.out = d.xdot + fmu->nx;
    d.pu = d.out + fmu->nout;
    for (int i = 0; i < fmu_derivatives_work(fmu->model); i++) {
        d.all[i] = 0.0;
    }
    return d;
}

/* Prepare the derivatives in the present state; refuse references of other variables. */
static fmu_status begin(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                        size_t known_count)
{
    fmu_status status;

    if (fmu->model->parameter_jacobian == NULL) {
        return fmu_fail(fmu, FMU_ERROR, "this unit has no partial derivatives");
    }
    for (size_t i = 0; i < unknown_count; i++) {
        if (unknowns[i] < first_unknown(fmu) || unknowns[i] >= end_of_unknowns(fmu)) {
            return fmu_fail(fmu, FMU_ERROR, "there are partial derivatives of outputs and of derivatives of states alone");
        }
    }
    for (size_t i = 0; i < known_count; i++) {
        if (knowns[i] < FIRST_KNOWN || knowns[i] >= first_unknown(fmu)) {
            return fmu_fail(fmu, FMU_ERROR,
                            "there are partial derivatives with respect to inputs, parameters and states alone");
        }
    }
    status = fmu_evaluate(fmu);
    if (status == FMU_OK && !fmu->linearised) {
        fmu->linearised = tisserand_ode_linearise(&fmu->ode, fmu->state[FMU_TIME], fmu->x) == 0;
        status = fmu->linearised ? FMU_OK : fmu_fail(fmu, FMU_DISCARD, "the derivatives have no value in this state");
    }
    return status;
}

static fmu_status unsolved(fmu_instance *fmu, int code)
{
    return code == 0 ? FMU_OK : fmu_fail(fmu, FMU_DISCARD, "the equations of motion have no unique solution here");
}

fmu_status fmu_directional(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                           size_t known_count, const double *seed, double *result)
{
    const int nu = fmu->nu, np = fmu->model->np;
    fmu_status status = begin(fmu, unknowns, unknown_count, knowns, known_count);

    if (status == FMU_OK) {
        const changes d = no_changes(fmu);
        for (size_t i = 0; i < known_count; i++) {
            d.all[knowns[i]] += seed[i];
        }
        for (int i = 0; i < np + nu; i++) {
            d.pu[i] = d.all[FIRST_KNOWN + (i < np ? nu + i : i - np)];
        }
        status = unsolved(fmu, tisserand_ode_directional(&fmu->ode, fmu->state[FMU_TIME], fmu->x, d.x, d.pu, d.xdot, d.out));
        for (size_t i = 0; i < unknown_count && status == FMU_OK; i++) {
            result[i] = d.all[unknowns[i]];
        }
    }
    return status;
}

fmu_status fmu_adjoint(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                       size_t known_count, const double *seed, double *result)
{
    const int nu = fmu->nu, np = fmu->model->np;
    fmu_status status = begin(fmu, unknowns, unknown_count, knowns, known_count);

    if (status == FMU_OK) {
        const changes d = no_changes(fmu);
        for (size_t i = 0; i < unknown_count; i++) {
            d.all[unknowns[i]] += seed[i];
        }
        status = unsolved(fmu, tisserand_ode_adjoint(&fmu->ode, fmu->state[FMU_TIME], fmu->x, d.xdot, d.out, d.x, d.pu));
        for (int i = 0; i < np + nu; i++) {
            d.all[FIRST_KNOWN + (i < np ? nu + i : i - np)] = d.pu[i];
        }
        for (size_t i = 0; i < known_count && status == FMU_OK; i++) {
            result[i] = d.all[knowns[i]];
        }
    }
    return status;
}
