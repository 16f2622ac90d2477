/*
 * SPDX-License-Identifier: 0BSD
 *
 * Steps of co-simulation. An input that prescribes a motion comes with its first two time derivatives, and between two times
 * at which an importer sets inputs it is u + u' s + u'' s^2 / 2, with the time s since then. A motion that stood still while
 * its speed does not vanish would violate its constraint.
 */

#ifndef TISSERAND_FMU_STEP_H
#define TISSERAND_FMU_STEP_H

#include "instance.h"

/* The number of doubles behind the nk constants k of a model. */
int fmu_motion_work(
    const tisserand_model *model);

/* Integrate by a step that begins at t. Inputs are constant in it, but for motions, which follow their time derivatives.
   Of a step that fails, the part up to a later state than before may have been made. */
fmu_status fmu_step(
    fmu_instance *fmu,
    double t,
    double step);

#endif
