/* A double pendulum in C: the generated code of scenes/double_pendulum.toml, from its initial state, with the Runge-Kutta
 * method of templates/host.
 *
 *     cc -std=c99 -O2 -Igenerated/double_pendulum -Itemplates/host -DTISSERAND_HEADER='"double_pendulum.h"' \
 *        examples/double_pendulum.c templates/host/fixed_step.c generated/double_pendulum/double_pendulum.c -lm
 */
#include "double_pendulum.h"
#include "fixed_step.h"
#include <stdio.h>

enum { NQ = DOUBLE_PENDULUM_NQ, NV = DOUBLE_PENDULUM_NV, WORK = 3 * (NQ + NV) + DOUBLE_PENDULUM_NLAMBDA };

int main(void)
{
    double q[NQ], v[NV], k[DOUBLE_PENDULUM_NK + 1], work[WORK], energy[3]; /* kinetic, strain, gravity */
    tisserand_fixed_counts counts = {0, 0, 0, 0};

    if (double_pendulum_setup(NULL, k) || double_pendulum_start(q, v)) /* no parameters: all numbers are folded */
        return 1;
    for (int i = 0; i <= 5; i++) {
        double_pendulum_energy(q, v, k, energy);
        printf("t = %.1f s: angle of the upper rod %7.4f rad, its rate %8.4f rad/s, energy %8.1e J\n", 0.1 * i,
               q[DOUBLE_PENDULUM_Q_upper_phi], v[DOUBLE_PENDULUM_V_upper_phidot], energy[0] + energy[1] + energy[2]);
        if (tisserand_rk4(double_pendulum_model(), 0.1 * i, 1e-4, 1000, 1000, k, 1e-10, q, v, NULL, NULL, work, &counts))
            return 1;
    }
    return 0;
}
