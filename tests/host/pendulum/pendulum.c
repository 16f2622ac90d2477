/*
 * SPDX-License-Identifier: 0BSD
 *
 * A rigid rod that hangs from a pivot, as a generated scene would have it, written and derived by hand: the hosts are
 * tested against something that the emission had no part in. Its centre (x, y) is at the distance a from the pivot
 * (P(t), 0), P = s sin(w t), in the direction phi; gravity g acts along -y:
 *
 *     g = [x - a cos phi - P; y - a sin phi],     M = diag(m, m, J),     h = [0; m g; 0]
 */

#include "pendulum.h"

#include <math.h>

enum { NQ = 3, NL = 2, A = 0, MASS, INERTIA, GRAVITY, STROKE, OMEGA, NP };

static const int COLUMNS_MASS[] = {0, 1, 2, 3}, ROWS_MASS[] = {0, 1, 2};
static const tisserand_pattern PATTERN_MASS = {3, 3, 3, 1, COLUMNS_MASS, ROWS_MASS, 0};
static const int COLUMNS_G[] = {0, 1, 2, 4}, ROWS_G[] = {0, 1, 0, 1};
static const tisserand_pattern PATTERN_G = {2, 3, 4, 0, COLUMNS_G, ROWS_G, 0};

/* Jacobians have full columns: which entries vanish is no matter of the hosts. */
#define ROWS8 0, 1, 2, 3, 4, 5, 6, 7
#define ROWS10 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
static const int COLUMNS_8[] = {0, 8, 16, 24, 32, 40, 48, 56, 64};
static const int ROWS_8[] = {ROWS8, ROWS8, ROWS8, ROWS8, ROWS8, ROWS8, ROWS8, ROWS8};
static const tisserand_pattern PATTERN_8 = {8, 8, 64, 0, COLUMNS_8, ROWS_8, 0};
static const int COLUMNS_10[] = {0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100};
static const int ROWS_10[] = {ROWS10, ROWS10, ROWS10, ROWS10, ROWS10, ROWS10, ROWS10, ROWS10, ROWS10, ROWS10};
static const tisserand_pattern PATTERN_10 = {10, 10, 100, 0, COLUMNS_10, ROWS_10, 0};

static const double DEFAULTS[NP] = {0.5, 2.0, 0.125, 9.81, 0.0, 3.0};

static int defaults(double *p)
{
    for (int i = 0; i < NP; i++) {
        p[i] = DEFAULTS[i];
    }
    return 0;
}

static int setup(const double *p, double *k)
{
    for (int i = 0; i < NP; i++) {
        k[i] = p[i];
    }
    return k[MASS] > 0.0 ? 0 : 2;
}

static int mass(const double *q, const double *k, double *M)
{
    (void) q;
    M[0] = M[1] = k[MASS];
    M[2] = k[INERTIA];
    return 0;
}

static int force(double t, const double *q, const double *v, const double *k, double *h)
{
    (void) t, (void) q, (void) v;
    h[0] = h[2] = 0.0;
    h[1] = k[MASS] * k[GRAVITY];
    return 0;
}

static int mass_force(double t, const double *q, const double *v, const double *k, double *M, double *h)
{
    return mass(q, k, M) || force(t, q, v, k, h);
}

static int constraints(double t, const double *q, const double *k, double *g)
{
    g[0] = q[0] - k[A] * cos(q[2]) - k[STROKE] * sin(k[OMEGA] * t);
    g[1] = q[1] - k[A] * sin(q[2]);
    return 0;
}

static int constraint_rates(double t, const double *q, const double *v, const double *k, double *gdot)
{
    gdot[0] = v[0] + k[A] * sin(q[2]) * v[2] - k[STROKE] * k[OMEGA] * cos(k[OMEGA] * t);
    gdot[1] = v[1] - k[A] * cos(q[2]) * v[2];
    return 0;
}

static int constraint_jacobian(double t, const double *q, const double *k, double *G)
{
    (void) t;
    G[0] = G[1] = 1.0;
    G[2] = k[A] * sin(q[2]);
    G[3] = -k[A] * cos(q[2]);
    return 0;
}

static int constraint_bias(double t, const double *q, const double *v, const double *k, double *gamma)
{
    gamma[0] = -k[STROKE] * k[OMEGA] * k[OMEGA] * sin(k[OMEGA] * t) - k[A] * cos(q[2]) * v[2] * v[2];
    gamma[1] = -k[A] * sin(q[2]) * v[2] * v[2];
    return 0;
}

/* M dv = G^T lambda - h with G dv = r: elimination of dv leaves two equations for lambda. */
static int saddle(double t, const double *q, const double *k, const double *h, const double *r, double *dv,
                  double *lambda)
{
    double G[4];
    const double m = k[MASS], J = k[INERTIA];
    constraint_jacobian(t, q, k, G);
    const double s11 = 1.0 / m + G[2] * G[2] / J, s12 = G[2] * G[3] / J, s22 = 1.0 / m + G[3] * G[3] / J;
    const double r1 = r[0] + h[0] / m + G[2] * h[2] / J, r2 = r[1] + h[1] / m + G[3] * h[2] / J;
    const double det = s11 * s22 - s12 * s12;
    if (!(det > 0.0)) {
        return 1;
    }
    lambda[0] = (s22 * r1 - s12 * r2) / det;
    lambda[1] = (s11 * r2 - s12 * r1) / det;
    dv[0] = (lambda[0] - h[0]) / m;
    dv[1] = (lambda[1] - h[1]) / m;
    dv[2] = (G[2] * lambda[0] + G[3] * lambda[1] - h[2]) / J;
    return isfinite(dv[0] + dv[1] + dv[2]) ? 0 : 2;
}

static int solve(double t, const double *q, const double *v, const double *k, double *vdot, double *lambda)
{
    double h[NQ], gamma[NL];
    force(t, q, v, k, h);
    constraint_bias(t, q, v, k, gamma);
    return saddle(t, q, k, h, gamma, vdot, lambda);
}

static int accel(double t, const double *q, const double *v, const double *k, double *vdot)
{
    double lambda[NL];
    return solve(t, q, v, k, vdot, lambda);
}

static int project_velocity(double t, const double *q, const double *k, const double *r, double *dv)
{
    const double h[NQ] = {0.0, 0.0, 0.0};
    double lambda[NL];
    return saddle(t, q, k, h, r, dv, lambda);
}

int pendulum_poses(double t, const double *q, const double *k, double *pose)
{
    (void) t, (void) k;
    for (int i = 0; i < NQ; i++) {
        pose[i] = q[i];
    }
    return 0;
}

static int energy(const double *q, const double *v, const double *k, double *e)
{
    e[0] = 0.5 * (k[MASS] * (v[0] * v[0] + v[1] * v[1]) + k[INERTIA] * v[2] * v[2]);
    e[1] = 0.0;
    e[2] = k[MASS] * k[GRAVITY] * q[1];
    return 0;
}

static int momentum(const double *q, const double *v, const double *k, double *p)
{
    p[0] = k[MASS] * v[0];
    p[1] = k[MASS] * v[1];
    p[2] = k[INERTIA] * v[2] + q[0] * p[1] - q[1] * p[0];
    return 0;
}

static int rates(const double *q, const double *v, const double *k, double *qdot)
{
    (void) q, (void) k;
    for (int i = 0; i < NQ; i++) {
        qdot[i] = v[i];
    }
    return 0;
}

/* ---- forms: the first six rows are those of all three ---- */

static void motion(double t, const double *y, const double *ydot, const double *k, double *F)
{
    const double *lambda = y + 6;
    double h[NQ], G[4];
    force(t, y, y + 3, k, h);
    constraint_jacobian(t, y, k, G);
    for (int i = 0; i < NQ; i++) {
        F[i] = ydot[i] - y[3 + i];
    }
    F[3] = k[MASS] * ydot[3] + h[0] - lambda[0];
    F[4] = k[MASS] * ydot[4] + h[1] - lambda[1];
    F[5] = k[INERTIA] * ydot[5] + h[2] - G[2] * lambda[0] - G[3] * lambda[1];
}

static int residual_index3(double t, const double *y, const double *ydot, const double *k, double *F)
{
    motion(t, y, ydot, k, F);
    return constraints(t, y, k, F + 6);
}

static int residual_index1(double t, const double *y, const double *ydot, const double *k, double *F)
{
    double G[4], gamma[NL];
    motion(t, y, ydot, k, F);
    constraint_jacobian(t, y, k, G);
    constraint_bias(t, y, y + 3, k, gamma);
    F[6] = ydot[3] + G[2] * ydot[5] - gamma[0];
    F[7] = ydot[4] + G[3] * ydot[5] - gamma[1];
    return 0;
}

static int residual_ggl(double t, const double *y, const double *ydot, const double *k, double *F)
{
    const double *mu = y + 8;
    double G[4];
    motion(t, y, ydot, k, F);
    constraint_jacobian(t, y, k, G);
    F[0] += mu[0];
    F[1] += mu[1];
    F[2] += G[2] * mu[0] + G[3] * mu[1];
    constraint_rates(t, y, y + 3, k, F + 6);
    return constraints(t, y, k, F + 8);
}

static void motion_jacobian(int n, const double *y, double cj, const double *k, double *jac)
{
    const double c = k[A] * cos(y[2]), s = k[A] * sin(y[2]), *lambda = y + 6;
    for (int i = 0; i < n * n; i++) {
        jac[i] = 0.0;
    }
    for (int i = 0; i < NQ; i++) {
        jac[i + n * i] = cj;
        jac[i + n * (3 + i)] = -1.0;
    }
    jac[3 + n * 3] = jac[4 + n * 4] = cj * k[MASS];
    jac[5 + n * 5] = cj * k[INERTIA];
    jac[5 + n * 2] = -c * lambda[0] - s * lambda[1];
    jac[3 + n * 6] = jac[4 + n * 7] = -1.0;
    jac[5 + n * 6] = -s;
    jac[5 + n * 7] = c;
}

/* Two rows from `row` on: factor G in the columns from `column` on. */
static void rows_of_G(int n, int row, int column, double factor, const double *y, const double *k, double *jac)
{
    jac[row + n * column] = jac[row + 1 + n * (column + 1)] = factor;
    jac[row + n * (column + 2)] = factor * k[A] * sin(y[2]);
    jac[row + 1 + n * (column + 2)] = -factor * k[A] * cos(y[2]);
}

static int jacobian_index3(double t, const double *y, const double *ydot, double cj, const double *k, double *jac)
{
    (void) t, (void) ydot;
    motion_jacobian(8, y, cj, k, jac);
    rows_of_G(8, 6, 0, 1.0, y, k, jac);
    return 0;
}

static int jacobian_index1(double t, const double *y, const double *ydot, double cj, const double *k, double *jac)
{
    const double c = k[A] * cos(y[2]), s = k[A] * sin(y[2]), phidot = y[5];
    (void) t;
    motion_jacobian(8, y, cj, k, jac);
    rows_of_G(8, 6, 3, cj, y, k, jac);
    jac[6 + 8 * 2] = c * ydot[5] - s * phidot * phidot;
    jac[7 + 8 * 2] = s * ydot[5] + c * phidot * phidot;
    jac[6 + 8 * 5] += 2.0 * c * phidot;
    jac[7 + 8 * 5] += 2.0 * s * phidot;
    return 0;
}

static int jacobian_ggl(double t, const double *y, const double *ydot, double cj, const double *k, double *jac)
{
    const double c = k[A] * cos(y[2]), s = k[A] * sin(y[2]), *mu = y + 8;
    (void) t, (void) ydot;
    motion_jacobian(10, y, cj, k, jac);
    jac[2 + 10 * 2] += c * mu[0] + s * mu[1];
    jac[0 + 10 * 8] = jac[1 + 10 * 9] = 1.0;
    jac[2 + 10 * 8] = s;
    jac[2 + 10 * 9] = -c;
    rows_of_G(10, 6, 3, 1.0, y, k, jac);
    jac[6 + 10 * 2] = c * y[5];
    jac[7 + 10 * 2] = s * y[5];
    rows_of_G(10, 8, 0, 1.0, y, k, jac);
    return 0;
}

/* ---- the descriptor ---- */

static const tisserand_variable TABLE_Q[] = {
    {"x", "m", "", 0.0, 1, TISSERAND_ROLE_TRANSLATION}, {"y", "m", "", -0.5, 1, TISSERAND_ROLE_TRANSLATION}, {"phi", "rad", "", -1.5707963267948966, 1, TISSERAND_ROLE_ROTATION}};
static const tisserand_variable TABLE_V[] = {
    {"x_dot", "m/s", "", 0.0, 1, 0}, {"y_dot", "m/s", "", 0.0, 1, 0}, {"phi_dot", "rad/s", "", 0.0, 1, 0}};
static const tisserand_variable TABLE_P[] = {
    {"a", "m", "", 0.5, 1, 0},      {"m", "kg", "", 2.0, 1, 0}, {"J", "kg m^2", "", 0.125, 1, 0},
    {"g", "m/s^2", "", 9.81, 1, 0}, {"s", "m", "", 0.0, 1, 0},  {"w", "rad/s", "", 3.0, 1, 0}};
static const tisserand_variable TABLE_LAMBDA[] = {{"pivot_1", "N", "", 0.0, 1, 0}, {"pivot_2", "N", "", 0.0, 1, 0}};
static const char *const BODIES[] = {"rod"};

static const tisserand_dae FORMS[] = {
    {"index3", 8, &PATTERN_8, residual_index3, jacobian_index3},
    {"ggl", 10, &PATTERN_10, residual_ggl, jacobian_ggl},
    {"index1", 8, &PATTERN_8, residual_index1, jacobian_index1},
};

static const tisserand_scene SCENE = {
    .nbodies = 1,
    .lambda = TABLE_LAMBDA,
    .bodies = BODIES,
    .pattern = &PATTERN_G,
    .forms = FORMS,
    .nforms = 3,
    .constraints = constraints,
    .constraint_rates = constraint_rates,
    .constraint_jacobian = constraint_jacobian,
    .constraint_bias = constraint_bias,
    .solve = solve,
    .project_velocity = project_velocity,
    .poses = pendulum_poses,
};

static const tisserand_model MODEL = {
    .abi = TISSERAND_ABI,
    .name = "pendulum",
    .hash = "by hand",
    .nq = NQ,
    .nv = NQ,
    .np = NP,
    .nk = NP,
    .nlambda = NL,
    .variables_q = NQ,
    .variables_v = NQ,
    .variables_p = NP,
    .variables_k = NP,
    .nmarkers = 0,
    .nenergy = 3,
    .nmomentum = 3,
    .q = TABLE_Q,
    .v = TABLE_V,
    .p = TABLE_P,
    .k = TABLE_P,
    .mass_pattern = &PATTERN_MASS,
    .jacobian_pattern = &PATTERN_8,
    .defaults = defaults,
    .setup = setup,
    .mass = mass,
    .force = force,
    .mass_force = mass_force,
    .accel = accel,
    .energy = energy,
    .momentum = momentum,
    .rates = rates,
    .residual = residual_index3,
    .jacobian = jacobian_index3,
    .scene = &SCENE,
};

const tisserand_model *pendulum_model(void)
{
    return &MODEL;
}
