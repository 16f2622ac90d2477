/*
 * SPDX-License-Identifier: 0BSD
 *
 * The generalised-alpha method with fixed steps for a scene in its form of index 3: every step meets g = 0, and gdot = 0
 * to the second order. The method has order 2 in q, v and lambda, is stable for any step, and damps vibrations that the
 * step does not resolve, by the factor rho per step in the limit. See M. Arnold & O. Bruels, Convergence of the
 * generalized-alpha scheme for constrained mechanical systems, Multibody System Dynamics 18 (2007) 185-202.
 *
 * In space a step changes a rotation by a rotation vector x, e = e0 * exp(x), whose formula is that of a coordinate with
 * the angular velocity in the frame of the body in place of its rate; see O. Bruels & A. Cardona, On the use of Lie group
 * time integrators in multibody dynamics, Journal of Computational and Nonlinear Dynamics 5 (2010) 031002. Quaternions
 * have length 1 after every step.
 *
 * Linear equations are solved by KLU of SuiteSparse. With Debian or Ubuntu: apt-get install libsuitesparse-dev, then
 *
 *     cc -std=c99 -isystem /usr/include/suitesparse -DTISSERAND_HEADER='"my_scene.h"' generalised_alpha.c \
 *        rotations.c fixed_step.c my_scene.c my_program.c -lklu -lm
 */

#ifndef TISSERAND_GENERALISED_ALPHA_H
#define TISSERAND_GENERALISED_ALPHA_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#include "fixed_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Return codes of tisserand_alpha in addition to those of fixed_step.h. */
enum {
    TISSERAND_NO_INDEX3 = 5, /* no form of index 3, as a body without a scene */
    TISSERAND_NO_MEMORY = 6,
    TISSERAND_SINGULAR = 7,      /* the iteration matrix is singular */
    TISSERAND_NO_CONVERGENCE = 8 /* Newton's method does not converge: the step is too long */
};

typedef struct {
    double rho;       /* 0 to 1: the factor by which a step reduces vibrations of infinite frequency; with 1, without
                         damping, errors of the multipliers oscillate as well */
    double tolerance; /* Newton's method stops if the corrections of q, and of v times the step, are below it, or are
                         rounding errors of the largest coordinate */
    double start;     /* the initial q and v are projected onto |g|, |gdot| <= start; 0: they are not projected */
    double proximal;  /* for redundant joints, 1e-9: the part of each multiplier's compliance that the iteration matrix
                         has in addition, so that it is regular; the motion is that of the constraints, and multipliers
                         of redundant joints are some that give it. 0: joints are not redundant */
} tisserand_alpha_options;

typedef struct {
    long steps;
    long residuals; /* equal to the iterations of Newton's method */
    long jacobians; /* equal to the factorisations */
} tisserand_alpha_counts;

/* Integrate from t0 by a number of steps. `rows` gets q, v, lambda at t0 and after every `every` steps,
   steps / every + 1 in all; the observer of fixed_step.h, which may be 0, is called with each. If the code is not 0, q
   and v are undefined, and the rows from the failure on are NaN.
   Memory is allocated before the first step; KLU allocates more if it has to choose other pivots later. */
int tisserand_alpha(
    const tisserand_model *model,
    const tisserand_alpha_options *options,
    double t0,
    double step,
    long steps,
    long every,
    const double *k,
    double *q,
    double *v,
    double *rows,
    const tisserand_observer *observer,
    tisserand_alpha_counts *counts);

#ifdef __cplusplus
}
#endif

#endif
