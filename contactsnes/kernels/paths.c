/* Paths of nodes through some states of a contact, up to four: how far they go, and works on them. */
#include <math.h>
#include <string.h>

#include "kernels.h"

enum { STATES = 4, BLOCK = 256, RULE = 10 }; /* RULE: places through four states and on their chords */

typedef struct { /* nodes of a block where the law acts at some state: displacements by state and component, rest
                    gaps, and for how many nodes each stands */
    long held;
    double at[STATES][MOST * BLOCK], initial[BLOCK], share[BLOCK];
} Acting;

static void gather(long m, long nodes, long count, const double *const *known, const double *initial_gap,
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

typedef struct { /* values of polynomials and slopes by shares, by state and place: the first `own` of these are on
                    one curve, the others on chords */
    long places, own;
    double value[STATES][RULE], slope[STATES][RULE];
} Rule;

/* Adds Lagrange's polynomials through states from number `begin` on, that are at these places, and their slopes by
   shares, from place number `first` on: by Gauss and Legendre's rule of as many points. */
static void add_places(Rule *r, long begin, long count, long first, const double *at, const double *rule)
{
    const double half = 0.5 * (at[count - 1] - at[first]);
    for (long k = 0; k < count; k++, r->places++) {
        double value[STATES], slope[STATES];
        lagrange(count, at, at[first] + half * (1.0 + rule[k]), value, slope);
        for (long j = 0; j < count; j++) {
            r->value[begin + j][r->places] = value[j];
            r->slope[begin + j][r->places] = half * rule[count + k] * slope[j];
        }
    }
}

/* How many of some states are more than a part `twins` of the way from number *first to the last one from each
   other, these two among them; which they are, and how far along the path, by squares of the ways from one to the
   next. *first becomes its number among them. */
static long without_twins(long count, const double *squares, double twins, long *first, long *which, double *at)
{
    const long begin = *first;
    double far[STATES] = {0};
    long kept[STATES] = {count - 1}, many = 1;
    for (long k = 1; k < count; k++) far[k] = far[k - 1] + sqrt(squares[k - 1]);
    for (long k = count - 2; k >= 0; k--)
        if (far[kept[many - 1]] - far[k] > twins * (far[count - 1] - far[begin])) kept[many++] = k;
        else if (k == begin) kept[many - 1] = begin;
    for (long k = 0; k < many; k++) {
        which[k] = kept[many - 1 - k];
        at[k] = far[which[k]];
        if (which[k] == begin) *first = k;
    }
    return many;
}

/* Adds to numbers (3, m) what a rule makes of the tractions on the nodes' ways. */
static void add_works(const Site *site, long m, long count, const double *const *known, const double *weight,
                      const Rule *r, double range, double *numbers)
{
    double gap[MOST * BLOCK], way[MOST * BLOCK], done[2][MOST * BLOCK];
    Acting a;
    for (long from = 0; from < site->nodes; from += BLOCK) {
        const long n = site->nodes - from < BLOCK ? site->nodes - from : BLOCK;
        gather(m, site->nodes, count, known, site->initial_gap, weight, range, from, n, &a);
        const long size = m * a.held;
        if (!a.held) continue;
        memset(done, 0, sizeof done);
        for (long p = 0; p < r->places; p++) {
            between(&a, count, size, r->value[0] + p, RULE, gap);
            between(&a, count, size, r->slope[0] + p, RULE, way);
            for (long h = 0; h < a.held; h++) gap[h] += a.initial[h];
            evaluate(site->law, m, a.held, gap, gap, 0);
            add_products(size, gap, way, done[p >= r->own]);
        }
        for (long i = 0; i < m; i++) add_sums(&a, done[0], done[1], i, m, numbers);
    }
}

/* numbers (3, m): works from state number `first` of a path to its last one, summed over nodes by component: along
   the polynomials through those that are apart, along the chords between them, and the sizes of the latter, as
   contact/interface_work.py has them. squares: of ways from state to state, of all nodes of all windows; weight:
   null: the nodes' own; rules: Gauss and Legendre's, of two points on. Where the law acts at no state, nothing is
   done. */
void works_along(const Site *site, long m, long count, const double *const *known, const double *weight,
                 const double *squares, long first, double twins, const double *rules, double range, double *numbers)
{
    const double ends[] = {0.0, 1.0}, *some[STATES];
    double at[STATES];
    long which[STATES];
    Rule r = {0};
    memset(numbers, 0, 3 * m * sizeof *numbers);
    count = without_twins(count, squares, twins, &first, which, at);
    if (at[count - 1] == at[first]) return;
    for (long k = 0; k < count; k++) some[k] = known[which[k]];
    add_places(&r, 0, count, first, at, rule_of(count, rules));
    r.own = r.places;
    for (long k = first; k + 1 < count; k++) add_places(&r, k, 2, 0, ends, rules);
    add_works(site, m, count, some, weight ? weight : site->weight, &r, range, numbers);
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
void squares_along(const Site *site, long m, long count, const double *const *known, double *numbers)
{
    const long nodes = site->nodes;
    for (long s = 0; s + 1 < count; s++) {
        numbers[s] = 0.0;
        for (long i = 0; i < m; i++)
            numbers[s] += squared(nodes, known[s] + i * nodes, known[s + 1] + i * nodes, site->weight);
    }
}
