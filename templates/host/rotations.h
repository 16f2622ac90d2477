/*
 * SPDX-License-Identifier: 0BSD
 *
 * Rotations in the state of a generated model: a unit quaternion among the coordinates, and three components of the
 * angular velocity in the frame of the body among the velocities. An integrator on the group of rotations changes a
 * quaternion by a rotation vector x, in the frame at the beginning of a step: e = first * exp(x).
 */

#ifndef TISSERAND_ROTATIONS_H
#define TISSERAND_ROTATIONS_H

#ifndef TISSERAND_ABI
#  error "include the header of a generated model before this one"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The first coordinate of a quaternion, and the first component of its angular velocity. */
typedef struct {
    int q, v;
} tisserand_rotation;

/* Which coordinates belong to which velocities. */
typedef struct {
    int *coordinate; /* of each velocity; -1 of one that belongs to a quaternion */
    tisserand_rotation *rotations;
    int nrotations;
} tisserand_places;

/* The number of ints of the memory that tisserand_find_places takes. */
int tisserand_places_size(
    const tisserand_model *model);

/* Find the places of a model; the result refers to `memory`. */
tisserand_places tisserand_find_places(
    const tisserand_model *model,
    int *memory);

/* Turn the quaternions among the coordinates `first` by the vectors among x (nv doubles); q gets the results, of length
   1. Other elements of q stay as they are. */
void tisserand_rotate(
    const tisserand_places *places,
    const double *first,
    const double *x,
    double *q);

/* The tangent operator T of exp(x): after a change dx of x the rotation differs by T dx, in the frame that has turned. */
void tisserand_tangent(
    const double *x,
    double T[3][3]);

#ifdef __cplusplus
}
#endif

#endif
