/* SPDX-License-Identifier: 0BSD -- see adaptive.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "adaptive.h"
#include "dormand_prince.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* The control of steps of SciPy: a step is tried at SAFETY times the length for which the error estimate is 1. */
static const double SAFETY = 0.9, SHORTEN = 0.2, LENGTHEN = 10.0;

/* Of the largest coordinate or velocity: constraints are differences of positions, which are rounded. */
static const double ROUNDING = 2e-15;

int tisserand_adaptive_work(const tisserand_model *model)
{
    const int n = model->nq + model->nv;
    return (TISSERAND_STAGES + TISSERAND_DEGREE + 5) * n + tisserand_fixed_work(model);
}

static void copy(int n, const double *from, double *to)
{
    for (int i = 0; i < n; i++) {
        to[i] = from[i];
    }
}

/* The largest absolute value; infinite if a value is not finite. */
static double largest(int n, const double *x)
{
    double result = 0.0;
    for (int i = 0; i < n; i++) {
        if (!(fabs(x[i]) <= result)) {
            result = fabs(x[i]) < HUGE_VAL ? fabs(x[i]) : HUGE_VAL;
        }
    }
    return result;
}

/* x^(-1/8), the exponent with which the estimate of order 7 becomes a factor of the step */
static double eighth_root_of_inverse(double x)
{
    return 1.0 / sqrt(sqrt(sqrt(x)));
}

/* Return a code, and remember it unless it is 0 */
static int remembered(tisserand_adaptive *s, double t, int code)
{
    if (code != 0) {
        s->refused = code;
        s->refused_t = t;
    }
    return code;
}

/* f = [qdot; vdot] */
static int derivatives(void *data, double t, const double *y, double *f)
{
    tisserand_adaptive *s = (tisserand_adaptive *) data;
    const tisserand_model *model = s->model;
    const double *v = y + model->nq;
    int code = model->rates(y, v, s->k, f);

    if (code == 0) {
        code = model->accel(t < s->limit ? t : s->limit, y, v, s->k, f + model->nq);
        s->counts.fixed.accelerations++;
    }
    return remembered(s, t, code);
}

/* The equations of the model for dormand_prince.c */
static tisserand_equations equations(tisserand_adaptive *s)
{
    tisserand_equations result;
    result.f = derivatives;
    result.data = s;
    result.n = s->model->nq + s->model->nv;
    return result;
}

/* The root mean square of the elements of x - minus, relative to the tolerances of the state; minus may be 0 */
static double weighted_norm(const tisserand_adaptive *s, const double *x, const double *minus)
{
    const int n = s->model->nq + s->model->nv;
    double sum = 0.0;

    for (int i = 0; i < n; i++) {
        const double scale = s->options.atol[i] + s->options.rtol * fabs(s->y[i]);
        const double e = (x[i] - (minus == NULL ? 0.0 : minus[i])) / scale;
        sum += e * e;
    }
    return sqrt(sum / (double) n);
}

static double least(double x, double y)
{
    return x < y ? x : y;
}

/* The length of the first step: Hairer, Norsett & Wanner, section II.4 */
static double first_step(tisserand_adaptive *s, double end)
{
    const int n = s->model->nq + s->model->nv;
    const double interval = end - s->t, d0 = weighted_norm(s, s->y, NULL), d1 = weighted_norm(s, s->f, NULL);
    const double h0 = least(d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1, interval);
    double d2 = 0.0, h1;

    for (int i = 0; i < n; i++) {
        s->trial[i] = s->y[i] + h0 * s->f[i];
    }
    /* Where the model refuses this state, the error of the first step decides. */
    if (h0 > 0.0 && derivatives(s, s->t + h0, s->trial, s->stages) == 0) {
        d2 = weighted_norm(s, s->stages, s->f) / h0;
    }
    if (d1 <= 1e-15 && d2 <= 1e-15) {
        h1 = 1e-3 * h0 > 1e-6 ? 1e-3 * h0 : 1e-6;
    } else {
        h1 = eighth_root_of_inverse(100.0 * (d1 > d2 ? d1 : d2));
    }
    s->refused = 0;
    return least(least(100.0 * h0, h1), interval);
}

int tisserand_adaptive_restart(tisserand_adaptive *s, double end)
{
    int code;

    s->limit = HUGE_VAL;
    s->last = s->t;
    s->within = TISSERAND_NOT_YET;
    code = derivatives(s, s->t, s->y, s->f);
    if (code == 0) {
        s->step = first_step(s, end);
    }
    return code;
}

int tisserand_adaptive_start(tisserand_adaptive *s, const tisserand_model *model,
                             const tisserand_adaptive_options *options, double t, double end, const double *k,
                             const double *q, const double *v, double *work)
{
    const int n = model->nq + model->nv;
    const tisserand_fixed_counts none = {0, 0, 0, 0};
    double drift[2];
    int code;

    if (!(fabs(t) < HUGE_VAL && end >= t && end < HUGE_VAL && options->rtol >= 0.0 && options->consistent >= 0.0
          && options->drift >= 0.0 && options->step_max >= 0.0 && options->steps_max >= 0)) {
        return TISSERAND_ARGUMENT;
    }
    for (int i = 0; i < n; i++) {
        if (!(options->atol[i] > 0.0)) {
            return TISSERAND_ARGUMENT;
        }
    }
    s->model = model;
    s->k = k;
    s->options = *options;
    if (s->options.rtol < 100.0 * DBL_EPSILON) {
        s->options.rtol = 100.0 * DBL_EPSILON;
    }
    s->t = t;
    s->y = work;
    s->f = s->y + n;
    s->begin = s->f + n;
    s->end = s->begin + n;
    s->trial = s->end + n;
    s->interpolant = s->trial + n;
    s->stages = s->interpolant + TISSERAND_DEGREE * n;
    s->work = s->stages + TISSERAND_STAGES * n;
    s->counts.fixed = none;
    s->counts.rejected = 0;
    s->refused = 0;
    s->refused_t = t;
    copy(model->nq, q, s->y);
    copy(model->nv, v, s->y + model->nq);
    copy(n, s->y, s->trial);
    code = tisserand_adaptive_project(s, t, s->trial, drift);
    if (code != 0) {
        return code;
    }
    copy(n, s->trial, s->y);
    return tisserand_adaptive_restart(s, end);
}

/* Project the end of a step, which is at t, and make it the state */
static int accept(tisserand_adaptive *s, double t)
{
    const int n = s->model->nq + s->model->nv;
    double *f = s->stages + (TISSERAND_STAGES - 1) * n; /* unused in a step; s->f remains for a shorter one */
    double drift[2];
    int code;

    copy(n, s->end, s->trial);
    code = tisserand_adaptive_project(s, t, s->trial, drift);
    if (code == 0) {
        code = derivatives(s, t, s->trial, f);
    }
    if (code != 0) {
        return code;
    }
    copy(n, f, s->f);
    copy(n, s->y, s->begin);
    copy(n, s->trial, s->y);
    s->last = s->t;
    s->t = t;
    s->within = TISSERAND_NOT_YET;
    s->refused = 0;
    s->counts.fixed.steps++;
    return TISSERAND_OK;
}

/* Try a step to t, and take it if its error is below 1 */
static int attempt(tisserand_adaptive *s, double t, double *error)
{
    const tisserand_equations system = equations(s);
    const double h = t - s->t;
    int code;

    *error = HUGE_VAL;
    code = tisserand_stages(&system, s->t, h, s->y, s->stages, s->trial, s->end);
    if (code != 0) {
        return code;
    }
    *error = tisserand_step_error(system.n, h, s->y, s->end, s->stages, s->options.rtol, s->options.atol);
    return *error < 1.0 ? accept(s, t) : TISSERAND_STEP_TOO_SHORT;
}

int tisserand_adaptive_step(tisserand_adaptive *s, double end, int before_break)
{
    const double shortest = 10.0 * (nextafter(s->t, HUGE_VAL) - s->t), most = s->options.step_max;
    double h = most > 0.0 && s->step > most ? most : s->step;
    int code = TISSERAND_STEP_TOO_SHORT, repeated = 0;

    if (!(end > s->t)) {
        return TISSERAND_ARGUMENT;
    }
    if (s->options.steps_max > 0 && s->counts.fixed.steps >= s->options.steps_max) {
        return TISSERAND_TOO_MANY_STEPS;
    }
    s->limit = before_break ? nextafter(end, s->t) : HUGE_VAL;
    copy(s->model->nq + s->model->nv, s->f, s->stages);
    h = h < shortest ? shortest : h;
    while (h >= shortest) {
        const double t = least(s->t + h, end);
        double error, factor = SHORTEN;
        h = t - s->t;
        code = attempt(s, t, &error);
        if (error > 0.0 && error < HUGE_VAL && (code == 0 || error >= 1.0)) {
            factor = SAFETY * eighth_root_of_inverse(error);
        }
        if (code == 0) {
            factor = error > 0.0 ? least(factor, LENGTHEN) : LENGTHEN;
            s->step = h * (repeated ? least(factor, 1.0) : factor);
            return TISSERAND_OK;
        }
        s->counts.rejected++;
        repeated = 1;
        h *= factor > SHORTEN ? factor : SHORTEN;
    }
    return code;
}

int tisserand_adaptive_state(tisserand_adaptive *s, double t, double *y)
{
    const tisserand_equations system = equations(s);

    if (!(t >= s->last && t <= s->t)) {
        return TISSERAND_ARGUMENT;
    }
    if (t == s->t) {
        copy(system.n, s->last < s->t ? s->end : s->y, y);
        return TISSERAND_OK;
    }
    if (s->within == TISSERAND_NOT_YET) {
        const int code = tisserand_interpolant(&system, s->last, s->t - s->last, s->begin, s->end, s->stages, s->trial,
                                               s->interpolant);
        if (code != 0) {
            return code;
        }
        s->within = tisserand_interpolant_error(system.n, s->begin, s->end, s->interpolant, s->options.rtol,
                                                s->options.atol) < 1.0
                        ? TISSERAND_INTERPOLATES
                        : TISSERAND_OWN_STEPS;
    }
    if (s->within == TISSERAND_OWN_STEPS) {
        return tisserand_stages(&system, s->last, t - s->last, s->begin, s->stages, s->trial, y);
    }
    tisserand_interpolate(system.n, (t - s->last) / (s->t - s->last), s->begin, s->interpolant, y);
    return TISSERAND_OK;
}

int tisserand_adaptive_drift(tisserand_adaptive *s, double t, const double *y, double drift[2])
{
    const tisserand_model *model = s->model;
    int code;

    drift[0] = drift[1] = 0.0;
    if (model->scene == NULL) {
        return TISSERAND_OK;
    }
    code = model->scene->constraints(t, y, s->k, s->work);
    if (code == 0) {
        drift[0] = largest(model->nlambda, s->work);
        code = model->scene->constraint_rates(t, y, y + model->nq, s->k, s->work);
        drift[1] = largest(model->nlambda, s->work);
    }
    s->counts.fixed.constraints += 2;
    return remembered(s, t, code);
}

int tisserand_adaptive_project(tisserand_adaptive *s, double t, double *y, double drift[2])
{
    const tisserand_model *model = s->model;
    const double limit = s->options.drift, rounding = ROUNDING * largest(model->nq, y);
    double *v = y + model->nq, met = s->options.consistent;
    int code = tisserand_normalise(model, y);

    if (code == 0 && met > 0.0) {
        met = met > rounding ? met : rounding;
        code = tisserand_project(model, t, s->k, met, y, v, s->work, &s->counts.fixed);
        if (code == TISSERAND_OFF && limit > met) { /* rounding errors of long arms are larger */
            code = tisserand_project(model, t, s->k, limit, y, v, s->work, &s->counts.fixed);
        }
    }
    if (code == 0) {
        code = tisserand_adaptive_drift(s, t, y, drift);
    }
    if (code == 0 && limit > 0.0
        && !(drift[0] <= limit + rounding && drift[1] <= limit + ROUNDING * largest(model->nv, v))) {
        code = TISSERAND_OFF;
    }
    return remembered(s, t, code);
}
