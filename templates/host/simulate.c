/*
 * SPDX-License-Identifier: 0BSD
 *
 * A program that integrates a model and writes t, q, v, lambda at equidistant times, for example
 *
 *     cc -std=c99 -O2 -DTISSERAND_HEADER='"my_scene.h"' -DTISSERAND_MODEL=my_scene_model simulate.c adaptive_rows.c \
 *        adaptive.c dormand_prince.c fixed_step.c my_scene.c -lm -o my_scene
 *     ./my_scene adaptive start.txt 0.1 1e-4 1e-9 out.csv
 *
 * With -DTISSERAND_IDA, ida.c and the libraries of ida.h it also has the methods "ggl" and "index1", and "ode" for a
 * model without joints; with -DTISSERAND_ALPHA, generalised_alpha.c and the library of its header also "alpha". It
 * writes statistics to the standard error output, as lines `name value`.
 */

#ifndef TISSERAND_HEADER
#  error "define TISSERAND_HEADER as the name of the header of a generated model, in quotes"
#endif
#include TISSERAND_HEADER

#include "adaptive_rows.h"
#include "fixed_step.h"
#ifdef TISSERAND_IDA
#  include "ida.h"
#endif
#ifdef TISSERAND_ALPHA
#  include "generalised_alpha.h"
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char USAGE[] =
    "usage: %s METHOD START END INTERVAL ACCURACY OUTPUT\n"
    "METHOD    adaptive, rk4"
#ifdef TISSERAND_IDA
    ", ggl, index1, ode"
#endif
#ifdef TISSERAND_ALPHA
    ", alpha"
#endif
    "\n"
    "START     file with the numbers of q and v at t = 0, or - for the values in the model's tables\n"
    "END       time of the last row of OUTPUT (s)\n"
    "INTERVAL  time between rows (s)\n"
    "ACCURACY  of rk4 and alpha the step (s), which is shortened to fit into INTERVAL; else the tolerance\n"
    "OUTPUT    .csv: text with a line of names; else the same columns as binary doubles; - for none\n";

/* The tolerance of constraints and their rates (m, rad) in the initial state and in rk4. */
static const double CONSISTENT = 1e-12;

/* The default values of a table; each element of an array has the value of the array. */
static void defaults(const tisserand_variable *table, int entries, double *values)
{
    for (int i = 0; i < entries; i++) {
        for (int j = 0; j < table[i].size; j++) {
            *values++ = table[i].value;
        }
    }
}

static int read_start(const tisserand_model *model, const char *path, double *q, double *v)
{
    FILE *file;
    int count = 0;

    defaults(model->q, model->variables_q, q);
    defaults(model->v, model->variables_v, v);
    if (strcmp(path, "-") == 0) {
        return 0;
    }
    file = fopen(path, "r");
    if (file == NULL) {
        perror(path);
        return 1;
    }
    for (int i = 0; i < model->nq + model->nv; i++) {
        count += fscanf(file, "%lf", i < model->nq ? &q[i] : &v[i - model->nq]) == 1;
    }
    fclose(file);
    if (count != model->nq + model->nv) {
        fprintf(stderr, "%s: %d numbers are needed: q, then v\n", path, model->nq + model->nv);
    }
    return count != model->nq + model->nv;
}

/* The names of the columns; elements of arrays are numbered from 1. */
static void print_names(FILE *file, const tisserand_variable *table, int entries)
{
    for (int i = 0; i < entries; i++) {
        for (int j = 1; j <= table[i].size; j++) {
            if (table[i].size == 1) {
                fprintf(file, ",%s", table[i].name);
            } else {
                fprintf(file, ",%s%d", table[i].name, j);
            }
        }
    }
}

static int write_rows(const tisserand_model *model, const char *path, long nrows, double interval, const double *rows)
{
    const int width = tisserand_fixed_row(model);
    const size_t length = strlen(path);
    const int text = length > 4 && strcmp(path + length - 4, ".csv") == 0;
    FILE *file;
    int failed;

    if (strcmp(path, "-") == 0) {
        return 0;
    }
    file = fopen(path, text ? "w" : "wb");
    if (file == NULL) {
        perror(path);
        return 1;
    }
    if (text) {
        fprintf(file, "t");
        print_names(file, model->q, model->variables_q);
        print_names(file, model->v, model->variables_v);
        if (model->scene != NULL) {
            print_names(file, model->scene->lambda, model->nlambda);
        }
        fprintf(file, "\n");
    }
    for (long i = 0; i < nrows; i++) {
        const double t = (double) i * interval;
        if (text) {
            fprintf(file, "%.17g", t);
            for (int j = 0; j < width; j++) {
                fprintf(file, ",%.17g", rows[i * width + j]);
            }
            fprintf(file, "\n");
        } else {
            fwrite(&t, sizeof t, 1, file);
            fwrite(rows + i * width, sizeof *rows, (size_t) width, file);
        }
    }
    failed = ferror(file);
    if (fclose(file) != 0 || failed) {
        perror(path);
        return 1;
    }
    return 0;
}

/* The number of steps between two rows. */
static long steps_between(double interval, double step)
{
    return (long) ceil(interval / step * (1.0 - 1e-12));
}

static int run_rk4(const tisserand_model *model, double interval, double accuracy, long nrows, const double *k,
                   double *q, double *v, double *rows, double *work)
{
    tisserand_fixed_counts counts = {0, 0, 0, 0};
    const long every = steps_between(interval, accuracy);
    const int code = tisserand_rk4(model, 0.0, interval / (double) every, (nrows - 1) * every, every, k, CONSISTENT,
                                   q, v, rows, NULL, work, &counts);
    fprintf(stderr, "steps %ld\naccelerations %ld\nconstraints %ld\ncorrections %ld\n", counts.steps,
            counts.accelerations, counts.constraints, counts.corrections);
    return code;
}

static int run_adaptive(const tisserand_model *model, double interval, double accuracy, long nrows, const double *k,
                        const double *q, const double *v, double *rows)
{
    const size_t n = (size_t) (model->nq + model->nv), work = (size_t) tisserand_adaptive_work(model);
    double *memory = (double *) calloc(n + work + (size_t) nrows, sizeof(double)), *times = memory + n + work;
    tisserand_adaptive_options options = {accuracy, memory, CONSISTENT, 0.0, 0.0, 0};
    tisserand_adaptive_rows request = {nrows, times, 0, NULL, NULL, NULL, NULL, rows, NULL, NULL};
    tisserand_adaptive_result result;
    tisserand_adaptive s;
    int code;

    if (memory == NULL) {
        return TISSERAND_ARGUMENT;
    }
    for (size_t i = 0; i < n; i++) {
        memory[i] = accuracy;
    }
    for (long i = 0; i < nrows; i++) {
        times[i] = (double) i * interval;
    }
    code = tisserand_adaptive_integrate(&s, model, &options, &request, k, q, v, memory + n, &result);
    fprintf(stderr, "steps %ld\nrejected %ld\naccelerations %ld\n", s.counts.fixed.steps, s.counts.rejected,
            s.counts.fixed.accelerations);
    free(memory);
    return code;
}

#ifdef TISSERAND_ALPHA
static int run_alpha(const tisserand_model *model, double interval, double accuracy, long nrows, const double *k,
                     double *q, double *v, double *rows)
{
    tisserand_alpha_counts counts = {0, 0, 0};
    tisserand_alpha_options options = {0.8, 1e-11, 0.0, 0.0};
    const long every = steps_between(interval, accuracy);
    int code;

    options.start = CONSISTENT;
    code = tisserand_alpha(model, &options, 0.0, interval / (double) every, (nrows - 1) * every, every, k, q, v, rows,
                           NULL, &counts);
    fprintf(stderr, "steps %ld\nresiduals %ld\njacobians %ld\n", counts.steps, counts.residuals, counts.jacobians);
    return code;
}
#endif

#ifdef TISSERAND_IDA
static int run_ida(const tisserand_model *model, const char *form, double interval, double accuracy, long nrows,
                   const double *k, double *q, double *v, double *rows)
{
    tisserand_ida_counts counts = {0, 0, 0, 0, 0, 0, 0};
    tisserand_ida_options options = {0, 0.0, 0.0, 0, 0, 0.0, 0.0, 0, 0.0};
    int code;

    options.form = strcmp(form, "ode") == 0 ? NULL : form;
    options.rtol = accuracy;
    options.atol = accuracy;
    options.start = CONSISTENT;
    options.steps_max = 1000000; /* more steps between two rows indicate a fault */
    code = tisserand_ida(model, &options, 0.0, interval, nrows, k, q, v, rows, NULL, &counts);
    fprintf(stderr,
            "steps %ld\nresiduals %ld\njacobians %ld\nfactorisations %ld\niterations %ld\nerror_failures %ld\n"
            "convergence_failures %ld\n",
            counts.steps, counts.residuals, counts.jacobians, counts.factorisations, counts.iterations,
            counts.error_failures, counts.convergence_failures);
    return code;
}
#endif

static int integrate(const tisserand_model *model, const char *method, double interval, double accuracy, long nrows,
                     const double *k, double *q, double *v, double *rows, double *work)
{
    if (!(interval / accuracy < 1e9)) {
        return TISSERAND_ARGUMENT;
    }
    if (strcmp(method, "adaptive") == 0) {
        return run_adaptive(model, interval, accuracy, nrows, k, q, v, rows);
    }
    if (strcmp(method, "rk4") == 0) {
        return run_rk4(model, interval, accuracy, nrows, k, q, v, rows, work);
    }
#ifdef TISSERAND_ALPHA
    if (strcmp(method, "alpha") == 0) {
        return run_alpha(model, interval, accuracy, nrows, k, q, v, rows);
    }
#endif
#ifdef TISSERAND_IDA
    return run_ida(model, method, interval, accuracy, nrows, k, q, v, rows);
#else
    return TISSERAND_ARGUMENT;
#endif
}

static int run(const tisserand_model *model, char **given, double *memory, long nrows, double interval)
{
    double *p = memory, *k = p + model->np, *q = k + model->nk, *v = q + model->nq, *work = v + model->nv;
    double *rows = work + tisserand_fixed_work(model);
    const double accuracy = strtod(given[5], NULL);
    clock_t before;
    int code;

    if (read_start(model, given[2], q, v) != 0) {
        return 1;
    }
    before = clock();
    code = model->defaults(p) != 0 ? TISSERAND_NOT_FINITE : model->setup(p, k);
    if (code == 0) {
        code = accuracy > 0.0 ? integrate(model, given[1], interval, accuracy, nrows, k, q, v, rows, work)
                              : TISSERAND_ARGUMENT;
    }
    fprintf(stderr, "cpu_seconds %.6f\n", (double) (clock() - before) / (double) CLOCKS_PER_SEC);
    if (code != 0) {
        fprintf(stderr, "%s: %s failed with code %d, see the header of the method\n", model->name, given[1], code);
    }
    return code == TISSERAND_ARGUMENT || write_rows(model, given[6], nrows, interval, rows) || code != 0;
}

int main(int argc, char **argv)
{
    const tisserand_model *model = TISSERAND_MODEL();
    const double end = argc == 7 ? strtod(argv[3], NULL) : 0.0, interval = argc == 7 ? strtod(argv[4], NULL) : 0.0;
    const double intervals = floor(end / interval * (1.0 + 1e-12));
    double *memory;
    size_t size;
    int failed;

    if (!(intervals >= 0.0 && intervals < 1e9)) {
        fprintf(stderr, USAGE, argv[0]);
        return EXIT_FAILURE;
    }
    size = (size_t) (model->np + model->nk + model->nq + model->nv + tisserand_fixed_work(model));
    size += ((size_t) intervals + 1) * (size_t) tisserand_fixed_row(model);
    memory = (double *) calloc(size, sizeof(double));
    if (memory == NULL) {
        fprintf(stderr, "no memory for %.0f rows\n", intervals + 1.0);
        return EXIT_FAILURE;
    }
    failed = run(model, argv, memory, (long) intervals + 1, interval);
    free(memory);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
