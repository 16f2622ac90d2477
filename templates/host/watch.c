/* SPDX-License-Identifier: 0BSD -- see watch.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "watch.h"

#include <math.h>
#include <stddef.h>

/* Write z = q, v, outputs, t - begin at the begin of w->work. Returns the code of the model. */
static int evaluate(const tisserand_watch *w, double t, const double *y)
{
    const tisserand_model *model = w->model;
    const tisserand_ports *ports = model->ports;
    const int n = model->nq + model->nv;
    const int nout = ports != NULL ? ports->nout : 0;
    double *z = w->work, *vdot = z + n + nout + 1;
    int code = 0;

    for (int i = 0; i < n; i++) {
        z[i] = y[i];
    }
    z[n + nout] = w->states > 0 ? t - w->begin : 0.0;
    if (nout > 0) {
        code = model->scene->solve(t, y, y + model->nq, w->k, vdot, vdot + model->nv);
        if (code == 0) {
            code = ports->outputs(t, y, y + model->nq, vdot, vdot + model->nv, w->k, z + n);
        }
    }
    return code;
}

/* Of the forms of a quantity that with the largest absolute value */
static double value_of(const tisserand_watch *w, int quantity)
{
    double largest = 0.0;

    for (int form = w->forms[quantity]; form < w->forms[quantity + 1]; form++) {
        double f = 0.0;
        for (int term = w->terms[form]; term < w->terms[form + 1]; term++) {
            f += w->factors[term] * w->work[w->columns[term]];
        }
        largest = fabs(f) > fabs(largest) ? f : largest;
    }
    return largest;
}

int tisserand_watch_state(void *watch, double t, const double *y)
{
    tisserand_watch *w = (tisserand_watch *) watch;
    const int nq = w->model->nq;
    const double half = w->states > 0 ? 0.5 * (t - w->last[w->count]) : 0.0;

    if (evaluate(w, t, y) != 0) {
        return 0;
    }
    if (w->states == 0) {
        w->begin = t;
    }
    for (int i = 0; i < w->count; i++) {
        const int multiplier = w->multipliers[i];
        /* that of this state: earlier quantities are in w->last already */
        const double value = value_of(w, i) * (multiplier < 0 ? 1.0 : w->last[multiplier]);

        if (w->states == 0) {
            w->integrals[i] = 0.0;
            w->squares[i] = 0.0;
        } else {
            w->integrals[i] += half * (w->last[i] + value);
            w->squares[i] += half * (w->last[i] * w->last[i] + value * value);
        }
        if (w->states == 0 || fabs(value) > w->largest[i]) {
            w->largest[i] = fabs(value);
            w->times[i] = t;
            for (int j = 0; j < nq; j++) {
                w->at[i * nq + j] = y[j];
            }
        }
        w->last[i] = value;
    }
    w->last[w->count] = t;
    w->states++;
    return 0;
}
