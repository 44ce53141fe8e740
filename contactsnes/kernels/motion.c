/* Damped motion of the force form (solvers/motion.py): m mu v'' = -F(v), F = K v + t, on the waves
   of the cell or of even fields. */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { PART = 256 }; /* nodes that are asked of the law at a time */

/* Gaps from what stands in the transform, tractions in its place; the closest gap, the number of
   nodes within the law's range, and the steepest tangent in overlap: its largest row sum.
   Where no node of a part is within the range the law counts as zero. */
CLONES static double tractions(Motion *m)
{
    const long n = m->nodes, c = m->components;
    double *restrict t = m->transform->real, *restrict a = m->gap, steepest = 0.0;
    double gap[MOST * PART], traction[MOST * PART], tangent[MOST * MOST * PART];
    m->closest = HUGE_VAL;
    m->within = 0.0;
    for (long at = 0; at < n; at += PART) {
        const long l = n - at < PART ? n - at : PART;
        for (long k = at; k < at + l; k++) a[k] = t[k] + m->initial_gap[k];
        for (long i = 1; i < c; i++) memcpy(a + i * n + at, t + i * n + at, l * sizeof *t);
        double closest = a[at];
        for (long k = at; k < at + l; k++) closest = a[k] < closest ? a[k] : closest;
        if (closest < m->closest) m->closest = closest;
        if (closest >= m->range) { /* which no gap that is not a number is */
            for (long i = 0; i < c; i++) memset(t + i * n + at, 0, l * sizeof *t);
            continue;
        }
        for (long k = at; k < at + l; k++)
            m->within += a[k] < m->range ? m->node_weight ? m->node_weight[k] : 1.0 : 0.0;
        for (long i = 0; i < c; i++) memcpy(gap + i * l, a + i * n + at, l * sizeof *t);
        evaluate(m->law, c, l, gap, traction, closest < m->harmless ? tangent : 0);
        for (long i = 0; i < c; i++) memcpy(t + i * n + at, traction + i * l, l * sizeof *t);
        for (long k = 0; k < l && closest < m->harmless; k++)
            for (long i = 0; i < c && gap[k] < m->harmless; i++) {
                double sum = 0.0;
                for (long j = 0; j < c; j++) sum += fabs(tangent[(i * c + j) * l + k]);
                steepest = sum > steepest ? sum : steepest;
            }
    }
    return steepest;
}

/* x = t + s y for spectra, by a real symbol */
CLONES static void add(double *restrict x, const double *restrict t, const double *restrict s,
                       const double *restrict y, long n, long wide)
{
    if (wide == 1)
        for (long k = 0; k < n; k++) x[k] = t[k] + s[k] * y[k];
    else
        for (long k = 0; k < n; k++) {
            x[2 * k] = t[2 * k] + s[k] * y[2 * k];
            x[2 * k + 1] = t[2 * k + 1] + s[k] * y[2 * k + 1];
        }
}

/* F = K v + t, the mean's row by its own balance */
static void balance(Motion *m)
{
    const long n = m->waves, w = m->wide;
    const double *t = m->transform->spectrum;
    for (long i = 0; i < m->components; i++) {
        double *force = m->force + i * n * w;
        add(force, t + i * n * w, m->stiffness[i][i], m->displacement + i * n * w, n, w);
        for (long j = 0; j < m->components; j++)
            if (j != i && m->stiffness[i][j])
                add_times(force, m->stiffness[i][j], m->displacement + j * n * w, n,
                          m->is_complex[i][j], 1.0);
        force[0] = m->mean_stiffness[i] * m->displacement[i * n * w] - m->target[i]
                   + (m->mobile[i] ? t[i * n * w] : 0.0);
        if (w > 1) force[1] = 0.0;
    }
}

CLONES static void accelerate(Motion *m)
{
    const long n = m->waves * m->components;
    const double *restrict f = m->force, *restrict b = m->mobility, factor = -1.0 / m->stiffening;
    double *restrict a = m->acceleration;
    if (m->wide == 1)
        for (long k = 0; k < n; k++) a[k] = f[k] * b[k] * factor;
    else
        for (long k = 0; k < n; k++) {
            a[2 * k] = f[2 * k] * b[k] * factor;
            a[2 * k + 1] = f[2 * k + 1] * b[k] * factor;
        }
}

CLONES static void scale(double *x, const double *y, double factor, long n)
{
    for (long k = 0; k < n; k++) x[k] = y[k] * factor;
}

/* Gap, force and acceleration at the displacement. */
int motion_evaluate(Motion *m)
{
    Transform *t = m->transform;
    const long n = m->components * m->waves * m->wide;
    int status;
    scale(t->spectrum, m->displacement, 1.0 / m->size, n);
    if ((status = backward(t, t->shape[0]))) return status;
    const double excess = tractions(m) - m->reference;
    const double stiffening = excess > 0.0 ? 1.0 + excess / m->lightest : 1.0;
    if ((status = forward(t, t->shape[0]))) return status;
    balance(m);
    if (stiffening > m->stiffening)
        scale(m->velocity, m->velocity, sqrt(m->stiffening / stiffening), n);
    m->stiffening = stiffening;
    accelerate(m);
    return 0;
}

/* v += time v' */
CLONES void motion_move(Motion *m, double time)
{
    const long n = m->components * m->waves * m->wide;
    double *restrict v = m->displacement;
    const double *restrict rate = m->velocity;
    for (long k = 0; k < n; k++) v[k] += rate[k] * time;
}

/* v' = kept v' + impulse v'', v += step v', and the force there; the factors are arrays over the
   waves, or both are the numbers beside them where they are null. */
CLONES int motion_advance(Motion *m, double step, const double *kept, double part,
                          const double *impulse, double push)
{
    const long n = m->components * m->waves;
    double *restrict v = m->displacement, *restrict rate = m->velocity;
    const double *restrict a = m->acceleration;
    if (!kept)
        for (long k = 0; k < n * m->wide; k++) {
            rate[k] = rate[k] * part + a[k] * push;
            v[k] += rate[k] * step;
        }
    else if (m->wide == 1)
        for (long k = 0; k < n; k++) {
            rate[k] = rate[k] * kept[k] + a[k] * impulse[k];
            v[k] += rate[k] * step;
        }
    else
        for (long k = 0; k < n; k++) {
            rate[2 * k] = rate[2 * k] * kept[k] + a[2 * k] * impulse[k];
            rate[2 * k + 1] = rate[2 * k + 1] * kept[k] + a[2 * k + 1] * impulse[k];
            v[2 * k] += rate[2 * k] * step;
            v[2 * k + 1] += rate[2 * k + 1] * step;
        }
    return motion_evaluate(m);
}

/* The same with half the damping of a step at each wave, half = rate graded, central in time. */
CLONES int motion_damped(Motion *m, double step, double rate, const double *graded, double *kept,
                         double *impulse)
{
    const long n = m->components * m->waves;
    for (long k = 0; k < n; k++) {
        const double half = rate * graded[k];
        kept[k] = (1.0 - half) / (1.0 + half);
        impulse[k] = step / (1.0 + half);
    }
    return motion_advance(m, step, kept, 0.0, impulse, 0.0);
}

/* Into found, sums over the waves of the cell: change . v', v' . m mu v' and change . change / (m
   mu) of the change F - before, or of F where that is null. */
CLONES void motion_sums(const Motion *m, const double *before, double *found)
{
    const long n = m->waves, w = m->wide;
    double power = 0.0, kinetic = 0.0, square = 0.0;
    for (long i = 0; i < m->components; i++) {
        const double *restrict mass = m->mass + i * n, *restrict mobility = m->mobility + i * n;
        const double *restrict f = m->force + i * n * w, *restrict rate = m->velocity + i * n * w;
        const double *restrict old = before ? before + i * n * w : 0, *restrict weight = m->weight;
        if (w == 1)
            for (long k = 0; k < n; k++) {
                const double x = f[k] - (old ? old[k] : 0.0), u = rate[k];
                power += weight[k] * x * u;
                kinetic += weight[k] * mass[k] * u * u;
                square += weight[k] * mobility[k] * x * x;
            }
        else
            for (long k = 0; k < n; k++) {
                const double x = f[2 * k] - (old ? old[2 * k] : 0.0), u = rate[2 * k];
                const double y = f[2 * k + 1] - (old ? old[2 * k + 1] : 0.0), v = rate[2 * k + 1];
                power += weight[k] * (x * u + y * v);
                kinetic += weight[k] * mass[k] * (u * u + v * v);
                square += weight[k] * mobility[k] * (x * x + y * y);
            }
    }
    found[0] = power;
    found[1] = m->stiffening * kinetic;
    found[2] = square / m->stiffening;
}

/* Sum over the waves of |C F|^2. */
CLONES double motion_squares(const Motion *m)
{
    const long n = m->waves, w = m->wide;
    const double *restrict weight = m->weight;
    double sum = 0.0;
    for (long i = 0; i < m->components; i++) {
        const double *restrict f = m->force + i * n * w, *restrict s = m->compliance[i][i];
        if (m->work) {
            memset(m->work, 0, n * w * sizeof *f);
            for (long j = 0; j < m->components; j++)
                if (m->compliance[i][j])
                    add_times(m->work, m->compliance[i][j], m->force + j * n * w, n,
                              m->is_complex[i][j], 1.0);
            f = m->work;
            for (long k = 0; k < n; k++)
                sum += weight[k] * (f[2 * k] * f[2 * k] + f[2 * k + 1] * f[2 * k + 1]);
        } else if (w == 1)
            for (long k = 0; k < n; k++) sum += weight[k] * s[k] * s[k] * f[k] * f[k];
        else
            for (long k = 0; k < n; k++) {
                const double square = f[2 * k] * f[2 * k] + f[2 * k + 1] * f[2 * k + 1];
                sum += weight[k] * s[k] * s[k] * square;
            }
    }
    return sum;
}
