/* SPDX-License-Identifier: 0BSD -- see generalised_alpha.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "generalised_alpha.h"
#include "rotations.h"

#include <klu.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The iterations of Newton's method after which the Jacobian is renewed, and the Jacobians of a step at most. */
enum { ITERATIONS = 4, JACOBIANS = 4 };

/* Corrections up to this part of the largest coordinate are rounding errors: those of g, which is a difference of
   coordinates, and of what follows from it for v times the step. */
#define TISSERAND_ROUNDING (16.0 * DBL_EPSILON)

/* The least part of the compliance that a constraint has if each of its factors is 1 m or 1 rad. A constraint that
   others imply entirely may have factors of rounding errors, which must not count as much as any other. */
static const double LEAST = 1.0 / 1024.0;

/* The coefficients of the method for a step length h. */
typedef struct {
    double alpha_m, alpha_f, beta, gamma;
    double cj;    /* of the iteration matrix: change of vdot over change of v */
    double scale; /* of its columns of q */
} scheme;

typedef struct {
    tisserand_dae form;
    scheme method;
    int nq, nv;
    double *y, *ydot; /* [q; v; lambda], [0; vdot; 0] */
    double *a;        /* the auxiliary accelerations of the method */
    double *x;        /* of rotations: the rotation vectors of a step (rad) */
    double *first;    /* q at the beginning of a step */
    double *r, *jac, *work;
    double proximal; /* the term of the diagonal of multipliers, relative to their compliance; 0: none */
    int *colptr, *rowidx;
    tisserand_places places;
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
} machine;

static scheme make_scheme(double rho, double h)
{
    scheme s;
    double to_v, to_vdot; /* changes of v and vdot over the change of q, in one step */
    s.alpha_m = (2.0 * rho - 1.0) / (rho + 1.0);
    s.alpha_f = rho / (rho + 1.0);
    s.gamma = 0.5 + s.alpha_f - s.alpha_m;
    s.beta = 0.25 * (s.gamma + 0.5) * (s.gamma + 0.5);
    to_v = s.gamma / (s.beta * h);
    to_vdot = (1.0 - s.alpha_m) / (s.beta * h * h * (1.0 - s.alpha_f));
    s.cj = to_vdot / to_v;
    s.scale = s.cj / to_v;
    return s;
}

static int find_form(const tisserand_model *model, tisserand_dae *form)
{
    for (int i = 0; model->scene != NULL && i < model->scene->nforms; i++) {
        if (strcmp(model->scene->forms[i].name, "index3") == 0) {
            *form = model->scene->forms[i];
            return 0;
        }
    }
    return TISSERAND_NO_INDEX3;
}

static int allocate(const tisserand_model *model, machine *own)
{
    const int n = own->form.size, nq = own->nq, nv = own->nv, nnz = own->form.pattern->nnz;
    const size_t doubles = (size_t) (3 * n + nq + 2 * nv + nnz + tisserand_fixed_work(model));

    own->y = (double *) calloc(doubles, sizeof(double));
    own->colptr = (int *) calloc((size_t) (n + 1 + nnz + tisserand_places_size(model)), sizeof(int));
    if (own->y == NULL || own->colptr == NULL) {
        return TISSERAND_NO_MEMORY;
    }
    own->ydot = own->y + n;
    own->r = own->ydot + n;
    own->a = own->r + n;
    own->x = own->a + nv;
    own->first = own->x + nv;
    own->jac = own->first + nq;
    own->work = own->jac + nnz;
    own->rowidx = own->colptr + n + 1;
    own->places = tisserand_find_places(model, own->rowidx + nnz);
    /* KLU takes pointers to non-const arrays although it does not change them: hence a copy of the model's tables. */
    if (own->form.pattern->colptr == NULL) {
        own->form.pattern->fill(own->colptr, own->rowidx);
    } else {
        memcpy(own->colptr, own->form.pattern->colptr, (size_t) (n + 1) * sizeof(int));
        memcpy(own->rowidx, own->form.pattern->rowidx, (size_t) nnz * sizeof(int));
    }
    klu_defaults(&own->common);
    own->symbolic = klu_analyze(n, own->colptr, own->rowidx, &own->common);
    return own->symbolic == NULL ? TISSERAND_SINGULAR : 0;
}

/* The entry (row, column) of the iteration matrix, which is in its pattern. */
static double *entry(const machine *own, int row, int column)
{
    int i = own->colptr[column];
    while (own->rowidx[i] != row) {
        i++;
    }
    return own->jac + i;
}

/* The rows of quaternions in the iteration matrix, which have cj dq - Z dv at first: with dq = Z T dx for the change dx
   of the rotation vector of the step, where Z is the matrix of qdot = Z v. */
static void turn_rows(machine *own)
{
    for (int i = 0; i < own->places.nrotations; i++) {
        const int q = own->places.rotations[i].q, v = own->places.rotations[i].v, column = own->nq + v;
        double T[3][3];
        tisserand_tangent(own->x + v, T);
        for (int row = q; row < q + 4; row++) {
            double Z[3];
            for (int k = 0; k < 3; k++) {
                Z[k] = *entry(own, row, column + k);
            }
            for (int k = 0; k < 3; k++) {
                *entry(own, row, column + k) = Z[0] * T[0][k] + Z[1] * T[1][k] + Z[2] * T[2][k];
            }
        }
        for (int j = q; j < q + 4; j++) {
            for (int e = own->colptr[j]; e < own->colptr[j + 1]; e++) {
                if (own->rowidx[e] >= q && own->rowidx[e] < q + 4) {
                    own->jac[e] = own->rowidx[e] == j ? own->method.cj : 0.0;
                }
            }
        }
    }
}

/* Add the proximal term to the diagonal of the multipliers: a part of the compliance G A^-1 G^T of the constraint,
   estimated by the diagonal of A, the matrix of the rows of vdot. A solution is off by this part of itself, which the
   next iteration of Newton's method corrects; reactions of redundant joints that balance each other are finite. */
static void add_proximal(machine *own)
{
    const int nq = own->nq, of_joints = nq + own->nv, n = own->form.size;

    for (int j = of_joints; j < n; j++) {
        double compliance = 0.0, full = 0.0;
        for (int i = own->colptr[j]; i < own->colptr[j + 1]; i++) {
            const int row = own->rowidx[i];
            if (row >= nq && row < of_joints) {
                const double inverse = 1.0 / fabs(*entry(own, row, row));
                compliance += own->jac[i] * own->jac[i] * inverse;
                full += inverse;
            }
        }
        compliance = full > 0.0 ? fmax(compliance, LEAST * full) : 1.0;
        *entry(own, j, j) += own->proximal * own->method.scale / own->method.cj * compliance;
    }
}

/* The iteration matrix of [x; dv; dlambda]: that of the form, which assumes dq = dv / cj, with its columns of q scaled
   by dq = scale * x, since the factor between dq and dv differs from that between dv and the change of vdot. */
static int factorise(double t, const double *k, machine *own)
{
    const int code = own->form.jacobian(t, own->y, own->ydot, own->method.cj, k, own->jac);

    if (code != 0) {
        return code;
    }
    turn_rows(own);
    for (int i = 0; i < own->colptr[own->nq]; i++) {
        if (own->rowidx[i] >= own->nq) {
            own->jac[i] *= own->method.scale;
        }
    }
    if (own->proximal > 0.0) {
        add_proximal(own);
    }
    if (own->numeric != NULL) {
        /* Reuse the previous pivots unless the factors grow. */
        if (klu_refactor(own->colptr, own->rowidx, own->jac, own->symbolic, own->numeric, &own->common) &&
            klu_rgrowth(own->colptr, own->rowidx, own->jac, own->symbolic, own->numeric, &own->common) &&
            own->common.rgrowth > 1e-4) {
            return 0;
        }
        klu_free_numeric(&own->numeric, &own->common);
    }
    own->numeric = klu_factor(own->colptr, own->rowidx, own->jac, own->symbolic, &own->common);
    return own->numeric == NULL ? TISSERAND_SINGULAR : 0;
}

/* The initial y, ydot and a. a belongs to a slightly different time than vdot, but shifting it would excite vibrations
   that the step does not resolve. */
static int start(const tisserand_model *model, const tisserand_alpha_options *options, double t, const double *k,
                 double *q, double *v, machine *own)
{
    const int nq = own->nq, nv = own->nv;
    tisserand_fixed_counts ignored = {0, 0, 0, 0};
    int code = tisserand_normalise(model, q);

    if (code == 0 && options->start > 0.0) {
        code = tisserand_project(model, t, k, options->start, q, v, own->work, &ignored);
    }
    if (code == 0) {
        code = tisserand_normalise(model, q);
    }
    if (code == 0) {
        code = model->scene->solve(t, q, v, k, own->a, own->y + nq + nv);
    }
    memcpy(own->y, q, (size_t) nq * sizeof(double));
    memcpy(own->y + nq, v, (size_t) nv * sizeof(double));
    memcpy(own->ydot + nq, own->a, (size_t) nv * sizeof(double));
    return code;
}

/* The predicted state at the end of a step of length h, with constant vdot. */
static void predict(double h, machine *own)
{
    const scheme *s = &own->method;
    double *q = own->y, *v = q + own->nq;
    const double *vdot = own->ydot + own->nq;
    memcpy(own->first, q, (size_t) own->nq * sizeof(double));
    for (int i = 0; i < own->nv; i++) {
        const double before = own->a[i], after = (vdot[i] - s->alpha_m * before) / (1.0 - s->alpha_m);
        const double dq = h * v[i] + h * h * ((0.5 - s->beta) * before + s->beta * after);
        if (own->places.coordinate[i] >= 0) {
            q[own->places.coordinate[i]] += dq;
        } else {
            own->x[i] = dq;
        }
        v[i] += h * ((1.0 - s->gamma) * before + s->gamma * after);
        own->a[i] = after;
    }
    tisserand_rotate(&own->places, own->first, own->x, q);
}

/* Newton's method from the prediction; t is the time at the end of the step. `valid`: whether the present Jacobian can
   be reused. */
static int correct(double t, double h, double tolerance, const double *k, machine *own, int *valid,
                   tisserand_alpha_counts *counts)
{
    const scheme *s = &own->method;
    const int nq = own->nq, nv = own->nv, n = own->form.size;
    const double to_a = s->cj * (1.0 - s->alpha_f) / (1.0 - s->alpha_m);
    double *y = own->y, *ydot = own->ydot, *r = own->r;

    for (int i = 0; i < ITERATIONS * JACOBIANS; i++) {
        double largest = 0.0, size = 0.0;
        int code = 0;
        if (*valid == 0) {
            code = factorise(t, k, own);
            counts->jacobians++;
        }
        if (code == 0) {
            code = own->form.residual(t, y, ydot, k, r);
            counts->residuals++;
        }
        if (code != 0) {
            return code;
        }
        memset(r, 0, (size_t) nq * sizeof(double)); /* q follows from the increments of the step */
        if (!klu_solve(own->symbolic, own->numeric, n, 1, r, &own->common)) {
            return TISSERAND_SINGULAR;
        }
        for (int j = 0; j < nv; j++) {
            const int c = own->places.coordinate[j];
            const double dv = -r[nq + j], dq = c >= 0 ? -s->scale * r[c] : s->scale / s->cj * dv;
            const double moved = fabs(dq) + h * fabs(dv);
            if (c >= 0) {
                y[c] += dq;
                size = fabs(y[c]) <= size ? size : fabs(y[c]);
            } else {
                own->x[j] += dq;
            }
            y[nq + j] += dv;
            ydot[nq + j] += s->cj * dv;
            own->a[j] += to_a * dv;
            largest = moved <= largest ? largest : moved;
            if (!(moved < HUGE_VAL)) {
                return TISSERAND_NOT_FINITE;
            }
        }
        tisserand_rotate(&own->places, own->first, own->x, y);
        for (int j = nq + nv; j < n; j++) {
            y[j] -= r[j];
        }
        *valid = (i + 1) % ITERATIONS; /* a new Jacobian after ITERATIONS iterations */
        if (largest <= tolerance + TISSERAND_ROUNDING * size) {
            return TISSERAND_OK;
        }
    }
    return TISSERAND_NO_CONVERGENCE;
}

static int integrate(double t0, double step, long steps, long every, double tolerance, const double *k, double *rows,
                     const tisserand_observer *observer, long *reached, machine *own, tisserand_alpha_counts *counts)
{
    const int width = own->form.size;
    int valid = 0, code;

    for (long i = 0;; i++) {
        if (i % every == 0) {
            double *row = rows + i / every * width;
            memcpy(row, own->y, (size_t) width * sizeof(double));
            *reached = i / every + 1;
            code = tisserand_observe(observer, t0 + (double) i * step, row);
            if (code != 0) {
                return code;
            }
        }
        if (i == steps) {
            return TISSERAND_OK;
        }
        predict(step, own);
        code = correct(t0 + (double) (i + 1) * step, step, tolerance, k, own, &valid, counts);
        if (code != 0) {
            return code;
        }
        counts->steps++;
    }
}

int tisserand_alpha(const tisserand_model *model, const tisserand_alpha_options *options, double t0, double step,
                    long steps, long every, const double *k, double *q, double *v, double *rows,
                    const tisserand_observer *observer, tisserand_alpha_counts *counts)
{
    const int width = tisserand_fixed_row(model);
    long reached = 0;
    machine own;
    int code;

    if (steps < 0 || every < 1 || !(step > 0.0 && step < HUGE_VAL && fabs(t0) < HUGE_VAL) ||
        !(options->tolerance >= 0.0) || !(options->start >= 0.0) || !(options->proximal >= 0.0) ||
        !(options->rho >= 0.0 && options->rho <= 1.0)) {
        return TISSERAND_ARGUMENT;
    }
    memset(&own, 0, sizeof own);
    own.method = make_scheme(options->rho, step);
    own.nq = model->nq;
    own.nv = model->nv;
    own.proximal = options->proximal;
    code = find_form(model, &own.form);
    if (code == 0) {
        code = allocate(model, &own);
    }
    if (code == 0) {
        code = start(model, options, t0, k, q, v, &own);
    }
    if (code == 0) {
        code = integrate(t0, step, steps, every, options->tolerance, k, rows, observer, &reached, &own, counts);
        memcpy(q, own.y, (size_t) own.nq * sizeof(double));
        memcpy(v, own.y + own.nq, (size_t) own.nv * sizeof(double));
    }
    for (long i = reached * width; i < (steps / every + 1) * width; i++) {
        rows[i] = (double) NAN;
    }
    klu_free_numeric(&own.numeric, &own.common);
    klu_free_symbolic(&own.symbolic, &own.common);
    free(own.colptr);
    free(own.y);
    return code;
}
