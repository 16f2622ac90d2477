/*
 * A host of a generated model. It needs the model's header and C file, and the C library; no Tisserand:
 *
 *     cc -std=c99 -I free_beam_mean host.c free_beam_mean/free_beam_mean.c -lm
 */

#include <stdio.h>
#include <stdlib.h>

#include "free_beam_mean.h"

static const double Q[FREE_BEAM_MEAN_NQ] = {0.1, 0.2, 0.5, 0.02, -0.01}; /* c1, c2, phi, alpha1, alpha2 */
static const double V[FREE_BEAM_MEAN_NV] = {1.0, -2.0, 3.0, 0.1, 0.2};

static void print(const char *name, const double *values, int count)
{
    printf("%s", name);
    for (int i = 0; i < count; i++) {
        printf(" %.17g", values[i]);
    }
    printf("\n");
}

/* One model, called by the names of its functions: all sizes are constants. */
static int by_name(void)
{
    double p[FREE_BEAM_MEAN_NP], k[FREE_BEAM_MEAN_NK];
    double M[FREE_BEAM_MEAN_NNZ_MASS], h[FREE_BEAM_MEAN_NV], vdot[FREE_BEAM_MEAN_NV], energy[2];

    p[FREE_BEAM_MEAN_P_m] = 2.0;
    p[FREE_BEAM_MEAN_P_l] = 1.5;
    p[FREE_BEAM_MEAN_P_EI] = 30.0;
    if (free_beam_mean_setup(p, k) || free_beam_mean_mass(Q, k, M) || free_beam_mean_force(0.0, Q, V, k, h) ||
        free_beam_mean_accel(0.0, Q, V, k, vdot) || free_beam_mean_energy(Q, V, k, energy)) {
        return 1;
    }
    print("mass", M, FREE_BEAM_MEAN_NNZ_MASS);
    print("force", h, FREE_BEAM_MEAN_NV);
    print("accel", vdot, FREE_BEAM_MEAN_NV);
    print("energy", energy, 2);
    return 0;
}

/* Any model, known by its descriptor alone, with the defaults of its parameters. */
static int by_descriptor(const tisserand_model *model, const double *q, const double *v)
{
    double *p = (double *) calloc((size_t) (model->np + model->nk + model->nv), sizeof(double));
    double *k = p + model->np, *vdot = k + model->nk;
    int code = 1;

    if (p != NULL) {
        for (int i = 0; i < model->np; i++) {
            p[i] = model->p[i].value;
            printf("%s = %g %s\n", model->p[i].name, p[i], model->p[i].unit);
        }
        code = model->setup(p, k);
        if (code == 0) {
            code = model->accel(0.0, q, v, k, vdot);
        }
        print(model->name, vdot, model->nv);
    }
    free(p);
    return code;
}

int main(void)
{
    return by_name() || by_descriptor(free_beam_mean_model(), Q, V) ? EXIT_FAILURE : EXIT_SUCCESS;
}
