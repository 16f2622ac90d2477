/*
 * Reference for the benchmarks: M and h, and the accelerations, of eight free planar beams with two shapes, by hand.
 *
 * Arrays are structures of arrays: element e of state b lies at 8 e + b. Vectors of gcc and clang take four states. Sines and
 * cosines are computed in the vectors, to about one unit in the last place for |phi| < 1e5. The values are those of the
 * generated code, in the same order. k: 0 mass, 1 mass l^2 / 12, 2 mass / 5, 3 mass / 7, 4 and 5 the stiffnesses, 6 mass / 3,
 * 7 mass l / 10 (point frame), 8 and 9 the stiffnesses by the modal masses, 10 l^2 / 12, 11 l / 10.
 */

#include <stddef.h>

typedef double V __attribute__((vector_size(32), aligned(8)));
typedef long long I __attribute__((vector_size(32)));
#define IN const double *__restrict
#define OUT double *__restrict
#define AT(x, e) (*(const V *) ((x) + 8 * (e)))
#define TO(x, e) (*(V *) ((x) + 8 * (e)))
#define ALL(x) ((x) - (V) {0.0, 0.0, 0.0, 0.0})

void hand_batch_setup(IN p, int point, OUT k)
{
    const double mass = p[0], l = p[1], stiffness = p[2] / (l * l * l);
    k[0] = mass;
    k[1] = mass * l * l / 12.0;
    k[2] = mass / 5.0;
    k[3] = mass / 7.0;
    k[4] = (point ? 64.0 : 144.0) * stiffness;
    k[5] = (point ? 192.0 : 1200.0) * stiffness;
    k[6] = mass / 3.0;
    k[7] = mass * l / 10.0;
    k[8] = k[4] / k[2];
    k[9] = k[5] / k[3];
    k[10] = l * l / 12.0;
    k[11] = l / 10.0;
}

static inline void sincos4(V x, V *s, V *c)
{
    const V shift = ALL(6755399441055744.0);
    const V y = x * 0.6366197723675814 + shift, n = y - shift;
    const V r = (x - n * 1.5707963267341256) - n * 6.0771005065061922e-11, z = r * r;
    V f = z * 1.5895432973634774e-10 - 2.5050734385276395e-08;
    V g = 2.0875705395290323e-09 - z * 1.1358749181413732e-11;
    f = f * z + 2.7557313538498483e-06;
    g = g * z - 2.755731421703596e-07;
    f = f * z - 0.0001984126982935851;
    g = g * z + 2.4801587289002076e-05;
    f = f * z + 0.00833333333332184;
    g = g * z - 0.0013888888888873342;
    f = f * z - 0.1666666666666663;
    g = g * z + 0.041666666666666595;
    const V sine = r + r * z * f, cosine = 1.0 - 0.5 * z + z * z * g;
    const I quadrant = (I) y, exchanged = ((I) sine ^ (I) cosine) & -(quadrant & 1);
    *s = (V) ((I) sine ^ exchanged ^ ((quadrant & 2) << 62));
    *c = (V) ((I) cosine ^ exchanged ^ (((quadrant + 1) & 2) << 62));
}

void hand_batch_mean(IN q0, IN v0, IN k, OUT M0, OUT h0)
{
    for (int b = 0; b < 8; b += 4) {
        const double *q = q0 + b, *v = v0 + b;
        double *M = M0 + b, *h = h0 + b;
        const V a1 = AT(q, 3), a2 = AT(q, 4), w = AT(v, 2), ww = w * w, d1 = k[2] * a1, d2 = k[3] * a2;
        TO(M, 0) = ALL(k[0]);
        TO(M, 1) = ALL(k[0]);
        TO(M, 2) = k[1] + d1 * a1 + d2 * a2;
        TO(M, 3) = ALL(k[2]);
        TO(M, 4) = ALL(k[3]);
        TO(h, 0) = ALL(0.0);
        TO(h, 1) = ALL(0.0);
        TO(h, 2) = (w + w) * (d1 * AT(v, 3) + d2 * AT(v, 4));
        TO(h, 3) = k[4] * a1 - ww * d1;
        TO(h, 4) = k[5] * a2 - ww * d2;
    }
}

void hand_batch_point(IN q0, IN v0, IN k, OUT M0, OUT h0)
{
    for (int b = 0; b < 8; b += 4) {
        const double *q = q0 + b, *v = v0 + b;
        double *M = M0 + b, *h = h0 + b;
        V s, c;
        sincos4(AT(q, 2), &s, &c);
        const V a1 = AT(q, 3), a2 = AT(q, 4), w = AT(v, 2), ww = w * w, d1 = k[2] * a1, d2 = k[3] * a2;
        const V ms = k[6] * s, mc = k[6] * c, centrifugal = a1 * ww, coriolis = (w + w) * AT(v, 3);
        TO(M, 0) = ALL(k[0]);
        TO(M, 1) = -(a1 * mc);
        TO(M, 2) = -ms;
        TO(M, 3) = ALL(k[0]);
        TO(M, 4) = -(a1 * ms);
        TO(M, 5) = mc;
        TO(M, 6) = k[1] + d1 * a1 + d2 * a2;
        TO(M, 7) = ALL(k[7]);
        TO(M, 8) = ALL(k[2]);
        TO(M, 9) = ALL(k[3]);
        TO(h, 0) = centrifugal * ms - coriolis * mc;
        TO(h, 1) = -(centrifugal * mc) - coriolis * ms;
        TO(h, 2) = (w + w) * (d1 * AT(v, 3) + d2 * AT(v, 4));
        TO(h, 3) = k[4] * a1 - ww * d1;
        TO(h, 4) = k[5] * a2 - ww * d2;
    }
}

/* c moves on a straight line: w' = -2 w (alpha . c8 alpha') / J, and alpha'' = alpha (w^2 - K / c8). */
void hand_batch_accel_mean(IN q0, IN v0, IN k, OUT a0)
{
    for (int b = 0; b < 8; b += 4) {
        const double *q = q0 + b, *v = v0 + b;
        double *vdot = a0 + b;
        const V a1 = AT(q, 3), a2 = AT(q, 4), w = AT(v, 2), ww = w * w, d1 = k[2] * a1, d2 = k[3] * a2;
        TO(vdot, 0) = ALL(0.0);
        TO(vdot, 1) = ALL(0.0);
        TO(vdot, 2) = -(w + w) * (d1 * AT(v, 3) + d2 * AT(v, 4)) / (k[1] + d1 * a1 + d2 * a2);
        TO(vdot, 3) = a1 * (ww - k[8]);
        TO(vdot, 4) = a2 * (ww - k[9]);
    }
}

/* With c'' in the body frame, all by the mass: {c''_2, alpha''_1} has the constant matrix [1 1/3; 1/3 1/5]. */
void hand_batch_accel_point(IN q0, IN v0, IN k, OUT a0)
{
    const double third = 1.0 / 3.0, fifth = 1.0 / 5.0, seventh = 1.0 / 7.0;
    for (int b = 0; b < 8; b += 4) {
        const double *q = q0 + b, *v = v0 + b;
        double *vdot = a0 + b;
        V s, c;
        sincos4(AT(q, 2), &s, &c);
        const V a1 = AT(q, 3), a2 = AT(q, 4), w = AT(v, 2), ww = w * w, twice = w + w;
        const V f1 = twice * AT(v, 3) * third, f2 = a1 * ww * third, f4 = a1 * (ww - k[8]) * fifth;
        const V f5 = a2 * (ww - k[9]) * seventh;
        const V f3 = -twice * (a1 * AT(v, 3) * fifth + a2 * AT(v, 4) * seventh);
        const V bent = (f4 - f2 * third) * 11.25, across = f2 - bent * third;
        const V inertia = k[10] - 7.0 * k[11] * k[11] + a1 * a1 * (fifth - third * third) + a2 * a2 * seventh;
        const V spin = (f3 + a1 * third * f1 - 7.0 * k[11] * f5) / inertia;
        const V along = f1 + a1 * third * spin;
        TO(vdot, 0) = along * c - across * s;
        TO(vdot, 1) = along * s + across * c;
        TO(vdot, 2) = spin;
        TO(vdot, 3) = bent;
        TO(vdot, 4) = 7.0 * (f5 - k[11] * spin);
    }
}
