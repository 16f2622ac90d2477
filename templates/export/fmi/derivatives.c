/* SPDX-License-Identifier: 0BSD -- see derivatives.h. */

#include "derivatives.h"

/* Knowns are the inputs, parameters and states, unknowns the derivatives of states and the outputs, which follow. In the
   initialisation the states are unknowns, since they follow from the parameters and inputs. */
enum { FIRST_KNOWN = 1 };

static int initial(const fmu_instance *fmu)
{
    return fmu->state[FMU_MODE] == FMU_INITIALISING;
}

static unsigned first_unknown(const fmu_instance *fmu)
{
    return (unsigned) (FIRST_KNOWN + fmu->nu + fmu->model->np + (initial(fmu) ? 0 : fmu->nx));
}

static unsigned end_of_unknowns(const fmu_instance *fmu)
{
    return (unsigned) (FIRST_KNOWN + fmu->nu + fmu->model->np + 2 * fmu->nx + fmu->nout);
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

/* Refuse references of other variables, and evaluate the present state. */
static fmu_status begin(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                        size_t known_count)
{
    const fmu_status status = fmu_in_mode(fmu, FMU_INITIALISING, FMU_TERMINATED);

    if (status != FMU_OK) {
        return status;
    }
    if (fmu->model->parameter_jacobian == NULL) {
        return fmu_fail(fmu, FMU_ERROR, "this unit has no partial derivatives");
    }
    for (size_t i = 0; i < unknown_count; i++) {
        if (unknowns[i] < first_unknown(fmu) || unknowns[i] >= end_of_unknowns(fmu)) {
            return fmu_fail(fmu, FMU_ERROR, "there are partial derivatives of outputs and of derivatives of states alone, "
                                            "and of states in the initialisation");
        }
    }
    for (size_t i = 0; i < known_count; i++) {
        if (knowns[i] < FIRST_KNOWN || knowns[i] >= first_unknown(fmu)) {
            return fmu_fail(fmu, FMU_ERROR, "there are partial derivatives with respect to inputs and parameters alone, and "
                                            "to states except in the initialisation");
        }
    }
    return fmu_evaluate(fmu);
}

/* Prepare the derivatives, unless they are those of the present state already. Returns a code of the model. */
static int linearise(fmu_instance *fmu)
{
    const int code = fmu->linearised ? 0 : tisserand_ode_linearise(&fmu->ode, fmu_smooth_time(fmu), fmu->x);
    fmu->linearised = code == 0;
    return code;
}

/* The change dx of the consistent state by parameter or input i. Afterwards the model is not linearised. */
static int start_change(fmu_instance *fmu, int i, double *dx)
{
    fmu->linearised = 0;
    return tisserand_ode_start_change(&fmu->ode, fmu_smooth_time(fmu), fmu->x, i, dx);
}

static fmu_status without_value(fmu_instance *fmu, int code)
{
    return code == 0 ? FMU_OK : fmu_fail(fmu, FMU_DISCARD, "the derivatives have no value in this state");
}

fmu_status fmu_directional(fmu_instance *fmu, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
                           size_t known_count, const double *seed, double *result)
{
    const int nu = fmu->nu, np = fmu->model->np;
    fmu_status status = begin(fmu, unknowns, unknown_count, knowns, known_count);

    if (status == FMU_OK) {
        const changes d = no_changes(fmu);
        int code = 0;
        for (size_t i = 0; i < known_count; i++) {
            d.all[knowns[i]] += seed[i];
        }
        for (int i = 0; i < np + nu; i++) {
            d.pu[i] = d.all[FIRST_KNOWN + (i < np ? nu + i : i - np)];
        }
        for (int i = 0; i < np + nu && initial(fmu) && code == 0; i++) {
            code = start_change(fmu, i, fmu->trial);
            for (int j = 0; j < fmu->nx; j++) {
                d.x[j] += d.pu[i] * fmu->trial[j];
            }
        }
        code = code != 0 ? code : linearise(fmu);
        code = code != 0 ? code
                         : tisserand_ode_directional(&fmu->ode, fmu_smooth_time(fmu), fmu->x, d.x, d.pu, d.xdot, d.out);
        status = without_value(fmu, code);
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
        double *of_states = fmu->trial, *dx = fmu->work; /* the weights of states, and their changes */
        int code = linearise(fmu);
        for (size_t i = 0; i < unknown_count; i++) {
            d.all[unknowns[i]] += seed[i];
        }
        fmu_copy(fmu->nx, d.x, of_states);
        code = code != 0 ? code
                         : tisserand_ode_adjoint(&fmu->ode, fmu_smooth_time(fmu), fmu->x, d.xdot, d.out, d.x, d.pu);
        for (int i = 0; i < np + nu && initial(fmu) && code == 0; i++) {
            code = start_change(fmu, i, dx);
            for (int j = 0; j < fmu->nx; j++) {
                d.pu[i] += (d.x[j] + of_states[j]) * dx[j];
            }
        }
        status = without_value(fmu, code);
        for (int i = 0; i < np + nu; i++) {
            d.all[FIRST_KNOWN + (i < np ? nu + i : i - np)] = d.pu[i];
        }
        for (size_t i = 0; i < known_count && status == FMU_OK; i++) {
            result[i] = d.all[knowns[i]];
        }
    }
    return status;
}
