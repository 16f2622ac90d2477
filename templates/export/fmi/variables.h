/*
 * SPDX-License-Identifier: 0BSD
 *
 * The values of the variables of an instance, by their references.
 */

#ifndef TISSERAND_FMU_VARIABLES_H
#define TISSERAND_FMU_VARIABLES_H

#include "instance.h"

fmu_status fmu_get(
    fmu_instance *fmu,
    const unsigned *references,
    size_t count,
    double *values);

/* Set inputs, and in their modes parameters and start values of states. */
fmu_status fmu_set(
    fmu_instance *fmu,
    const unsigned *references,
    size_t count,
    const double *values);

#endif
