/*
 * SPDX-License-Identifier: 0BSD
 *
 * Model exchange: an importer integrates the states of an instance, and the unit asks for events in which it projects them
 * onto the constraints.
 */

#ifndef TISSERAND_FMU_EXCHANGE_H
#define TISSERAND_FMU_EXCHANGE_H

#include "instance.h"

fmu_status fmu_set_time(
    fmu_instance *fmu,
    double t);

fmu_status fmu_set_states(
    fmu_instance *fmu,
    const double *x,
    size_t count);

/* The states x; before the simulation they are those of the consistent state. */
fmu_status fmu_states(
    fmu_instance *fmu,
    double *x,
    size_t count);

fmu_status fmu_derivatives(
    fmu_instance *fmu,
    double *xdot,
    size_t count);

fmu_status fmu_nominals(
    fmu_instance *fmu,
    double *nominals,
    size_t count);

/* Whether the state x has left the constraints, or a quaternion its length, by more than an integrator may. */
fmu_status fmu_drifted(
    fmu_instance *fmu,
    int *drifted);

/* Project x onto the constraints; changed: whether this was necessary. next: the time of the next break, or 0 if there
   is none. */
fmu_status fmu_event(
    fmu_instance *fmu,
    int *changed,
    double *next,
    int *has_next);

#endif
