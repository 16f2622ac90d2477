/* SPDX-License-Identifier: 0BSD -- see fixed_step.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "fixed_step.h"

#include <math.h>
#include <stddef.h>

/* Each iteration of Newton's method squares the error, which is of order h^5 after a step. */
enum { ITERATIONS = 10 };

int tisserand_fixed_work(const tisserand_model *model)
{
    return 3 * (model->nq + model->nv) + model->nlambda;
}

int tisserand_fixed_row(const tisserand_model *model)
{
    return model->nq + model->nv + model->nlambda;
}

static void copy(int n, const double *from, double *to)
{
    for (int i = 0; i < n; i++) {
        to[i] = from[i];
    }
}

/* to += factor * from */
static void add(int n, double factor, const double *from, double *to)
{
    for (int i = 0; i < n; i++) {
        to[i] += factor * from[i];
    }
}

/* Whether no element of r exceeds the tolerance (a NaN does); r becomes -r, the required correction. */
static int within(int n, double tolerance, double *r)
{
    int all = 1;
    for (int i = 0; i < n; i++) {
        if (!(fabs(r[i]) <= tolerance)) {
            all = 0;
        }
        r[i] = -r[i];
    }
    return all;
}

int tisserand_normalise(const tisserand_model *model, double *q)
{
    double *e[4], square = 0.0;

    for (int i = 0, index = 0, n = 0; i < model->variables_q; index += model->q[i].size, i++) {
        if (model->q[i].role != TISSERAND_ROLE_QUATERNION) {
            continue;
        }
        e[n++] = q + index;
        square += q[index] * q[index];
        if (n == 4) {
            const double length = sqrt(square);
            if (!(length > 0.0 && length < HUGE_VAL)) {
                return TISSERAND_NOT_FINITE;
            }
            for (n = 4; n > 0; n--) {
                *e[n - 1] /= length;
            }
            square = 0.0;
        }
    }
    return TISSERAND_OK;
}

int tisserand_project(const tisserand_model *model, double t, const double *k, double tolerance, double *q, double *v,
                      double *work, tisserand_fixed_counts *counts)
{
    const tisserand_scene *scene = model->scene;
    double *r = work, *dv = r + model->nlambda, *dq = dv + model->nv;
    int code;

    if (!(tolerance >= 0.0)) {
        return TISSERAND_ARGUMENT;
    }
    if (scene == NULL) {
        return TISSERAND_OK;
    }
    for (int i = 0;; i++) {
        code = scene->constraints(t, q, k, r);
        counts->constraints++;
        if (code != 0) {
            return code;
        }
        if (within(model->nlambda, tolerance, r)) {
            break;
        }
        if (i == ITERATIONS) {
            return TISSERAND_OFF;
        }
        code = scene->project_velocity(t, q, k, r, dv);
        counts->corrections++;
        if (code == 0) {
            code = model->rates(q, dv, k, dq);
        }
        if (code != 0) {
            return code;
        }
        add(model->nq, 1.0, dq, q);
    }
    code = scene->constraint_rates(t, q, v, k, r);
    counts->constraints++;
    /* gdot is linear in v, so that one correction is sufficient. */
    if (code == 0 && !within(model->nlambda, tolerance, r)) {
        code = scene->project_velocity(t, q, k, r, dv);
        counts->corrections++;
        if (code == 0) {
            add(model->nv, 1.0, dv, v);
        }
    }
    return code;
}

int tisserand_rk4_step(const tisserand_model *model, double t, double step, const double *k, double *q, double *v,
                       double *work, tisserand_fixed_counts *counts)
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const int nq = model->nq, nv = model->nv;
    double *qs = work, *vs = qs + nq, *qdot = vs + nv, *vdot = qdot + nq, *dq = vdot + nv, *dv = dq + nq;

    if (!(fabs(step) < HUGE_VAL && fabs(t) < HUGE_VAL)) {
        return TISSERAND_ARGUMENT;
    }
    for (int i = 0; i < nq + nv; i++) {
        dq[i] = 0.0; /* and dv, which follows */
    }
    for (int s = 0; s < 4; s++) {
        int code;
        copy(nq, q, qs);
        copy(nv, v, vs);
        if (s > 0) {
            add(nq, at[s] * step, qdot, qs);
            add(nv, at[s] * step, vdot, vs);
        }
        code = model->rates(qs, vs, k, qdot);
        if (code == 0) {
            code = model->accel(t + at[s] * step, qs, vs, k, vdot);
            counts->accelerations++;
        }
        if (code != 0) {
            return code;
        }
        add(nq, weight[s], qdot, dq);
        add(nv, weight[s], vdot, dv);
    }
    add(nq, step, dq, q);
    add(nv, step, dv, v);
    counts->steps++;
    return tisserand_normalise(model, q);
}

int tisserand_fixed_result(const tisserand_model *model, double t, const double *k, const double *q, const double *v,
                           double *row, double *work, tisserand_fixed_counts *counts)
{
    copy(model->nq, q, row);
    copy(model->nv, v, row + model->nq);
    if (model->scene == NULL) {
        return TISSERAND_OK;
    }
    counts->accelerations++;
    return model->scene->solve(t, q, v, k, work, row + model->nq + model->nv);
}

int tisserand_observe(const tisserand_observer *observer, double t, const double *row)
{
    return observer != NULL && observer->call(observer->data, t, row) != 0 ? TISSERAND_STOPPED : TISSERAND_OK;
}

/* Whether the arguments of an integration make sense; comparisons with a NaN are false. */
static int sensible(double t0, double step, long steps, long every, double tolerance)
{
    return steps >= 0 && every >= 1 && tolerance >= 0.0 && fabs(step) < HUGE_VAL && fabs(t0) < HUGE_VAL;
}

int tisserand_rk4(const tisserand_model *model, double t0, double step, long steps, long every, const double *k,
                  double tolerance, double *q, double *v, double *rows, const tisserand_observer *observer, double *work,
                  tisserand_fixed_counts *counts)
{
    const int width = tisserand_fixed_row(model);
    int code = TISSERAND_OK;
    long i;

    if (!sensible(t0, step, steps, every, tolerance)) {
        return TISSERAND_ARGUMENT;
    }
    code = tisserand_normalise(model, q);
    for (i = 0;; i++) {
        const double t = t0 + (double) i * step; /* not a running sum, whose rounding errors would grow */
        if (code == 0 && tolerance > 0.0) {
            code = tisserand_project(model, t, k, tolerance, q, v, work, counts);
        }
        if (code == 0 && rows != NULL && i % every == 0) {
            double *row = rows + i / every * width;
            code = tisserand_fixed_result(model, t, k, q, v, row, work, counts);
            if (code == 0 && tisserand_observe(observer, t, row) != 0) {
                code = TISSERAND_STOPPED;
                i++; /* this row is good */
            }
        }
        if (code != 0 || i == steps) {
            break;
        }
        code = tisserand_rk4_step(model, t, step, k, q, v, work, counts);
        if (code != 0) {
            i++; /* the state after the step has failed */
            break;
        }
    }
    if (code != 0 && rows != NULL) {
        for (long j = (i + every - 1) / every * width; j < (steps / every + 1) * width; j++) {
            rows[j] = (double) NAN;
        }
    }
    return code;
}

int tisserand_rk4_batch(const tisserand_model *model, int n, double t0, double step, long steps, long every,
                        const double *k, double tolerance, double *q, double *v, double *rows, int *codes,
                        double *work, tisserand_fixed_counts *counts)
{
    int first = TISSERAND_OK;

    if (!sensible(t0, step, steps, every, tolerance)) {
        return TISSERAND_ARGUMENT;
    }
    for (int b = 0; b < n; b++) {
        double *own = rows == NULL ? NULL : rows + b * (steps / every + 1) * tisserand_fixed_row(model);
        codes[b] = tisserand_rk4(model, t0, step, steps, every, k, tolerance, q + (long) b * model->nq,
                                 v + (long) b * model->nv, own, NULL, work, counts);
        if (first == 0) {
            first = codes[b];
        }
    }
    return first;
}
