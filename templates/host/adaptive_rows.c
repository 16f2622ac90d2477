/* SPDX-License-Identifier: 0BSD -- see adaptive_rows.h. */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER
#ifdef TISSERAND_UNCHECKED
#  error "-ffast-math and -Ofast remove the run-time checks; if that is acceptable, define TISSERAND_ALLOW_FAST_MATH"
#endif

#include "adaptive_rows.h"

#include <math.h>
#include <stddef.h>

enum {
    SAMPLES = 8, /* of a step in which an event is looked at: it may occur and be over within one step */
    BEHIND = 4   /* spacings of the time by which a run ends behind its event, so that one that goes on does not meet it */
};

/* An integration with what it writes; `value` is that of the event in the last state in which it was looked at. */
typedef struct {
    tisserand_adaptive *s;
    const tisserand_adaptive_rows *request;
    tisserand_adaptive_result *result;
    double value;
} writer;

static double *row_at(const writer *w, long number)
{
    return w->request->rows + number * tisserand_fixed_row(w->s->model);
}

/* Write the row of the state in s->trial, which is projected */
static int write_row(writer *w, double t)
{
    tisserand_adaptive *s = w->s;
    const tisserand_model *model = s->model;
    const tisserand_ports *ports = model->ports;
    const int n = model->nq + model->nv;
    double *row = row_at(w, w->result->rows), *vdot = s->work;
    double drift[4];
    int code = 0;

    drift[0] = drift[1] = 0.0;
    if (w->request->drift != NULL) {
        code = tisserand_adaptive_drift(s, t, s->trial, drift);
    }
    if (code == 0) {
        code = tisserand_adaptive_project(s, t, s->trial, drift + 2);
    }
    if (code != 0) {
        return code;
    }
    for (int i = 0; i < n; i++) {
        row[i] = s->trial[i];
    }
    if (model->scene != NULL) {
        code = model->scene->solve(t, row, row + model->nq, s->k, vdot, row + n);
        s->counts.fixed.accelerations++;
    }
    if (code == 0 && ports != NULL && ports->nout > 0 && w->request->outputs != NULL) {
        code = ports->outputs(t, row, row + model->nq, vdot, row + n, s->k,
                              w->request->outputs + w->result->rows * ports->nout);
    }
    if (code != 0) {
        s->refused = code;
        s->refused_t = t;
        return code;
    }
    for (int i = 0; i < 4 && w->request->drift != NULL; i++) {
        w->request->drift[4 * w->result->rows + i] = drift[i];
    }
    w->result->rows++;
    w->result->time = t;
    return tisserand_observe(w->request->observer, t, row);
}

/* Write all rows within the last step that are before `end`, and that at `end` itself if it is included */
static int write_rows(writer *w, double end, int included)
{
    const tisserand_adaptive_rows *request = w->request;
    int code = 0;

    while (code == 0 && w->result->rows < request->count) {
        const double t = request->times[w->result->rows];
        if (!(t < end || (included && t == end))) {
            break;
        }
        code = tisserand_adaptive_state(w->s, t, w->s->trial);
        if (code == 0) {
            code = write_row(w, t);
        }
    }
    return code;
}

/* The value of the event at a time within the last step */
static int evaluate(writer *w, double t, double *value)
{
    tisserand_adaptive *s = w->s;
    const tisserand_event *event = w->request->event;
    double drift[2];
    int code = tisserand_adaptive_state(s, t, s->trial);

    if (code == 0) {
        code = tisserand_adaptive_project(s, t, s->trial, drift);
    }
    if (code == 0) {
        *value = event->value(event->data, t, s->trial, s->trial + s->model->nq);
        code = fabs(*value) < HUGE_VAL ? TISSERAND_OK : TISSERAND_NOT_FINITE;
    }
    return code;
}

static int met(const tisserand_event *event, double before, double after)
{
    if (event->crossing) {
        return (before < 0.0 && after >= 0.0) || (before > 0.0 && after <= 0.0);
    }
    return before <= 0.0 && after > 0.0;
}

/* Find the first of the times after `first` up to `last` at which the event occurs, by bisection */
static int locate(writer *w, double first, double last, double before, double *stop)
{
    const tisserand_event *event = w->request->event;
    const double end = last, size = fabs(last) > last - first ? fabs(last) : last - first;
    double step = nextafter(size, HUGE_VAL) - size, value = 0.0;
    int code;

    while (last - first > step) {
        const double middle = first + 0.5 * (last - first);
        code = evaluate(w, middle, &value);
        if (code != 0) {
            return code;
        }
        if (met(event, before, value)) {
            last = middle;
        } else {
            first = middle;
        }
    }
    for (step *= BEHIND;; step *= 2.0) {
        last = last + step < end ? last + step : end;
        code = last < end ? evaluate(w, last, &value) : TISSERAND_OK;
        if (code != 0 || last == end || met(event, before, value)) {
            *stop = last;
            return code;
        }
    }
}

/* Look for the event in the last step */
static int look_for_event(writer *w, double *stop)
{
    const double first = w->s->last, length = w->s->t - first;
    double at = first;

    for (int i = 1; i <= SAMPLES; i++) {
        const double t = i < SAMPLES ? first + length * (double) i / (double) SAMPLES : w->s->t;
        double value;
        const int code = evaluate(w, t, &value);
        if (code != 0) {
            return code;
        }
        if (met(w->request->event, w->value, value)) {
            w->result->met = 1;
            return locate(w, at, t, w->value, stop);
        }
        w->value = value;
        at = t;
    }
    return TISSERAND_OK;
}

/* Take steps from one break, or from the begin, to another one, or to the end */
static int integrate_to(writer *w, double end, int is_break)
{
    tisserand_adaptive *s = w->s;
    int code = 0;

    while (code == 0 && s->t < end) {
        double stop = s->t;
        code = tisserand_adaptive_step(s, end, is_break);
        if (code == 0 && w->request->event != NULL) {
            code = look_for_event(w, &stop);
        }
        if (code == 0) {
            code = write_rows(w, w->result->met ? stop : s->t, !w->result->met);
        }
        if (code == 0 && w->result->met) {
            if (stop > w->result->time) {
                code = tisserand_adaptive_state(s, stop, s->trial);
                code = code != 0 ? code : write_row(w, stop);
            }
            if (code == 0) {
                code = tisserand_observe(w->request->steps, w->result->time, row_at(w, w->result->rows - 1));
            }
            return code;
        }
        if (code == 0) {
            code = tisserand_observe(w->request->steps, s->t, s->y);
        }
    }
    return code;
}

static int integrate(writer *w)
{
    tisserand_adaptive *s = w->s;
    const tisserand_adaptive_rows *request = w->request;
    const double end = request->times[request->count - 1];
    int code = tisserand_adaptive_state(s, s->t, s->trial);

    if (code == 0) {
        code = write_row(w, s->t);
    }
    if (code == 0) {
        code = tisserand_observe(request->steps, s->t, s->trial);
    }
    if (code == 0 && request->event != NULL) {
        code = evaluate(w, s->t, &w->value);
    }
    for (int i = 0; i <= request->nbreaks && code == 0 && !w->result->met && s->t < end; i++) {
        const int is_break = i < request->nbreaks && request->breaks[i] < end;
        const double stop = is_break ? request->breaks[i] : end;
        if (!(stop > s->t)) {
            continue;
        }
        if (s->counts.fixed.steps > 0) {
            code = tisserand_adaptive_restart(s, stop);
        }
        if (code == 0) {
            code = integrate_to(w, stop, is_break);
        }
    }
    return code;
}

int tisserand_adaptive_integrate(tisserand_adaptive *s, const tisserand_model *model,
                                 const tisserand_adaptive_options *options, const tisserand_adaptive_rows *request,
                                 const double *k, const double *q, const double *v, double *work,
                                 tisserand_adaptive_result *result)
{
    const int width = tisserand_fixed_row(model);
    const long space = request->count + (request->event != NULL);
    writer w = {s, request, result, 0.0};
    int code;

    result->rows = 0;
    result->met = 0;
    result->time = request->count > 0 ? request->times[0] : 0.0;
    for (long i = 1; i < request->count; i++) {
        if (!(request->times[i] > request->times[i - 1])) {
            return TISSERAND_ARGUMENT;
        }
    }
    if (request->count < 1) {
        return TISSERAND_ARGUMENT;
    }
    code = tisserand_adaptive_start(s, model, options, request->times[0], request->times[request->count - 1], k, q, v,
                                    work);
    if (code == 0) {
        code = integrate(&w);
    }
    for (long i = result->rows * width; code != 0 && i < space * width; i++) {
        request->rows[i] = (double) NAN;
    }
    return code;
}
