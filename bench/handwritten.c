/*
 * Reference for the benchmarks: M and h of the free planar beam with two shapes, (33) and (41), written by hand.
 *
 * The functions write the same values as the generated code: the lower triangle of M by columns, without structural
 * zeros, and h. setup computes everything that depends on the parameters alone. q = [c1 c2 phi a1 a2], v = qdot.
 * There are two versions for each frame: careful code, and code tuned (_tuned) to the machine code of gcc 12.
 */

#include <math.h>

#define IN const double *__restrict
#define OUT double *__restrict

/* k of the mean frame; that of the point frame has three more elements */
enum { MASS, ROTARY, C1, C2, K1, K2, D, MINUS_D, E };

void hand_mean_setup(IN p, OUT k)
{
    const double mass = p[0], l = p[1], stiffness = p[2] / (l * l * l);
    k[MASS] = mass;
    k[ROTARY] = mass * l * l / 12.0;
    k[C1] = mass / 5.0;
    k[C2] = mass / 7.0;
    k[K1] = 144.0 * stiffness;
    k[K2] = 1200.0 * stiffness;
}

void hand_mean(IN q, IN v, IN k, OUT M, OUT h)
{
    const double a1 = q[3], a2 = q[4], w = v[2], ww = w * w;
    const double c1a1 = k[C1] * a1, c2a2 = k[C2] * a2;
    M[0] = k[MASS];
    M[1] = k[MASS];
    M[2] = k[ROTARY] + c1a1 * a1 + c2a2 * a2;
    M[3] = k[C1];
    M[4] = k[C2];
    h[0] = 0.0;
    h[1] = 0.0;
    h[2] = 2.0 * w * (c1a1 * v[3] + c2a2 * v[4]);
    h[3] = k[K1] * a1 - ww * c1a1;
    h[4] = k[K2] * a2 - ww * c2a2;
}

/* The last use of c1a1 is in M[2], where it may be overwritten: this saves a copy of a register. */
void hand_mean_tuned(IN q, IN v, IN k, OUT M, OUT h)
{
    const double a1 = q[3], a2 = q[4], w = v[2], ww = w * w;
    const double c1a1 = k[C1] * a1, c2a2 = k[C2] * a2;
    h[0] = 0.0;
    h[1] = 0.0;
    h[2] = 2.0 * w * (c1a1 * v[3] + c2a2 * v[4]);
    h[3] = k[K1] * a1 - ww * c1a1;
    h[4] = k[K2] * a2 - ww * c2a2;
    M[0] = k[MASS];
    M[1] = k[MASS];
    M[2] = k[ROTARY] + c1a1 * a1 + c2a2 * a2;
    M[3] = k[C1];
    M[4] = k[C2];
}

/* Only the entries that depend on the state, for a caller who keeps M and h; shows the cost of the constant ones. */
void hand_mean_once(IN q, IN v, IN k, OUT M, OUT h)
{
    const double a1 = q[3], a2 = q[4], w = v[2], ww = w * w;
    const double c1a1 = k[C1] * a1, c2a2 = k[C2] * a2;
    h[2] = 2.0 * w * (c1a1 * v[3] + c2a2 * v[4]);
    h[3] = k[K1] * a1 - ww * c1a1;
    h[4] = k[K2] * a2 - ww * c2a2;
    M[2] = k[ROTARY] + c1a1 * a1 + c2a2 * a2;
}

void hand_point_setup(IN p, OUT k)
{
    const double mass = p[0], l = p[1], stiffness = p[2] / (l * l * l);
    hand_mean_setup(p, k);
    k[K1] = 64.0 * stiffness;
    k[K2] = 192.0 * stiffness;
    k[D] = mass / 3.0;
    k[MINUS_D] = -k[D];
    k[E] = mass * l / 10.0;
}

/* The rows of the translation need only entries of M: h0 = -ww M[c2, phi] - 2 w a1dot M[c2, a1], likewise h1. */
void hand_point(IN q, IN v, IN k, OUT M, OUT h)
{
    const double phi = q[2], a1 = q[3], a2 = q[4], w = v[2], ww = w * w, w2 = 2.0 * w, coriolis = w2 * v[3];
    const double dc = k[D] * cos(phi), ds = k[D] * sin(phi), a1dc = a1 * dc, a1ds = a1 * ds;
    const double c1a1 = k[C1] * a1, c2a2 = k[C2] * a2;
    M[0] = k[MASS];
    M[1] = -a1dc;
    M[2] = -ds;
    M[3] = k[MASS];
    M[4] = -a1ds;
    M[5] = dc;
    M[6] = k[ROTARY] + c1a1 * a1 + c2a2 * a2;
    M[7] = k[E];
    M[8] = k[C1];
    M[9] = k[C2];
    h[0] = ww * a1ds - coriolis * dc;
    h[1] = -ww * a1dc - coriolis * ds;
    h[2] = w2 * (c1a1 * v[3] + c2a2 * v[4]);
    h[3] = k[K1] * a1 - ww * c1a1;
    h[4] = k[K2] * a2 - ww * c2a2;
}

/*
 * M and h are no restrict pointers and are written in turn, so that the compiler does not gather their entries into
 * vectors of four, which takes more instructions than it saves, and a realigned stack. The sign of d is in setup.
 */
void hand_point_tuned(IN q, IN v, IN k, double *M, double *h)
{
    const double phi = q[2], a1 = q[3], a2 = q[4], w = v[2], v3 = v[3], v4 = v[4], ww = w * w, w2 = 2.0 * w;
    const double mass = k[MASS], rotary = k[ROTARY], c1 = k[C1], c2 = k[C2], k1 = k[K1], k2 = k[K2];
    const double d = k[D], minus_d = k[MINUS_D], e = k[E];
    const double c = cos(phi), s = sin(phi), c1a1 = c1 * a1, c2a2 = c2 * a2;
    h[2] = w2 * (c1a1 * v3 + c2a2 * v4);
    h[3] = k1 * a1 - ww * c1a1;
    h[4] = k2 * a2 - ww * c2a2;
    M[6] = rotary + c1a1 * a1 + c2a2 * a2;
    M[7] = e;
    M[8] = c1;
    M[9] = c2;
    M[0] = mass;
    M[3] = mass;
    const double dc = d * c, ds = minus_d * s, x = -a1 * dc, y = a1 * ds, coriolis = w2 * v3;
    h[0] = -(ww * y + coriolis * dc);
    h[1] = ww * x + coriolis * ds;
    M[1] = x;
    M[2] = ds;
    M[4] = y;
    M[5] = dc;
}
