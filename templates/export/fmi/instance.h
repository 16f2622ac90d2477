/*
 * SPDX-License-Identifier: 0BSD
 *
 * An instance of a generated model as functional mock-up units have it, for every version of FMI: variables by their value
 * references, modes, the consistent initial state, steps of co-simulation, and states that are stored. The files fmi2.c and
 * fmi3.c are the interfaces around it. All memory is allocated in fmu_create, and by the caller for stored states.
 *
 * Value references count the time (0), the inputs u, the parameters p, the states x = [q; v], their time derivatives, the
 * outputs, the energies, and the multipliers lambda, in this order.
 */

#ifndef TISSERAND_FMU_INSTANCE_H
#define TISSERAND_FMU_INSTANCE_H

#include TISSERAND_HEADER
#include "adaptive.h"
#include "ode.h"

#include <stddef.h>

/* The model of this unit, in model.c. */
extern const char fmu_token[];         /* the hash of the sources */
extern const double fmu_tolerance;     /* of integrations that are given none */
extern const double fmu_start[];       /* u, x */
extern const double fmu_size[];        /* of each state: absolute tolerances are this times the tolerance */
extern const int fmu_orders[];         /* of each input: which time derivative of a prescribed motion it is, 0 of all others */
extern const int fmu_breaks;           /* the number of times at which functions of time are not smooth */
extern const double fmu_break_times[]; /* increasing; one more than there are */
const tisserand_model *fmu_model(void);

typedef enum { FMU_OK, FMU_DISCARD, FMU_ERROR } fmu_status;

enum { FMU_INSTANTIATED, FMU_INITIALISING, FMU_RUNNING, FMU_TERMINATED };

/* The first values of a state; u, p, the start values of x and x follow. */
enum { FMU_TIME, FMU_TOLERANCE, FMU_STEP, FMU_MODE, FMU_FIRST };

typedef struct {
    const tisserand_model *model;
    int nu, nx, nout;
    int variables;    /* the number of value references */
    int count;        /* the number of values of a state */
    double *state;    /* all that a stored state consists of */
    double *u, *p, *start, *x; /* parts of the state */
    double *k, *xdot, *out, *energy, *lambda;
    double *atol, *trial, *work, *derivatives;
    int set_up;    /* whether k belongs to p */
    int evaluated; /* whether x (before the simulation), xdot, out, energy and lambda belong to the state */
    int linearised; /* whether the Jacobians of ode belong to the state */
    tisserand_ode ode;
    tisserand_adaptive solver;
    tisserand_model moving; /* the model with prescribed motions that go on within a step of co-simulation */
    tisserand_scene moving_scene;
    void (*log)(void *owner, fmu_status status, const char *message);
    void *owner;
} fmu_instance;

/* A new instance with the start values; 0 if the token is of another unit or there is no memory. */
fmu_instance *fmu_create(
    const char *token,
    void (*log)(void *owner, fmu_status status, const char *message),
    void *owner);

void fmu_free(
    fmu_instance *fmu);

void fmu_reset(
    fmu_instance *fmu);

/* Log a message and return the status. */
fmu_status fmu_fail(
    fmu_instance *fmu,
    fmu_status status,
    const char *message);

/* Return FMU_OK if the mode is between two, else an error. */
fmu_status fmu_in_mode(
    fmu_instance *fmu,
    int first,
    int last);

/* Enter the initialisation at a time; a tolerance that is 0 is not given. */
fmu_status fmu_initialise(
    fmu_instance *fmu,
    double t,
    double tolerance);

/* Find the consistent state with which the simulation begins. */
fmu_status fmu_begin(
    fmu_instance *fmu);

fmu_status fmu_get(
    fmu_instance *fmu,
    const unsigned *references,
    size_t count,
    double *values);

fmu_status fmu_set(
    fmu_instance *fmu,
    const unsigned *references,
    size_t count,
    const double *values);

/* Compute all that follows from the state; before the simulation also x, from the start values. */
fmu_status fmu_evaluate(
    fmu_instance *fmu);

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

/* Integrate by a step. Inputs are constant in it, but for motions, which follow their time derivatives. Of a step that fails, the part up to a later state than before may have been made. */
fmu_status fmu_step(
    fmu_instance *fmu,
    double t,
    double step);

/* States as bytes: a header with the token, and the values. */
size_t fmu_state_size(
    const fmu_instance *fmu);

void fmu_store(
    const fmu_instance *fmu,
    unsigned char *bytes);

fmu_status fmu_restore(
    fmu_instance *fmu,
    const unsigned char *bytes,
    size_t size);

#endif
