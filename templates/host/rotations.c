/* SPDX-License-Identifier: 0BSD -- see rotations.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "rotations.h"

#include <math.h>

/* Squares of angles below this are small: two terms of the series of the tangent operator are exact to 1e-10. */
#define SMALL 1e-4

int tisserand_places_size(const tisserand_model *model)
{
    /* a place of each velocity; a rotation of two ints has four coordinates */
    return model->nv + model->nq;
}

tisserand_places tisserand_find_places(const tisserand_model *model, int *memory)
{
    tisserand_places places;
    int q = 0, v = 0, component = 0;

    places.coordinate = memory;
    places.rotations = (tisserand_rotation *) (memory + model->nv);
    places.nrotations = 0;
    for (int i = 0; i < model->variables_q; i++) {
        for (int n = 0; n < model->q[i].size; n++, q++) {
            if (model->q[i].role != TISSERAND_ROLE_QUATERNION) {
                places.coordinate[v++] = q;
                continue;
            }
            if (component == 0) {
                places.rotations[places.nrotations].q = q;
                places.rotations[places.nrotations].v = v;
                places.nrotations++;
                for (int k = 0; k < 3; k++) {
                    places.coordinate[v++] = -1;
                }
            }
            component = (component + 1) % 4;
        }
    }
    return places;
}

void tisserand_rotate(const tisserand_places *places, const double *first, const double *x, double *q)
{
    for (int i = 0; i < places->nrotations; i++) {
        const double *p = first + places->rotations[i].q, *w = x + places->rotations[i].v;
        const double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]), c = cos(0.5 * angle);
        const double s = angle > 0.0 ? sin(0.5 * angle) / angle : 0.5;
        const double a = s * w[0], b = s * w[1], d = s * w[2];
        double *e = q + places->rotations[i].q, length;
        e[0] = c * p[0] - a * p[1] - b * p[2] - d * p[3];
        e[1] = c * p[1] + a * p[0] + d * p[2] - b * p[3];
        e[2] = c * p[2] + b * p[0] + a * p[3] - d * p[1];
        e[3] = c * p[3] + d * p[0] + b * p[1] - a * p[2];
        length = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
        for (int k = 0; k < 4; k++) {
            e[k] /= length;
        }
    }
}

void tisserand_tangent(const double *x, double T[3][3])
{
    const double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], angle = sqrt(square);
    const double b = square < SMALL ? 0.5 - square / 24.0 : (1.0 - cos(angle)) / square;
    const double c = square < SMALL ? 1.0 / 6.0 - square / 120.0 : (angle - sin(angle)) / (square * angle);

    /* I - b [x] + c [x]^2, with the matrix [x] of x times */
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        T[i][i] = 1.0 - c * (x[j] * x[j] + x[k] * x[k]);
        T[i][j] = c * x[i] * x[j] + b * x[k];
        T[i][k] = c * x[i] * x[k] - b * x[j];
    }
}
