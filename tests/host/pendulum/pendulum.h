/*
 * SPDX-License-Identifier: 0BSD
 *
 * A model written by hand, for the tests of hosts alone: see pendulum.c.
 */

#ifndef PENDULUM_H
#define PENDULUM_H

#ifdef __cplusplus
extern "C" {
#endif

/* ---- shared by all models: the tests put it here, from the template of generated headers ---- */

int pendulum_poses(double t, const double *q, const double *k, double *pose);
const tisserand_model *pendulum_model(void);

#ifdef __cplusplus
}
#endif

#endif
