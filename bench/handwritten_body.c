/*
 * A body in space with N modes, by hand: the yardstick of bench/loops_by_hand.py.
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * M, h and the iteration matrix as the generated functions compute them, with the same arguments and outputs; for one
 * N (-DN=8). With -DMEAN: accelerations in the mean frame, where c8 = I and K is diagonal.
 *
 * Tables lie in blocks of four rows; of a block, for each column j, all tables together, so that memory is read once and
 * in order. The sums of a block stay in vector registers over all columns. All that is linear in the modes, such as
 * J = C3 + sum alpha_i (S_i + C4_i), is added up in the same pass.
 */
#include <string.h>

enum { W = 4, BLOCKS = (N + W - 1) / W, LAST = N - (BLOCKS - 1) * W };
typedef double vec __attribute__((vector_size(8 * W)));
typedef double loose __attribute__((vector_size(8 * W), aligned(8)));
#define INLINE static inline __attribute__((always_inline))
typedef const double *__restrict IN;
typedef double *__restrict OUT;

static vec pairs[BLOCKS][N][9], stiffness[BLOCKS][N], unit[BLOCKS][N]; /* C5 (6) and c7 (3); K; c8 */
static vec C4[BLOCKS][6], c6[BLOCKS][3], c2[BLOCKS][3], K[BLOCKS];
static double m, C3[6], c1[3], triangle[N * (N + 1) / 2];
static const vec zero;

INLINE vec load(IN x, int block)
{
    if (LAST == W || block < BLOCKS - 1) return *(const loose *) (x + W * block);
    vec r = zero;
    for (int l = 0; l < LAST; l++) r[l] = x[W * block + l];
    return r;
}

INLINE void store(OUT x, int block, vec r)
{
    if (LAST == W || block < BLOCKS - 1) *(loose *) (x + W * block) = r;
    else for (int l = 0; l < LAST; l++) x[W * block + l] = r[l];
}

INLINE double total(vec x) { return (x[0] + x[2]) + (x[1] + x[3]); }

void hand_setup(IN p)
{
    IN q = p;
    memset(pairs, 0, sizeof pairs), memset(stiffness, 0, sizeof stiffness), memset(unit, 0, sizeof unit);
    memset(C4, 0, sizeof C4), memset(c6, 0, sizeof c6), memset(c2, 0, sizeof c2), memset(K, 0, sizeof K);
    m = *q++;
#ifndef MEAN
    for (int a = 0; a < 3; a++) c1[a] = *q++;
    for (int i = 0; i < N; i++) for (int a = 0; a < 3; a++) c2[i / W][a][i % W] = *q++;
#endif
    for (int a = 0; a < 6; a++) C3[a] = *q++;
    for (int i = 0; i < N; i++) for (int a = 0; a < 6; a++) C4[i / W][a][i % W] = *q++;
    for (int i = 0; i < N; i++)
        for (int j = i; j < N; j++)
            for (int a = 0; a < 6; a++) pairs[i / W][j][a][i % W] = pairs[j / W][i][a][j % W] = *q++;
#ifndef MEAN
    for (int i = 0; i < N; i++) for (int a = 0; a < 3; a++) c6[i / W][a][i % W] = *q++;
#endif
    for (int i = 0; i < N; i++)
        for (int j = i + 1; j < N; j++)
            for (int a = 6; a < 9; a++) pairs[j / W][i][a][j % W] = -(pairs[i / W][j][a][i % W] = *q++);
#ifdef MEAN
    for (int i = 0; i < N; i++) K[i / W][i % W] = *q++;
#else
    memcpy(triangle, q, sizeof triangle);
    for (int i = 0; i < N; i++) for (int j = i; j < N; j++) unit[i / W][j][i % W] = unit[j / W][i][j % W] = *q++;
    for (int i = 0; i < N; i++) for (int j = i; j < N; j++) stiffness[i / W][j][i % W] = stiffness[j / W][i][j % W] = *q++;
#endif
}

typedef struct { double at[9]; } matrix;

INLINE matrix rotation(IN q)
{
    const double a = q[3], b = q[4], c = q[5], d = q[6], aa = a * a, bb = b * b, cc = c * c, dd = d * d;
    const double ab = a * b, ac = a * c, ad = a * d, bc = b * c, bd = b * d, cd = c * d;
    return (matrix){{aa + bb - cc - dd, 2 * (bc - ad), 2 * (bd + ac), 2 * (bc + ad), aa - bb + cc - dd, 2 * (cd - ab),
                     2 * (bd - ac), 2 * (cd + ab), aa - bb - cc + dd}};
}

#define CROSS(r, a, b) ((r)[0] = (a)[1] * (b)[2] - (a)[2] * (b)[1], (r)[1] = (a)[2] * (b)[0] - (a)[0] * (b)[2], \
                        (r)[2] = (a)[0] * (b)[1] - (a)[1] * (b)[0])
#define TIMES(r, A, x) ((r)[0] = (A)[0] * (x)[0] + (A)[1] * (x)[1] + (A)[2] * (x)[2], \
                        (r)[1] = (A)[3] * (x)[0] + (A)[4] * (x)[1] + (A)[5] * (x)[2], \
                        (r)[2] = (A)[6] * (x)[0] + (A)[7] * (x)[1] + (A)[8] * (x)[2])
/* Symmetric: 11 12 13 22 23 33 */
#define SYMMETRIC(r, S, x) ((r)[0] = (S)[0] * (x)[0] + (S)[1] * (x)[1] + (S)[2] * (x)[2], \
                            (r)[1] = (S)[1] * (x)[0] + (S)[3] * (x)[1] + (S)[4] * (x)[2], \
                            (r)[2] = (S)[2] * (x)[0] + (S)[4] * (x)[1] + (S)[5] * (x)[2])
#define S_START {C4[b][0], C4[b][1], C4[b][2], C4[b][3], C4[b][4], C4[b][5]}
#define ZERO3 {zero, zero, zero}
#define ZERO6 {zero, zero, zero, zero, zero, zero}

#ifndef MEAN

void hand_mass(IN q, OUT M)
{
    IN al = q + 7;
    const matrix Q = rotation(q);
    double *const pi = M + 12 + 3 * N;
    double *const columns[6] = {M + 4, M + 8 + N, M + 12 + 2 * N, pi + 3, pi + 5 + N, pi + 6 + 2 * N};
    vec Jv[6] = ZERO6, dv[3] = ZERO3;
    for (int b = 0; b < BLOCKS; b++) {
        vec S[6] = S_START, d3[3] = {c6[b][0], c6[b][1], c6[b][2]};
        for (int j = 0; j < N; j++) {
            for (int a = 0; a < 6; a++) S[a] += pairs[b][j][a] * al[j];
            for (int a = 0; a < 3; a++) d3[a] -= pairs[b][j][6 + a] * al[j];
        }
        const vec x = load(al, b);
        for (int a = 0; a < 6; a++) Jv[a] += x * (S[a] + C4[b][a]);
        for (int a = 0; a < 3; a++) {
            dv[a] += x * c2[b][a];
            store(columns[a], b, Q.at[3 * a] * c2[b][0] + Q.at[3 * a + 1] * c2[b][1] + Q.at[3 * a + 2] * c2[b][2]);
            store(columns[3 + a], b, d3[a]);
        }
    }
    double d[3], J[6];
    for (int a = 0; a < 3; a++) d[a] = c1[a] + total(dv[a]);
    for (int a = 0; a < 6; a++) J[a] = C3[a] + total(Jv[a]);
    for (int a = 0; a < 3; a++) {
        double *const column = M + a * (4 + N);
        column[0] = m;
        CROSS(column + 1, d, Q.at + 3 * a);
    }
    pi[0] = J[0], pi[1] = J[1], pi[2] = J[2];
    pi[3 + N] = J[3], pi[4 + N] = J[4], pi[5 + 2 * N] = J[5];
    memcpy(pi + 6 + 3 * N, triangle, sizeof triangle);
}

void hand_force(IN q, IN v, OUT h)
{
    IN al = q + 7, ad = v + 6, o = v + 3;
    const matrix Q = rotation(q);
    const double w[6] = {o[0] * o[0], 2 * o[0] * o[1], 2 * o[0] * o[2], o[1] * o[1], 2 * o[1] * o[2], o[2] * o[2]};
    vec Jv[6] = ZERO6, Bv[6] = ZERO6, dv[3] = ZERO3, ev[3] = ZERO3, yv[3] = ZERO3;
    for (int b = 0; b < BLOCKS; b++) {
        vec S[6] = S_START, g[3] = ZERO3, e = zero;
        for (int j = 0; j < N; j++) {
            for (int a = 0; a < 6; a++) S[a] += pairs[b][j][a] * al[j];
            for (int a = 0; a < 3; a++) g[a] += pairs[b][j][6 + a] * ad[j];
            e += stiffness[b][j] * al[j];
        }
        const vec x = load(al, b), y = load(ad, b);
        for (int a = 0; a < 6; a++) Jv[a] += x * (S[a] + C4[b][a]), Bv[a] += y * S[a];
        for (int a = 0; a < 3; a++) dv[a] += x * c2[b][a], ev[a] += y * c2[b][a], yv[a] += y * c6[b][a] + x * g[a];
        for (int a = 0; a < 6; a++) e -= w[a] * S[a];
        store(h + 6, b, e - 2 * (o[0] * g[0] + o[1] * g[1] + o[2] * g[2]));
    }
    double d[3], e[3], y[3], J[6], B[6], r[3], s[3], z[3], u[3];
    for (int a = 0; a < 3; a++) d[a] = c1[a] + total(dv[a]), e[a] = total(ev[a]), y[a] = total(yv[a]);
    for (int a = 0; a < 6; a++) J[a] = C3[a] + total(Jv[a]), B[a] = total(Bv[a]);
    CROSS(r, o, d);
    CROSS(s, o, r);
    CROSS(r, o, e);
    for (int a = 0; a < 3; a++) z[a] = s[a] + 2 * r[a];
    TIMES(h, Q.at, z);
    SYMMETRIC(r, J, o);
    CROSS(s, o, r);
    SYMMETRIC(r, B, o);
    CROSS(u, y, o);
    for (int a = 0; a < 3; a++) h[3 + a] = s[a] + 2 * r[a] - u[a];
}

/* The columns of the iteration matrix: c1 .. c3 have one entry each, then e0 .. e3, alpha, cdot, omega, alphadot. */
enum {
    E = 3, OF_E = 10 + N, ALPHA = E + 4 * OF_E, OF_ALPHA = 7 + N, CDOT = ALPHA + N * OF_ALPHA, OF_CDOT = 5 + N,
    OMEGA = CDOT + 3 * OF_CDOT, OF_OMEGA = 10 + N, ALPHADOT = OMEGA + 3 * OF_OMEGA
};

void hand_jacobian(IN y, IN ydot, double cj, OUT jac)
{
    IN al = y + 7, o = y + 10 + N, ad = y + 13 + N, cdd = ydot + 7 + N, od = ydot + 10 + N, aa = ydot + 13 + N;
    const matrix Q = rotation(y);
    const double oo[6] = {o[0] * o[0], o[0] * o[1], o[0] * o[2], o[1] * o[1], o[1] * o[2], o[2] * o[2]};
    const double w[6] = {oo[0], 2 * oo[1], 2 * oo[2], oo[3], 2 * oo[4], oo[5]};
    /* d(Q (od x c2 + o x (o x c2))): QW c2; of the rates, 2 Q o x + cj Q: QO c2 */
    const double rates[9] = {-(oo[3] + oo[5]), oo[1] - od[2], oo[2] + od[1], oo[1] + od[2], -(oo[0] + oo[5]),
                             oo[4] - od[0], oo[2] - od[1], oo[4] + od[0], -(oo[0] + oo[3])};
    const double twice[9] = {cj, -2 * o[2], 2 * o[1], 2 * o[2], cj, -2 * o[0], -2 * o[1], 2 * o[0], cj};
    double QW[9], QO[9], bc[3];
    for (int a = 0; a < 3; a++) {
        bc[a] = Q.at[a] * cdd[0] + Q.at[3 + a] * cdd[1] + Q.at[6 + a] * cdd[2];
        for (int c = 0; c < 3; c++) {
            IN row = Q.at + 3 * a;
            QW[3 * a + c] = row[0] * rates[c] + row[1] * rates[3 + c] + row[2] * rates[6 + c];
            QO[3 * a + c] = row[0] * twice[c] + row[1] * twice[3 + c] + row[2] * twice[6 + c];
        }
    }
    vec Jv[6] = ZERO6, Bv[6] = ZERO6, dv[3] = ZERO3, ev[3] = ZERO3, fv[3] = ZERO3, yv[3] = ZERO3;
    const double v0 = -od[0], v1 = -od[1], v2 = -od[2];
    for (int b = 0; b < BLOCKS; b++) {
        vec S[6] = S_START, T[6] = ZERO6, d3[3] = {c6[b][0], c6[b][1], c6[b][2]}, g[3] = ZERO3, f[3] = ZERO3;
        for (int j = 0; j < N; j++) {
            const double r = al[j], s = ad[j];
            for (int a = 0; a < 6; a++) {
                const vec x = pairs[b][j][a];
                S[a] += x * r;
                T[a] += x * s;
            }
        }
        for (int j = 0; j < N; j++) {
            const double r = al[j], s = ad[j], t = aa[j];
            const vec *x = pairs[b][j];
            for (int a = 0; a < 3; a++) d3[a] -= x[6 + a] * r, g[a] += x[6 + a] * s, f[a] += x[6 + a] * t;
            store(jac + ALPHA + j * OF_ALPHA + 7, b,
                  stiffness[b][j] + (v0 * x[6] + v1 * x[7] + v2 * x[8])
                      - (w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3] + w[4] * x[4] + w[5] * x[5]));
            store(jac + ALPHADOT + j * OF_ALPHA + 7, b,
                  cj * unit[b][j] - 2 * (o[0] * x[6] + o[1] * x[7] + o[2] * x[8]));
        }
        const vec x = load(al, b), z = load(ad, b), t = load(aa, b);
        for (int a = 0; a < 6; a++) Jv[a] += x * (S[a] + C4[b][a]), Bv[a] += z * S[a];
        for (int a = 0; a < 3; a++) {
            dv[a] += x * c2[b][a], ev[a] += z * c2[b][a], fv[a] += t * c2[b][a];
            yv[a] += z * c6[b][a] + x * g[a];
        }
        vec So[3], Sw[3], To[3], r[3], s[3], u[3], P[6], D[6];
        SYMMETRIC(So, S, o);
        SYMMETRIC(Sw, S, od);
        SYMMETRIC(To, T, o);
        CROSS(s, o, So);
        CROSS(r, c2[b], bc);
        CROSS(u, g, o);
        TIMES(P, QW, c2[b]);
        TIMES(D, QO, c2[b]);
        for (int a = 0; a < 3; a++) P[3 + a] = r[a] + 2 * (Sw[a] + s[a] + To[a]) - u[a] + f[a];
        CROSS(u, d3, o);
        for (int a = 0; a < 3; a++) D[3 + a] = 2 * So[a] - u[a] + cj * d3[a];
        for (int l = 0; l < W && W * b + l < N; l++) {
            double *const pa = jac + ALPHA + (W * b + l) * OF_ALPHA, *const pd = jac + ALPHADOT + (W * b + l) * OF_ALPHA;
            pa[0] = cj;
            pd[0] = -1.0;
            for (int a = 0; a < 6; a++) pa[1 + a] = P[a][l], pd[1 + a] = D[a][l];
        }
        for (int a = 0; a < 3; a++) {
            store(jac + CDOT + a * OF_CDOT + 5, b,
                  cj * (Q.at[3 * a] * c2[b][0] + Q.at[3 * a + 1] * c2[b][1] + Q.at[3 * a + 2] * c2[b][2]));
            store(jac + OMEGA + a * OF_OMEGA + 10, b, cj * d3[a] - 2 * (So[a] + g[a]));
        }
    }
    double d[3], e[3], f[3], yy[3], J[6], B[6], r[3], s[3], z[3], L[3];
    for (int a = 0; a < 3; a++) d[a] = c1[a] + total(dv[a]), e[a] = total(ev[a]), f[a] = total(fv[a]), yy[a] = total(yv[a]);
    for (int a = 0; a < 6; a++) J[a] = C3[a] + total(Jv[a]), B[a] = total(Bv[a]);
    CROSS(r, o, d);
    CROSS(s, o, r);
    CROSS(r, o, e);
    for (int a = 0; a < 3; a++) z[a] = s[a] + 2 * r[a] + f[a];
    CROSS(r, od, d);
    for (int a = 0; a < 3; a++) z[a] += r[a];
    for (int a = 0; a < 3; a++) jac[a] = cj;
    /* dQ/de, and the rates of the quaternion */
    const double p0 = 2 * y[3], p1 = 2 * y[4], p2 = 2 * y[5], p3 = 2 * y[6];
    const double by_e[4][9] = {{p0, -p3, p2, p3, p0, -p1, -p2, p1, p0}, {p1, p2, p3, p2, -p1, -p0, p3, p0, -p1},
                               {-p2, p1, p0, p1, p2, p3, -p0, p3, -p2}, {-p3, -p0, p1, p0, -p3, p2, p1, p2, p3}};
    const double h0 = .5 * o[0], h1 = .5 * o[1], h2 = .5 * o[2];
    const double spin[4][4] = {{cj, h0, h1, h2}, {-h0, cj, -h2, h1}, {-h1, h2, cj, -h0}, {-h2, -h1, h0, cj}};
    for (int c = 0; c < 4; c++) {
        double *const column = jac + E + c * OF_E;
        IN A = by_e[c];
        double t[3];
        for (int a = 0; a < 4; a++) column[a] = spin[a][c];
        TIMES(column + 4, A, z);
        for (int a = 0; a < 3; a++) t[a] = A[a] * cdd[0] + A[3 + a] * cdd[1] + A[6 + a] * cdd[2];
        CROSS(column + 7, d, t);
        for (int b = 0; b < BLOCKS; b++) store(column + 10, b, c2[b][0] * t[0] + c2[b][1] * t[1] + c2[b][2] * t[2]);
    }
    for (int a = 0; a < 3; a++) {
        double *const column = jac + CDOT + a * OF_CDOT;
        column[0] = -1.0;
        column[1] = cj * m;
        CROSS(r, d, Q.at + 3 * a);
        for (int c = 0; c < 3; c++) column[2 + c] = cj * r[c];
    }
    const double rows[3][4] = {{.5 * y[4], -.5 * y[3], -.5 * y[6], .5 * y[5]}, {.5 * y[5], .5 * y[6], -.5 * y[3], -.5 * y[4]},
                               {.5 * y[6], -.5 * y[5], .5 * y[4], -.5 * y[3]}};
    const double od1 = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
    const double F[9] = {J[0], J[1], J[2], J[1], J[3], J[4], J[2], J[4], J[5]};
    const double G[9] = {B[0], B[1], B[2], B[1], B[3], B[4], B[2], B[4], B[5]};
    SYMMETRIC(L, J, o);
    for (int a = 0; a < 3; a++) L[a] += yy[a];
    const double X[9] = {0, -L[2], L[1], L[2], 0, -L[0], -L[1], L[0], 0};
    const double cross[9] = {0, -o[2], o[1], o[2], 0, -o[0], -o[1], o[0], 0};
    const double shift[9] = {0, 2 * e[2] + cj * d[2], -2 * e[1] - cj * d[1], -2 * e[2] - cj * d[2], 0,
                             2 * e[0] + cj * d[0], 2 * e[1] + cj * d[1], -2 * e[0] - cj * d[0], 0};
    for (int c = 0; c < 3; c++) {
        double *const column = jac + OMEGA + c * OF_OMEGA;
        for (int a = 0; a < 4; a++) column[a] = rows[c][a];
        double t[3];
        for (int a = 0; a < 3; a++)
            t[a] = o[a] * d[c] - 2 * d[a] * o[c] + shift[3 * a + c] + (a == c ? od1 : 0.0);
        TIMES(column + 4, Q.at, t);
        for (int a = 0; a < 3; a++)
            column[7 + a] = cross[3 * a] * F[c] + cross[3 * a + 1] * F[3 + c] + cross[3 * a + 2] * F[6 + c] - X[3 * a + c]
                            + 2 * G[3 * a + c] + cj * F[3 * a + c];
    }
}

#else

/* vdot: the modes are eliminated, since c8 = I; what stays is a system of three with J - d3 d3^T. */
void hand_accel(IN q, IN v, OUT vdot)
{
    IN al = q + 7, ad = v + 6, o = v + 3;
    const double w[6] = {o[0] * o[0], 2 * o[0] * o[1], 2 * o[0] * o[2], o[1] * o[1], 2 * o[1] * o[2], o[2] * o[2]};
    vec Jv[6] = ZERO6, Bv[6] = ZERO6, Dv[6] = ZERO6, yv[3] = ZERO3, rv[3] = ZERO3;
    static vec D[BLOCKS][3], F[BLOCKS];
    for (int b = 0; b < BLOCKS; b++) {
        vec S[6] = S_START, d3[3] = ZERO3, g[3] = ZERO3;
        for (int j = 0; j < N; j++) {
            const double r = al[j], s = ad[j];
            for (int a = 0; a < 6; a++) S[a] += pairs[b][j][a] * r;
            for (int a = 0; a < 3; a++) d3[a] -= pairs[b][j][6 + a] * r, g[a] += pairs[b][j][6 + a] * s;
        }
        const vec x = load(al, b), y = load(ad, b);
        for (int a = 0; a < 6; a++) Jv[a] += x * (S[a] + C4[b][a]), Bv[a] += y * S[a];
        vec f = 2 * (o[0] * g[0] + o[1] * g[1] + o[2] * g[2]) - K[b] * x;
        for (int a = 0; a < 6; a++) f += w[a] * S[a];
        Dv[0] += d3[0] * d3[0], Dv[1] += d3[0] * d3[1], Dv[2] += d3[0] * d3[2];
        Dv[3] += d3[1] * d3[1], Dv[4] += d3[1] * d3[2], Dv[5] += d3[2] * d3[2];
        for (int a = 0; a < 3; a++) yv[a] += x * g[a], rv[a] += d3[a] * f, D[b][a] = d3[a];
        F[b] = f;
    }
    double J[6], A[6], B[6], y[3], r[3], s[3], t[3], u[3];
    for (int a = 0; a < 6; a++) J[a] = C3[a] + total(Jv[a]), A[a] = J[a] - total(Dv[a]), B[a] = total(Bv[a]);
    for (int a = 0; a < 3; a++) y[a] = total(yv[a]);
    SYMMETRIC(r, J, o);
    CROSS(s, o, r);
    SYMMETRIC(t, B, o);
    CROSS(u, y, o);
    for (int a = 0; a < 3; a++) r[a] = u[a] - s[a] - 2 * t[a] - total(rv[a]);
    const double e0 = 1 / A[0], l1 = A[1] * e0, l2 = A[2] * e0, a11 = A[3] - l1 * A[1], a12 = A[4] - l1 * A[2];
    const double e1 = 1 / a11, l3 = a12 * e1, a22 = A[5] - l2 * A[2] - l3 * a12;
    const double z1 = r[1] - l1 * r[0], x2 = (r[2] - l2 * r[0] - l3 * z1) / a22, x1 = z1 * e1 - l3 * x2;
    const double x0 = r[0] * e0 - l1 * x1 - l2 * x2;
    vdot[0] = vdot[1] = vdot[2] = 0.0;
    vdot[3] = x0, vdot[4] = x1, vdot[5] = x2;
    for (int b = 0; b < BLOCKS; b++) store(vdot + 6, b, F[b] - D[b][0] * x0 - D[b][1] * x1 - D[b][2] * x2);
}

#endif
