/*
 * The yardstick: M and h of the free planar beam with two shapes, (33) and (41), written by hand for speed.
 *
 * Both write what the generated code writes: the lower triangle of M by columns, without structural zeros, and all of
 * h. All that depends on the parameters alone is done in setup. The state is q = [c1 c2 phi a1 a2], v its rate.
 * The functions ending in _once write only what changes with the state; _setup_once wrote the rest: this is less work
 * than a stateless function can do, and a figure for the cost of being stateless.
 */

#include <math.h>

#define RESTRICT __restrict

/* k of the mean frame */
enum { MASS, ROTARY, C1, C2, K1, K2 };

void hand_mean_setup(const double *RESTRICT p, double *RESTRICT k)
{
    const double mass = p[0], l = p[1], stiffness = p[2] / (l * l * l);
    k[MASS] = mass;
    k[ROTARY] = mass * l * l / 12.0;
    k[C1] = mass / 5.0;
    k[C2] = mass / 7.0;
    k[K1] = 144.0 * stiffness;
    k[K2] = 1200.0 * stiffness;
}

void hand_mean(const double *RESTRICT q, const double *RESTRICT v, const double *RESTRICT k,
               double *RESTRICT M, double *RESTRICT h)
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

void hand_mean_setup_once(const double *RESTRICT k, double *RESTRICT M, double *RESTRICT h)
{
    M[0] = k[MASS];
    M[1] = k[MASS];
    M[3] = k[C1];
    M[4] = k[C2];
    h[0] = 0.0;
    h[1] = 0.0;
}

void hand_mean_once(const double *RESTRICT q, const double *RESTRICT v, const double *RESTRICT k,
                    double *RESTRICT M, double *RESTRICT h)
{
    const double a1 = q[3], a2 = q[4], w = v[2], ww = w * w;
    const double c1a1 = k[C1] * a1, c2a2 = k[C2] * a2;
    M[2] = k[ROTARY] + c1a1 * a1 + c2a2 * a2;
    h[2] = 2.0 * w * (c1a1 * v[3] + c2a2 * v[4]);
    h[3] = k[K1] * a1 - ww * c1a1;
    h[4] = k[K2] * a2 - ww * c2a2;
}

/* k of the point frame: those of the mean frame, then the couplings */
enum { D = 6, E };

void hand_point_setup(const double *RESTRICT p, double *RESTRICT k)
{
    const double mass = p[0], l = p[1], stiffness = p[2] / (l * l * l);
    hand_mean_setup(p, k);
    k[K1] = 64.0 * stiffness;
    k[K2] = 192.0 * stiffness;
    k[D] = mass / 3.0;
    k[E] = mass * l / 10.0;
}

/*
 * What does not need the sine and the cosine comes first, so that little is alive across the call; the rows of the
 * translation then need only entries of M: h1 = ww M[c1, phi] + 2 w a1dot M[c1, a1], likewise h0 with M[c2, .].
 */
void hand_point(const double *RESTRICT q, const double *RESTRICT v, const double *RESTRICT k,
                double *RESTRICT M, double *RESTRICT h)
{
    const double a1 = q[3], a2 = q[4], w = v[2], ww = w * w, w2 = w + w, coriolis = w2 * v[3];
    const double c1a1 = k[C1] * a1, c2a2 = k[C2] * a2, d = k[D];
    M[0] = k[MASS];
    M[3] = k[MASS];
    M[6] = k[ROTARY] + c1a1 * a1 + c2a2 * a2;
    M[7] = k[E];
    M[8] = k[C1];
    M[9] = k[C2];
    h[2] = w2 * (c1a1 * v[3] + c2a2 * v[4]);
    h[3] = k[K1] * a1 - ww * c1a1;
    h[4] = k[K2] * a2 - ww * c2a2;

    const double phi = q[2];
    const double dc = d * cos(phi), ds = d * sin(phi);
    const double a1dc = a1 * dc, a1ds = a1 * ds;
    M[1] = -a1dc;
    M[2] = -ds;
    M[4] = -a1ds;
    M[5] = dc;
    h[0] = ww * a1ds - coriolis * dc;
    h[1] = -ww * a1dc - coriolis * ds;
}
