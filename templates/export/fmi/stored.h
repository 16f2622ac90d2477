/*
 * SPDX-License-Identifier: 0BSD
 *
 * States that are stored, in memory and as bytes: a header with the token of the unit, and the values.
 */

#ifndef TISSERAND_FMU_STORED_H
#define TISSERAND_FMU_STORED_H

#include "instance.h"

/* The number of bytes */
size_t fmu_state_size(
    const fmu_instance *fmu);

/* Store the state, in new memory if *stored is 0. */
fmu_status fmu_get_state(
    fmu_instance *fmu,
    void **stored);

fmu_status fmu_set_state(
    fmu_instance *fmu,
    const void *stored);

fmu_status fmu_free_state(
    void **stored);

fmu_status fmu_serialise(
    fmu_instance *fmu,
    const void *stored,
    unsigned char *bytes,
    size_t size);

/* The state of bytes, in new memory if *stored is 0. */
fmu_status fmu_deserialise(
    fmu_instance *fmu,
    const unsigned char *bytes,
    size_t size,
    void **stored);

#endif
