/* SPDX-License-Identifier: 0BSD -- see variables.h. */

#include "variables.h"

#include <math.h>

/* The address of the value of a reference */
static double *address(const fmu_instance *fmu, unsigned reference)
{
    const tisserand_model *model = fmu->model;
    double *const parts[] = {fmu->state + FMU_TIME, fmu->u, fmu->p, fmu->x, fmu->xdot, fmu->out, fmu->energy, fmu->lambda};
    const int sizes[] = {1, fmu->nu, model->np, fmu->nx, fmu->nx, fmu->nout, model->nenergy, model->nlambda};
    unsigned first = 0;

    for (int i = 0; i < (int) (sizeof sizes / sizeof *sizes); i++) {
        if (reference < first + (unsigned) sizes[i]) {
            return parts[i] + (reference - first);
        }
        first += (unsigned) sizes[i];
    }
    return NULL;
}

fmu_status fmu_get(fmu_instance *fmu, const unsigned *references, size_t count, double *values)
{
    const unsigned given = (unsigned) (1 + fmu->nu + fmu->model->np);

    for (size_t i = 0; i < count; i++) {
        const double *value = address(fmu, references[i]);
        if (value == NULL) {
            return fmu_fail(fmu, FMU_ERROR, "there is no real variable with this value reference");
        }
        if (references[i] >= given) {
            const fmu_status status = fmu_evaluate(fmu);
            if (status != FMU_OK) {
                return status;
            }
        }
        values[i] = *value;
    }
    return FMU_OK;
}

/* Where a value is set: a start value for a state before the simulation; NULL if it cannot be set in the present mode */
static double *target(const fmu_instance *fmu, unsigned reference)
{
    const unsigned parameters = (unsigned) (1 + fmu->nu), states = parameters + (unsigned) fmu->model->np;
    const int mode = (int) fmu->state[FMU_MODE];

    if (reference == 0) {
        return NULL;
    }
    if (reference < parameters) {
        return address(fmu, reference);
    }
    if (reference < states) {
        return mode == FMU_CONTINUOUS ? NULL : address(fmu, reference);
    }
    return reference < states + (unsigned) fmu->nx && mode <= FMU_INITIALISING ? fmu->start + (reference - states) : NULL;
}

fmu_status fmu_set(fmu_instance *fmu, const unsigned *references, size_t count, const double *values)
{
    const fmu_status status = fmu_in_mode(fmu, FMU_INSTANTIATED, FMU_BETWEEN_STEPS);

    for (size_t i = 0; i < count && status == FMU_OK; i++) {
        double *value = target(fmu, references[i]);
        if (!(fabs(values[i]) < HUGE_VAL)) {
            return fmu_fail(fmu, FMU_ERROR, "a value that is set is not finite");
        }
        if (value == NULL) {
            return fmu_fail(fmu, FMU_ERROR, "inputs can be set, parameters except in continuous-time mode, and states "
                                            "before the simulation; no other variable");
        }
        if (*value != values[i]) {
            *value = values[i];
            fmu->evaluated = 0;
            fmu->set_up = fmu->set_up && !(value >= fmu->p && value < fmu->start);
        }
    }
    return status;
}
