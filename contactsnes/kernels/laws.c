#include <math.h>
#define SLIP 0.70710678118654752440
#define TPEAK 0.85776388496070679648
void law_modified_normal(long n, const double *p, const double *a, double *N, double *Na)
{
    (void)p;
    for (long k = 0; k < n; k++) {
        double deep = a[k] < -30.0 ? a[k] + 30.0 : 0.0, b = a[k] - deep, e = exp(-b), s = (1.0 - b) * e;
        N[k] = b * e + s * deep;
        Na[k] = s;
    }
}
void law_modified(long n, const double *p, const double *g, const double *b, double *N, double *S,
                  double *Na, double *Nb, double *Sa, double *Sb)
{
    const double rho = p[0], r = p[1];
    for (long k = 0; k < n; k++) {
        double a = g[k], v = b[k], deep = a < -30.0 ? a + 30.0 : 0.0, c = a - deep, e = exp(-c), slope = (1.0 - c) * e;
        double normal = c * e + slope * deep, q = v * v, x = exp(-q);
        double lost = (1.0 - r) * x, fade = r + lost, dfade = -lost;
        double secant = 2.0 * x, dfr = secant * (1.0 - 2.0 * q), past = v - SLIP;
        double drop = TPEAK * (1.0 - rho) * exp(-past * past);
        int beyond = past > 0.0, over = a <= 0.0;
        double sec2 = beyond ? (TPEAK * rho + drop) / v : secant;
        double dfr2 = beyond ? -2.0 * past * drop : dfr;
        double held = over ? 1.0 : e * (1.0 - deep), dheld = over ? 0.0 : -e;
        fade = over ? 1.0 : fade; dfade = over ? 0.0 : dfade;
        N[k] = normal * fade; Na[k] = slope * fade; Nb[k] = 2.0 * normal * dfade;
        S[k] = sec2 * held; Sa[k] = sec2 * dheld;
        Sb[k] = beyond ? (dfr2 - sec2) / q * held : -4.0 * x * held;
    }
}
