/*
 * SPDX-License-Identifier: 0BSD
 *
 * Prescribed motions within a step of co-simulation: an input that prescribes a motion comes with its first two time
 * derivatives, and between two times at which an importer sets inputs it is u + u' s + u'' s^2 / 2, with the time s since then.
 * A motion that stood still while its speed does not vanish would violate its constraint.
 */

#ifndef TISSERAND_FMU_MOTION_H
#define TISSERAND_FMU_MOTION_H

#include "instance.h"

/* The number of doubles behind the nk constants k of a model. */
int fmu_motion_work(
    const tisserand_model *model);

/* Make the model of a step, whose functions set the inputs in k for the time with which they are called. */
void fmu_motion_begin(
    fmu_instance *fmu);

#endif
