/*
 * SPDX-License-Identifier: 0BSD
 *
 * Fixed steps of the generalised-alpha method for a planar scene as it stands, of index 3: g = 0 holds in every step,
 * gdot = 0 to the second order. The method has order 2 in q, v and lambda, is stable for any step, and damps vibrations
 * that the step cannot follow: in each step by the factor rho at the most. See M. Arnold & O. Bruels, Convergence of
 * the generalized-alpha scheme for constrained mechanical systems, Multibody System Dynamics 18 (2007) 185-202.
 *
 * Linear equations are solved by KLU of SuiteSparse. With Debian or Ubuntu: apt-get install libsuitesparse-dev, then
 *
 *     cc -std=c99 -isystem /usr/include/suitesparse -DTISSERAND_HEADER='"my_scene.h"' generalised_alpha.c \
 *        fixed_step.c my_scene.c my_program.c -lklu -lm
 */

#ifndef TISSERAND_GENERALISED_ALPHA_H
#define TISSERAND_GENERALISED_ALPHA_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What tisserand_alpha returns besides the codes of fixed_step.h. */
enum {
    TISSERAND_NO_INDEX3 = 5, /* no such form, or a model in space: its q and v have different sizes */
    TISSERAND_NO_MEMORY = 6,
    TISSERAND_SINGULAR = 7,      /* KLU found the iteration matrix singular */
    TISSERAND_NO_CONVERGENCE = 8 /* of Newton's method: the step is too long */
};

typedef struct {
    double rho;       /* 0 to 1: what is left, in a step, of vibrations of infinite frequency; 1: no damping at all,
                         neither of errors in the multipliers, which oscillate then */
    double tolerance; /* Newton's method stops at corrections of q, and of v times the step, that are below it (times
                         the largest coordinate, if that is above 1) */
    double start;     /* q and v are brought to |g|, |gdot| <= start at first; 0: they are taken as they are */
} tisserand_alpha_options;

typedef struct {
    long steps;
    long residuals; /* and iterations of Newton's method */
    long jacobians; /* and factorisations */
} tisserand_alpha_counts;

/* All the steps from t0 on. `rows` gets q, v, lambda at t0 and after every `every` steps, steps / every + 1 in all. When
   the code is not 0, q and v hold nothing of use, and the rows from the failure on hold NaN. Memory is allocated
   before the first step; KLU allocates more should it have to choose other pivots on the way. */
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
    tisserand_alpha_counts *counts);

#ifdef __cplusplus
}
#endif

#endif
