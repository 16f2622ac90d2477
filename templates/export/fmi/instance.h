/*
 * SPDX-License-Identifier: 0BSD
 *
 * An instance of a generated model as functional mock-up units have it, for every version of FMI: its modes, its messages and
 * what follows from its state. Around it are variables.h (values), exchange.h (model exchange), step.h (co-simulation),
 * derivatives.h and stored.h (states that are stored); fmi2.c and fmi3.c are the interfaces. All memory is allocated in
 * fmu_create, and for stored states.
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

/* With the numbers of both versions of FMI. */
typedef enum { FMU_OK = 0, FMU_DISCARD = 2, FMU_ERROR = 3 } fmu_status;

/* Model exchange alternates between two modes; co-simulation is in one between its steps. */
enum { FMU_INSTANTIATED, FMU_INITIALISING, FMU_EVENT, FMU_CONTINUOUS, FMU_BETWEEN_STEPS, FMU_TERMINATED };

/* Positions and velocities meet the constraints up to this (m, rad), or up to rounding errors. */
#define FMU_CONSISTENT 1e-12

/* The first values of a state; u, p, the start values of x and x follow. FMU_NEXT is the next break, FMU_LENGTH that of
   the next step of the integrator, or 0. */
enum { FMU_TIME, FMU_STOP, FMU_TOLERANCE, FMU_NEXT, FMU_LENGTH, FMU_MODE, FMU_FIRST };

typedef void fmu_log(
    void *owner,
    fmu_status status,
    const char *category,
    const char *message);

typedef struct {
    const tisserand_model *model;
    int nu, nx, nout;
    int exchange;     /* whether it is one of model exchange */
    int count;        /* the number of values of a state */
    double *state;    /* all that a stored state consists of */
    double *u, *p, *start, *x; /* parts of the state */
    double *k, *xdot, *out, *energy, *lambda;
    double *atol, *trial, *work, *derivatives;
    int set_up;     /* whether k belongs to p */
    int evaluated;  /* whether x (before the simulation), xdot, out, energy and lambda belong to the state */
    int linearised; /* whether the Jacobians of ode belong to the state */
    tisserand_ode ode;
    tisserand_adaptive solver;
    tisserand_model moving; /* the model with prescribed motions that go on within a step of co-simulation */
    tisserand_scene moving_scene;
    fmu_log *log;
    void *owner;
    int silent[2]; /* whether messages of errors and of discarded states are not logged */
} fmu_instance;

/* A new instance with the start values; 0 if the token is of another unit or there is no memory. */
fmu_instance *fmu_create(
    const char *token,
    int exchange,
    fmu_log *log,
    void *owner);

void fmu_free(
    fmu_instance *fmu);

fmu_status fmu_reset(
    fmu_instance *fmu);

/* Log a message and return the status. */
fmu_status fmu_fail(
    fmu_instance *fmu,
    fmu_status status,
    const char *message);

/* Fail with what a code of the model or of an integration means. */
fmu_status fmu_failed(
    fmu_instance *fmu,
    fmu_status status,
    int code);

/* Log the messages of categories, or of all if there are none, or do not. */
fmu_status fmu_set_logging(
    fmu_instance *fmu,
    int on,
    size_t count,
    const char *const *categories);

/* Return FMU_OK if the mode is between two, else an error. */
fmu_status fmu_in_mode(
    fmu_instance *fmu,
    int first,
    int last);

/* Pass from one of the modes between two to another. */
fmu_status fmu_enter(
    fmu_instance *fmu,
    int first,
    int last,
    int mode);

/* The experiment: a tolerance that is 0 is not given, and a stop time is infinite if there is none. */
fmu_status fmu_set_up_experiment(
    fmu_instance *fmu,
    double tolerance,
    double t,
    double stop);

fmu_status fmu_enter_initialisation(
    fmu_instance *fmu);

/* Find the consistent state with which the simulation begins. */
fmu_status fmu_exit_initialisation(
    fmu_instance *fmu);

/* Compute all that follows from the state; before the simulation also x, from the start values. */
fmu_status fmu_evaluate(
    fmu_instance *fmu);

/* The time with which functions of time are evaluated: until an event they go on smoothly up to a break. */
double fmu_smooth_time(
    const fmu_instance *fmu);

/* Find the next break, FMU_NEXT: it is infinite if there is none. */
void fmu_find_break(
    fmu_instance *fmu);

/* Make k that of the parameters and the inputs. Returns a code of the model. */
int fmu_prepare(
    fmu_instance *fmu);

/* Project x onto the constraints. Returns a code of the model or TISSERAND_OFF. */
int fmu_project(
    fmu_instance *fmu,
    double *x);

/* The tolerance of projections of x: rounding errors may be larger than FMU_CONSISTENT. */
double fmu_consistent(
    const fmu_instance *fmu,
    const double *x);

void fmu_copy(
    int n,
    const double *from,
    double *to);

/* The largest magnitude of n numbers */
double fmu_largest(
    int n,
    const double *x);

#endif
