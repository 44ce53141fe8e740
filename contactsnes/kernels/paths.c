/* Paths of nodes through some states of a contact, up to four: how far they go, and works on them. */
#include <math.h>
#include <string.h>

#include "kernels.h"

enum { STATES = 4, BLOCK = 256 };

typedef struct { /* nodes of a block where the law acts at some state: displacements by state and component, rest
                    gaps, and for how many nodes each stands */
    long held;
    double at[STATES][MOST * BLOCK], initial[BLOCK], share[BLOCK];
} Acting;

static void gather(long m, long nodes, long count, const double *const known[STATES], const double *initial_gap,
                   const double *weight, double range, long from, long n, Acting *a)
{
    long which[BLOCK];
    a->held = 0;
    for (long k = from; k < from + n; k++) {
        double lowest = known[0][k];
        for (long s = 1; s < count; s++) lowest = known[s][k] < lowest ? known[s][k] : lowest;
        if (lowest + initial_gap[k] >= range || (weight && weight[k] == 0.0)) continue;
        a->initial[a->held] = initial_gap[k];
        a->share[a->held] = weight ? weight[k] : 1.0;
        which[a->held++] = k;
    }
    for (long s = 0; s < count; s++)
        for (long i = 0; i < m; i++)
            for (long h = 0; h < a->held; h++) a->at[s][i * a->held + h] = known[s][i * nodes + which[h]];
}

/* A weighted sum of the states, `apart` one from another. */
CLONES static void between(const Acting *restrict a, long count, long size, const double *restrict weight, long apart,
                           double *restrict out)
{
    for (long h = 0; h < size; h++) out[h] = weight[0] * a->at[0][h];
    for (long s = 1; s < count; s++)
        for (long h = 0; h < size; h++) out[h] += weight[s * apart] * a->at[s][h];
}

CLONES static void add_products(long size, const double *restrict x, const double *restrict y, double *restrict out)
{
    for (long h = 0; h < size; h++) out[h] += x[h] * y[h];
}

CLONES static void add_sums(const Acting *restrict a, const double *restrict done, const double *restrict straight,
                            long i, long m, double *restrict numbers)
{
    double sums[3] = {0};
    for (long h = 0; h < a->held; h++) {
        const double along = straight[i * a->held + h];
        sums[0] += a->share[h] * done[i * a->held + h];
        sums[1] += a->share[h] * along;
        sums[2] += a->share[h] * fabs(along);
    }
    for (long set = 0; set < 3; set++) numbers[set * m + i] += sums[set];
}

/* numbers (3, m): works on nodes by a rule whose first `own` places lie on one curve and whose others on other ones,
   summed over nodes by component, and the sizes of the latter. values, slopes (count, places): as of
   `contact.interface_work`. Where the law acts at no state, nothing is done. */
void works_along(const Law *law, long m, long nodes, long count, const double *first, const double *second,
                 const double *third, const double *fourth, const double *initial_gap, const double *weight,
                 double range, long own, long places, const double *values, const double *slopes, double *numbers)
{
    const double *const known[STATES] = {first, second, third, fourth};
    double gap[MOST * BLOCK], way[MOST * BLOCK], done[2][MOST * BLOCK];
    Acting a;
    memset(numbers, 0, 3 * m * sizeof *numbers);
    for (long from = 0; from < nodes; from += BLOCK) {
        gather(m, nodes, count, known, initial_gap, weight, range, from, nodes - from < BLOCK ? nodes - from : BLOCK,
               &a);
        const long size = m * a.held;
        if (!a.held) continue;
        memset(done, 0, sizeof done);
        for (long p = 0; p < places; p++) {
            between(&a, count, size, values + p, places, gap);
            between(&a, count, size, slopes + p, places, way);
            for (long h = 0; h < a.held; h++) gap[h] += a.initial[h];
            evaluate(law, m, a.held, gap, gap, 0);
            add_products(size, gap, way, done[p >= own]);
        }
        for (long i = 0; i < m; i++) add_sums(&a, done[0], done[1], i, m, numbers);
    }
}

CLONES static double squared(long n, const double *restrict x, const double *restrict y, const double *restrict weight)
{
    double sum = 0.0;
    if (weight)
        for (long k = 0; k < n; k++) sum += weight[k] * (y[k] - x[k]) * (y[k] - x[k]);
    else
        for (long k = 0; k < n; k++) sum += (y[k] - x[k]) * (y[k] - x[k]);
    return sum;
}

/* numbers (count - 1): squares of the ways from state to state, summed over nodes and components. */
void squares_along(long m, long nodes, long count, const double *first, const double *second, const double *third,
                   const double *fourth, const double *weight, double *numbers)
{
    const double *const known[STATES] = {first, second, third, fourth};
    for (long s = 0; s + 1 < count; s++) {
        numbers[s] = 0.0;
        for (long i = 0; i < m; i++)
            numbers[s] += squared(nodes, known[s] + i * nodes, known[s + 1] + i * nodes, weight);
    }
}
