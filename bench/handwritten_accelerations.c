/*
 * Accelerations of a free planar beam with N = 2, 4 or 8 shape functions, written by hand as a yardstick: no checks, one
 * division, one call for sine and cosine, and constant blocks of the mass matrix eliminated beforehand.
 *
 * The translations are those of the centre of mass in the body frame, so that the rigid block is the scalar S alone. Even
 * and odd shapes do not couple except through phi. Everything is divided by the mass. G is the Gram matrix of the shapes
 * about the centre of mass, B the inverse of the elastic block times the stiffness.
 *
 * Automatic vectorisation is off because it doubles the time: the amplitudes of both parities alternate in q.
 */
#define _GNU_SOURCE
#include <math.h>

#define SCALAR __attribute__((optimize("no-tree-vectorize")))
#define EACH(i) _Pragma("GCC unroll 8") for (int i = 0; i < E; i++)

enum { E = N / 2 };

/* even: shapes 1, 3, ... (they move the centre of mass); odd: shapes 2, 4, ... (their first moment couples to phi) */
typedef struct {
    double S, even_G[E][E], odd_G[E][E], even_B[E][E], odd_B[E][E];
    double origin[E];             /* acceleration of the origin along e2 due to the even shapes */
    double centre[E];             /* the centre of mass along e2 */
    double moment[E], share[E];   /* first moments of the odd shapes, and G^-1 times them */
    double stiffness[E];          /* share times the stiffness */
} point_constants;

SCALAR void hand_point_accel(const double *restrict q, const double *restrict v, const double *restrict constants,
    double *restrict vdot)
{
    const point_constants *restrict k = (const point_constants *) constants;
    double sine, cosine;
    sincos(q[2], &sine, &cosine);
    const double w = v[2], w2 = w * w, twice = w + w;
    double S = k->S, coriolis = 0, moment = 0, centre = 0, moving = 0, x2 = 0;
    EACH(i) {
        double even = 0, odd = 0;
        EACH(j) even += k->even_G[i][j] * q[3 + 2 * j];
        EACH(j) odd += k->odd_G[i][j] * q[4 + 2 * j];
        S += even * q[3 + 2 * i] + odd * q[4 + 2 * i];
        coriolis += even * v[3 + 2 * i] + odd * v[4 + 2 * i];
        moment += (w2 * k->moment[i] - k->stiffness[i]) * q[4 + 2 * i];
        centre += k->centre[i] * q[3 + 2 * i];
        moving += k->centre[i] * v[3 + 2 * i];
        x2 += k->origin[i] * q[3 + 2 * i];
    }
    const double wd = -(twice * coriolis + moment) / S, x1 = twice * moving + centre * wd;
    vdot[0] = cosine * x1 - sine * x2;
    vdot[1] = sine * x1 + cosine * x2;
    vdot[2] = wd;
    EACH(i) {
        double even = w2 * q[3 + 2 * i], odd = w2 * q[4 + 2 * i] - k->share[i] * wd;
        EACH(j) even -= k->even_B[i][j] * q[3 + 2 * j];
        EACH(j) odd -= k->odd_B[i][j] * q[4 + 2 * j];
        vdot[3 + 2 * i] = even;
        vdot[4 + 2 * i] = odd;
    }
}

typedef struct {
    double S, c8[N], even_B[E][E], odd_B[E][E];
} mean_constants;

SCALAR void hand_mean_accel(const double *restrict q, const double *restrict v, const double *restrict constants,
    double *restrict vdot)
{
    const mean_constants *restrict k = (const mean_constants *) constants;
    const double w = v[2], w2 = w * w;
    double S = k->S, coriolis = 0;
#pragma GCC unroll 8
    for (int i = 0; i < N; i++) {
        const double D2 = k->c8[i] * q[3 + i];
        S += D2 * q[3 + i];
        coriolis += D2 * v[3 + i];
    }
    vdot[0] = 0;
    vdot[1] = 0;
    vdot[2] = -(w + w) * coriolis / S;
    EACH(i) {
        double even = w2 * q[3 + 2 * i], odd = w2 * q[4 + 2 * i];
        EACH(j) even -= k->even_B[i][j] * q[3 + 2 * j];
        EACH(j) odd -= k->odd_B[i][j] * q[4 + 2 * j];
        vdot[3 + 2 * i] = even;
        vdot[4 + 2 * i] = odd;
    }
}
