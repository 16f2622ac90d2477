/* SPDX-License-Identifier: 0BSD -- see dormand_prince.h. */

#include "dormand_prince.h"

#include <math.h>
#include <stddef.h>

enum {
    STEP = 12,              /* the stages of a step; stage 12 is f at its end */
    ALL = TISSERAND_STAGES, /* and those of the interpolant */
    DEGREE = TISSERAND_DEGREE
};

/* With K[i] = f(t + C[i] h, y + h sum_j A[i][j] K[j]), the step from y to Y is Y = y + h sum_j A[12][j] K[j]. The tests
   of Tisserand verify the order conditions of all coefficients. */
static const double C[ALL] = {
    0.0, 5.260015195876773187856e-2, 7.890022793815159781784e-2, 1.183503419072273967268e-1, 2.816496580927726032732e-1,
    1.0 / 3.0, 0.25, 4.0 / 13.0, 127.0 / 195.0, 0.6, 6.0 / 7.0, 1.0, 1.0, 0.1, 0.2, 7.0 / 9.0
};

static const double A[ALL][ALL] = {
    {0.0},
    {5.260015195876773187856e-2},
    {1.972505698453789945446e-2, 5.917517095361369836338e-2},
    {2.958758547680684918169e-2, 0.0, 8.876275643042054754507e-2},
    {2.413651341592666855024e-1, 0.0, -8.845494793282860853449e-1, 9.248340032617920031157e-1},
    {3.703703703703703703704e-2, 0.0, 0.0, 1.708286087294738712796e-1, 1.254676875668224250167e-1},
    {3.7109375e-2, 0.0, 0.0, 1.70252211019544039315e-1, 6.021653898045596068502e-2, -1.7578125e-2},
    {3.709200011850479271088e-2, 0.0, 0.0, 1.703839257122399938102e-1, 1.072620304463732846518e-1,
     -1.531943774862440175279e-2, 8.273789163814022887585e-3},
    {6.241109587160757171144e-1, 0.0, 0.0, -3.360892629446941294069, -8.682193468417260068182e-1,
     2.759209969944670830494e1, 2.015406755047789340862e1, -4.348988418106995884774e1},
    {4.776625364382643658904e-1, 0.0, 0.0, -2.488114619971667641926, -5.902908268368429963714e-1,
     2.123005144818119423473e1, 1.527923363288242358326e1, -3.328821096898486291945e1, -2.033120170850862613582e-2},
    {-9.37142430085987325717e-1, 0.0, 0.0, 5.1863724288440637083, 1.091437348996729578185, -8.14978701074692612514,
     -1.852006565999695986416e1, 2.27394870993505042819e1, 2.493605552679652389871, -3.046764471898219500382},
    {2.273310147516538207924, 0.0, 0.0, -1.053449546673725019841e1, -2.000872058224862499097,
     -1.795893186311879891728e1, 2.794888452941996005085e1, -2.858998277135023694741, -8.872856933530629544335,
     1.236056717579430306473e1, 6.43392746015763530356e-1},
    {5.429373411656876223805e-2, 0.0, 0.0, 0.0, 0.0, 4.450312892752408881441, 1.891517899314500383043,
     -5.801203960010584781467, 3.111643669578198944089e-1, -1.521609496625160785562e-1, 2.013654008040303483748e-1,
     4.471061572777259051769e-2},
    {5.616750228304795233929e-2, 0.0, 0.0, 0.0, 0.0, 0.0, 2.535002102166248110888e-1, -2.462390374708024899174e-1,
     -1.24191423263816360469e-1, 1.532917982787656973121e-1, 8.201052295634689884917e-3, 7.567897660545699761386e-3,
     -8.298e-3},
    {3.183464816350214050608e-2, 0.0, 0.0, 0.0, 0.0, 2.830090967236677552883e-2, 5.354198830743856762238e-2,
     -5.492374857139098846466e-2, 0.0, 0.0, -1.083473286972493228585e-4, 3.825710908356584129549e-4,
     -3.40465008687404560803e-4, 1.413124436746325002781e-1},
    {-4.288963015837919234086e-1, 0.0, 0.0, 0.0, 0.0, -4.697621415361163843144, 7.683421196062599041842,
     4.068989818397110079702, 3.567271874552811092707e-1, 0.0, 0.0, 0.0, -1.399024165159014621294e-3,
     2.947514789152772338956, -9.150958472179870010819}
};

/* The difference of Y and a solution of order 5 is h sum_j ERROR5[j] K[j]. */
static const double ERROR5[STEP] = {
    1.31200449941948807325e-2, 0.0, 0.0, 0.0, 0.0, -1.225156446376204440721, -4.957589496572501915214e-1,
    1.664377182454986536962, -3.503288487499736816886e-1, 3.341791187130174790297e-1, 8.192320648511571246571e-2,
    -2.235530786388629525884e-2
};

/* Likewise of a solution of order 6; there is one, up to a factor of the difference. The factor is chosen such that both
   differences are equal for a vibration at the limit of stability, omega h = 5.96. */
static const double ERROR6[STEP] = {
    1.500403604170874244394e-1, 0.0, 0.0, 0.0, 0.0, -4.073661785482464813881e1, -1.25727916609797634421e1,
    5.13024459263282742166e1, -4.275253694350680080605, 5.969650931381611183766, 1.625259920281188366812e-1, 0.0
};

/* The weights of stages 0, 8 and 11 of a solution of order 3. */
static const double THIRD[3] = {
    2.440944881889763779528e-1, 7.338466882816118573414e-1, 2.205882352941176470588e-2
};

/* With d0 = Y - y, d1 = h K[0] - d0, d2 = 2 d0 - h (K[0] + K[12]) and d(3 + i) = h sum_j DENSE[i][j] K[j], the
   interpolant at t + x h is y + x (d0 + (1 - x) (d1 + x (d2 + (1 - x) (d3 + x (d4 + (1 - x) (d5 + x d6)))))). */
static const double DENSE[DEGREE - 3][ALL] = {
    {-8.428938276109012865135, 0.0, 0.0, 0.0, 0.0, 5.667149535193777696253e-1, -3.06894994594989169128,
     2.384667656512069828773, 2.117034582445028276716, -8.713915837779729920679e-1, 2.240437430260788275854,
     6.315787787694688181557e-1, -8.89903364513333108207e-2, 1.814850552085472725666e1, -9.194632392478355400045,
     -4.436036387594893966431},
    {1.042750864257913460341e1, 0.0, 0.0, 0.0, 0.0, 2.422834917752581828843e2, 1.652004517172702819851e2,
     -3.745467547226902027952e2, -2.211366685312530603627e1, 7.73343266847226383896, -3.067408473108939818206e1,
     -9.332130526430227872957, 1.569723812177084388613e1, -3.113940321956517767728e1, -9.352924358844478386571,
     3.581684148639408375247e1},
    {1.998505324200243382099e1, 0.0, 0.0, 0.0, 0.0, -3.870373087493517655511e2, -1.891781381951675688283e2,
     5.278081592054236490056e2, -1.157390253995963012614e1, 6.881232694696300016967, -1.000605096691083840318,
     7.777137798053443209287e-1, -2.778205752353508406593, -6.019669523126412075827e1, 8.432040550667716101816e1,
     1.199229113618278932804e1},
    {-2.569393346270374900331e1, 0.0, 0.0, 0.0, 0.0, -1.541897486902364337405e2, -2.315293791760454956754e2,
     3.576391179106141237829e2, 9.340532418362431000391e1, -3.745832313645163315688e1, 1.040996495089623004515e2,
     2.984029342666050312334e1, -4.353345659001114375443e1, 9.632455395918828294839e1, -3.917726167561543916523e1,
     -1.497268362579856258142e2}
};

/* The largest error of the interpolant within a step is this part of |d6|, for vibrations with any omega h up to 8. */
static const double WITHIN = 1.3e-3;

/* The error of a state within a step that is accepted, over that of its end: with 1 instead of 2, up to a fifth more
   accelerations are computed for states whose errors are small beside those that many steps add up to. */
static const double ACCEPTED = 2.0;

/* out = y + h sum_j weight[j] stage[j]; y may be 0 */
static void combine(int n, double h, int count, const double *weight, const double *stages, const double *y, double *out)
{
    for (int i = 0; i < n; i++) {
        out[i] = 0.0;
    }
    for (int j = 0; j < count; j++) {
        const double *stage = stages + j * n;
        if (weight[j] == 0.0) {
            continue;
        }
        for (int i = 0; i < n; i++) {
            out[i] += weight[j] * stage[i];
        }
    }
    for (int i = 0; i < n; i++) {
        out[i] = h * out[i] + (y == NULL ? 0.0 : y[i]);
    }
}

int tisserand_stages(const tisserand_equations *equations, double t, double h, const double *y, double *stages,
                     double *trial, double *end)
{
    const int n = equations->n;
    int code = 0;

    for (int i = 1; i < STEP && code == 0; i++) {
        combine(n, h, i, A[i], stages, y, trial);
        code = equations->f(equations->data, t + C[i] * h, trial, stages + i * n);
    }
    if (code == 0) {
        combine(n, h, STEP, A[STEP], stages, y, end);
    }
    return code;
}

/* The error of element i of a step that the tolerances allow */
static double allowed(int i, const double *y, const double *end, double rtol, const double *atol)
{
    return atol[i] + rtol * (fabs(y[i]) > fabs(end[i]) ? fabs(y[i]) : fabs(end[i]));
}

double tisserand_step_error(int n, double h, const double *y, const double *end, const double *stages, double rtol,
                            const double *atol)
{
    double fifth = 0.0, third = 0.0;

    for (int i = 0; i < n; i++) {
        const double *stage = stages + i, scale = allowed(i, y, end, rtol, atol);
        double e5 = 0.0, e6 = 0.0, e3 = (end[i] - y[i]) / h;
        for (int j = 0; j < STEP; j++) {
            e5 += ERROR5[j] * stage[j * n];
            e6 += ERROR6[j] * stage[j * n];
        }
        e3 -= THIRD[0] * stage[0] + THIRD[1] * stage[8 * n] + THIRD[2] * stage[11 * n];
        fifth += (e5 * e5 + e6 * e6) / (scale * scale);
        third += e3 / scale * (e3 / scale);
    }
    if (fifth == 0.0) {
        return 0.0;
    }
    return h * fifth / sqrt((fifth + 0.01 * third) * (double) n);
}

int tisserand_interpolant(const tisserand_equations *equations, double t, double h, const double *y, const double *end,
                          double *stages, double *trial, double *interpolant)
{
    const int n = equations->n;
    double *d = interpolant;
    int code = equations->f(equations->data, t + h, end, stages + STEP * n);

    for (int i = STEP + 1; i < ALL && code == 0; i++) {
        combine(n, h, i, A[i], stages, y, trial);
        code = equations->f(equations->data, t + C[i] * h, trial, stages + i * n);
    }
    if (code != 0) {
        return code;
    }
    for (int i = 0; i < n; i++) {
        const double f0 = stages[i], f1 = stages[STEP * n + i];
        d[i] = end[i] - y[i];
        d[n + i] = h * f0 - d[i];
        d[2 * n + i] = 2.0 * d[i] - h * (f1 + f0);
    }
    for (int i = 3; i < DEGREE; i++) {
        combine(n, h, ALL, DENSE[i - 3], stages, NULL, d + i * n);
    }
    return 0;
}

double tisserand_interpolant_error(int n, const double *y, const double *end, const double *interpolant, double rtol,
                                   const double *atol)
{
    const double *last = interpolant + (DEGREE - 1) * n;
    double sum = 0.0;

    for (int i = 0; i < n; i++) {
        const double e = WITHIN * last[i] / ACCEPTED / allowed(i, y, end, rtol, atol);
        sum += e * e;
    }
    return sqrt(sum / (double) n);
}

void tisserand_interpolate(int n, double x, const double *y, const double *interpolant, double *state)
{
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int j = DEGREE - 1; j >= 0; j--) {
            sum = (sum + interpolant[j * n + i]) * (j % 2 == 0 ? x : 1.0 - x);
        }
        state[i] = y[i] + sum;
    }
}
