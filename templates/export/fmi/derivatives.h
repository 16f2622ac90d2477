/*
 * SPDX-License-Identifier: 0BSD
 *
 * Directional and adjoint derivatives of an instance: of the time derivatives of the states and of the outputs, with respect to
 * the inputs, the parameters and the states. They are exact, see ode.h. In the initialisation they are those of the states, of
 * their derivatives and of the outputs with respect to the inputs and the parameters, with which the consistent state changes.
 */

#ifndef TISSERAND_FMU_DERIVATIVES_H
#define TISSERAND_FMU_DERIVATIVES_H

#include "instance.h"

/* The number of doubles of fmu->derivatives. */
int fmu_derivatives_work(
    const tisserand_model *model);

/* The derivatives of the unknowns in the direction of the seed of the knowns. */
fmu_status fmu_directional(
    fmu_instance *fmu,
    const unsigned *unknowns,
    size_t unknown_count,
    const unsigned *knowns,
    size_t known_count,
    const double *seed,
    double *result);

/* The derivatives of the sum of seed and unknowns with respect to the knowns. */
fmu_status fmu_adjoint(
    fmu_instance *fmu,
    const unsigned *unknowns,
    size_t unknown_count,
    const unsigned *knowns,
    size_t known_count,
    const double *seed,
    double *result);

#endif
