/* What is asked of states between two solves: cubic splines of the predictor (grid/splines.py), and
   what nodes release on the straight way of a step (contact/acceptance.py). */
#include "kernels.h"
#include <math.h>
#include <string.h>

#define POLE (sqrt(3.0) - 2.0) /* of the cubic spline's filter */

#define INLINE static inline __attribute__((always_inline))

INLINE void to_coefficients(double *restrict c, long count, long wide)
{
    const double z = POLE, gain = (1.0 - z) * (1.0 - 1.0 / z);
    const long reach = 30 < count ? 30 : count; /* z^30 is below rounding */
    double power = z;
    for (long k = 0; k < count * wide; k++) c[k] *= gain;
    if (count > 30)
        for (long n = 1; n < reach; n++, power *= z)
            for (long i = 0; i < wide; i++) c[i] += power * c[n * wide + i];
    else { /* the mirror image goes on for ever: a geometric series of periods */
        double back = pow(z, (double)(2 * count - 3)), period = pow(z, (double)(2 * count - 2));
        for (long n = 1; n < count; n++, power *= z, back /= z)
            for (long i = 0; i < wide; i++)
                c[i] += (power + (n < count - 1 ? back : 0.0)) * c[n * wide + i];
        for (long i = 0; i < wide; i++) c[i] /= 1.0 - period;
    }
    for (long n = 1; n < count; n++)
        for (long i = 0; i < wide; i++) c[n * wide + i] += z * c[(n - 1) * wide + i];
    double *restrict last = c + (count - 1) * wide;
    for (long i = 0; i < wide; i++)
        last[i] = (z * (count > 1 ? last[i - wide] : last[i]) + last[i]) * z / (z * z - 1.0);
    for (long n = count - 2; n >= 0; n--)
        for (long i = 0; i < wide; i++)
            c[n * wide + i] = z * (c[(n + 1) * wide + i] - c[n * wide + i]);
}

enum { LINES = 8, SIDE = 32 }; /* whose recursions run side by side; the same of a plane */

/* Coefficients of the splines through `count` rows of `wide` numbers, in place; mirrored at the ends.
   Few numbers are faster where the compiler knows how many. */
CLONES static void coefficients(double *restrict c, long count, long wide)
{
    if (wide == 1) to_coefficients(c, count, 1);
    else if (wide == 2) to_coefficients(c, count, 2);
    else if (wide == SIDE) to_coefficients(c, count, SIDE);
    else to_coefficients(c, count, wide);
}

/* The same of LINES lines of `count` numbers, one after the other in memory. */
CLONES static void filter_lines(double *restrict c, long count, double *restrict turned)
{
    for (long l = 0; l < LINES; l++)
        for (long n = 0; n < count; n++) turned[n * LINES + l] = c[l * count + n];
    coefficients(turned, count, LINES);
    for (long l = 0; l < LINES; l++)
        for (long n = 0; n < count; n++) c[l * count + n] = turned[n * LINES + l];
}

enum { AT_ONCE = 128 }; /* places whose weights are found side by side */

INLINE void interpolate(long outer, long count, long wide, const double *values, long wanted,
                        const double *restrict places, double *out)
{
    double weight[4][AT_ONCE];
    int node[4][AT_ONCE]; /* mirrored at the ends */
    const double end = (double)(count - 1);
    const int last = (int)count - 2;
    for (long from = 0; from < wanted; from += AT_ONCE) {
        const long n = wanted - from < AT_ONCE ? wanted - from : AT_ONCE;
        for (long p = 0; p < n; p++) {
            const double low = places[from + p] > 0.0 ? places[from + p] : 0.0;
            const double place = low < end ? low : end;
            const int whole = (int)place, first = whole < last ? whole : last;
            const double t = place - (double)first, left = 1.0 - t, square = t * t;
            weight[0][p] = left * left * left / 6.0;
            weight[1][p] = (4.0 + square * (3.0 * t - 6.0)) / 6.0;
            weight[2][p] = (1.0 + 3.0 * t * (1.0 + t - square)) / 6.0;
            weight[3][p] = square * t / 6.0;
            node[0][p] = first > 0 ? first - 1 : 1;
            node[1][p] = first;
            node[2][p] = first + 1;
            node[3][p] = first < last ? first + 2 : last;
        }
        for (long o = 0; o < outer; o++) {
            const double *restrict rows = values + o * count * wide;
            double *restrict x = out + (o * wanted + from) * wide;
            for (long p = 0; p < n; p++)
                for (long i = 0; i < wide; i++)
                    x[p * wide + i] = weight[0][p] * rows[node[0][p] * wide + i]
                        + weight[1][p] * rows[node[1][p] * wide + i]
                        + weight[2][p] * rows[node[2][p] * wide + i]
                        + weight[3][p] * rows[node[3][p] * wide + i];
        }
    }
}

/* out (outer, wanted, wide) = cubic splines through values (outer, count, wide), count at least 2, at
   places along the axis in the middle, in nodes (those beyond the ends are theirs); values become
   coefficients. */
CLONES void spline(long outer, long count, long wide, double *values, long wanted,
                   const double *restrict places, double *restrict turned, double *out)
{
    long o = 0;
    for (; wide == 1 && o + LINES <= outer; o += LINES) filter_lines(values + o * count, count, turned);
    for (; o < outer; o++) coefficients(values + o * count * wide, count, wide);
    if (wide == 1) interpolate(outer, count, 1, values, wanted, places, out);
    else if (wide == 2) interpolate(outer, count, 2, values, wanted, places, out);
    else interpolate(outer, count, wide, values, wanted, places, out);
}

/* out: where nodes from `start` on were before `places` were moved from here to there, less `begin`. */
void sources(long start, long count, long places, const double *here, const double *there, long begin,
             double *out)
{
    const double slope = (here[places - 1] - here[0]) / (there[places - 1] - there[0]);
    double steep = (here[1] - here[0]) / (there[1] - there[0]);
    for (long k = 0, piece = 1; k < count; k++) {
        const double node = (double)(start + k);
        while (piece < places - 1 && node > there[piece]) {
            piece++;
            steep = (here[piece] - here[piece - 1]) / (there[piece] - there[piece - 1]);
        }
        const double from = node < there[0] ? there[0] : node;
        const double at = from > there[places - 1] ? there[places - 1] : from;
        out[k] = here[piece - 1] + steep * (at - there[piece - 1]) - (double)begin + slope * (node - at);
    }
}

enum { SUPPORT = 12 }; /* as of contact/edges.py */

typedef struct { /* a line of `states` that is known from its middle outwards */
    int half, extent, closed, begin; /* nodes; begin: its first one from that of the last line */
} Spread;

/* out (wanted, components) = fields of a line that are known from its middle outwards, the initial gap added
   to the first, at nodes from `start` on whose `places` were moved (`sources`); signs: whether fields are even
   (1) or odd (-1). Where more is asked for than the line's extent, which may be closed, it is known by its
   nearest node as far as a `wide` line reaches, whose gap is `beyond`. What is returned is not 0 where nothing
   is asked for. work: 4 (extent + wanted) numbers, of the longer line. */
CLONES static int moved(long components, const Spread *s, const double *restrict fields,
                        const double *restrict gap, const Spread *wide, const double *restrict beyond,
                        const int *signs, long start, long wanted, long places, const double *here,
                        const double *there, double *work, double *out)
{
    double *at = work, *values = work + wanted;
    const long middle = s->extent / 2, ends = s->extent - 1 - middle;
    if (!wanted) return 1;
    sources(start, wanted, places, here, there, s->begin, at);
    long low = (long)at[0] - SUPPORT, high = (long)at[wanted - 1] + SUPPORT + 2, first = 0, last = s->extent;
    if (!s->closed && (low < 0 || high > last)) {
        gap = beyond;
        first = middle - wide->extent / 2;
        last = first + wide->extent;
    }
    low = low < first ? first : low;
    high = high > last ? last : high;
    const long count = high - low;
    if (count < 2) return 1;
    for (long i = 0; i < components; i++)
        for (long k = 0; k < count; k++) {
            const long away = low + k - middle, node = away < 0 ? -away : away;
            const long near = away < 0 ? middle : ends;
            const double value = fields[i * s->half + (node < near ? node : near)];
            /* what is odd vanishes in the middle, and where the cell closes on itself */
            const double whole = signs[i] > 0 || away > 0 ? value
                : away == 0 || (s->closed && node == s->half - 1) ? 0.0 : -value;
            values[k * components + i] = i ? whole : whole + gap[node];
        }
    for (long k = 0; k < wanted; k++) at[k] -= (double)low;
    spline(1, count, components, values, wanted, at, 0, out);
    return 0;
}

/* out (components, nodes) = weighted sum of displacements of lines whose `places` are moved from `here`
   (lines, places) to `there`, as far as the law acts on the last one, two nodes more; at fixed places
   beyond. known: displacements at the last one's nodes; fields, gaps: those at each one's own. spread, gaps:
   of these lines, and of a wider one (`moved`). What it returns is not 0 where the law acts nowhere. work: 4
   (the largest extent + nodes) + 2 components nodes. */
CLONES int followed(long components, long nodes, long lines, const double *const *known,
                    const double *const *fields, const double *const *gaps, const Spread *spread,
                    const int *signs, double range, const double *weights, long places, const double *here,
                    const double *there, double *work, double *out)
{
    const long extent = spread[lines - 1].extent;
    const double *restrict last = known[lines - 1], *restrict gap = gaps[lines - 1];
    double *near = work, *one = near + components * nodes, *rest = one + components * nodes;
    double lowest = INFINITY;
    long wanted = 0;
    for (long k = 0; k < nodes; k++) {
        const double g = last[k] + gap[k];
        lowest = g < lowest ? g : lowest;
        if (g < range) wanted = k + 1;
    }
    if (!wanted) return 1;
    wanted = wanted + 2 < extent - extent / 2 ? wanted + 2 : extent - extent / 2;
    for (long l = 0; l < lines; l++) {
        if (moved(components, &spread[l], fields[l], gaps[l], &spread[lines], gaps[lines], signs, extent / 2, wanted,
                  places, here + l * places, there, rest, one))
            return 1;
        for (long k = 0; k < components * wanted; k++)
            near[k] = l ? near[k] + weights[l] * one[k] : weights[l] * one[k];
    }
    for (long i = 0; i < components; i++) {
        double *restrict x = out + i * nodes;
        for (long k = 0; k < nodes; k++) x[k] = weights[0] * known[0][i * nodes + k];
        for (long l = 1; l < lines; l++) {
            const double *restrict field = known[l] + i * nodes;
            for (long k = 0; k < nodes; k++) x[k] += weights[l] * field[k];
        }
        for (long k = 0; k < nodes && i == 0; k++) x[k] += gap[k];
        for (long k = 0; k < wanted; k++) x[k] = near[k * components + i];
        /* an extrapolation into deep overlap would meet the exponential */
        for (long k = 0; k < nodes && i == 0; k++) x[k] = (x[k] < lowest - 1.0 ? lowest - 1.0 : x[k]) - gap[k];
    }
    return 0;
}

typedef struct { /* a plane of `states` that is known from its middle outwards, by direction */
    int half[2], extent[2], closed[2], begin[2]; /* nodes; begin: its first ones from those of the last */
} Sheet;

enum { MORE = 2 * SUPPORT }; /* nodes of a direction that splines take beyond those of a half, at most */

/* By what a field that is even (1) or odd (-1) is multiplied so many nodes `away` from the middle: what is
   odd vanishes there, and where the cell closes on itself. */
static double sign_at(long away, int sign, int closed, long half)
{
    if (sign > 0 || away > 0) return 1.0;
    return away == 0 || (closed && -away == half - 1) ? 0.0 : -1.0;
}

/* values (count, wide) = a field of a plane, and the gap unless null, at nodes from (row, column) on, counted
   from the middle. */
CLONES static void gather_sheet(const Sheet *s, const int *sign, const double *field, const double *gap, long row,
                                long count, long column, long wide, double *values)
{
    const long c = s->half[1];
    for (long j = 0; j < count; j++, values += wide) {
        const long away = row + j, at = (away < 0 ? -away : away) * c;
        const double factor = sign_at(away, sign[0], s->closed[0], s->half[0]);
        const double *restrict from = field + at, *restrict initial = gap ? gap + at : 0;
        long k = 0;
        for (; k < wide && column + k <= 0; k++) {
            const long node = -(column + k);
            values[k] = factor * sign_at(-node, sign[1], s->closed[1], c) * from[node] + (gap ? initial[node] : 0.0);
        }
        if (gap)
            for (; k < wide; k++) values[k] = factor * from[column + k] + initial[column + k];
        else
            for (; k < wide; k++) values[k] = factor * from[column + k];
    }
}

typedef struct { /* of a plane whose places are moved: nodes that are wanted, nodes that they ask for, from so
                    many before the middle on, and where they were from the first of these */
    long wanted[2], count[2], low[2];
    double *at[2];
} Moved;

/* What of a plane is asked for along both directions; not 0 where that is more than is known. */
static int find_moved(const Sheet *s, const int *extent, long places, const double *here, const double *there,
                      Moved *m)
{
    int beyond = 0, unusual = 0;
    for (int axis = 0; axis < 2; axis++) {
        double *at = m->at[axis];
        const long wanted = m->wanted[axis];
        sources(extent[axis] / 2, wanted, places, here + axis * places, there + axis * places, s->begin[axis], at);
        long low = (long)at[0] - SUPPORT, high = (long)at[wanted - 1] + SUPPORT + 2;
        beyond |= low < 0 || high > s->extent[axis];
        low = low < 0 ? 0 : low;
        high = high > s->extent[axis] ? s->extent[axis] : high;
        m->count[axis] = high - low;
        m->low[axis] = low - s->extent[axis] / 2;
        unusual |= high - low < 2 || high - low > s->half[axis] + MORE || m->low[axis] <= -s->half[axis];
        for (long k = 0; k < wanted; k++) at[k] -= (double)low;
    }
    return unusual || (beyond && !(s->closed[0] && s->closed[1]));
}

/* across (wanted rows, count) = a field, and the gap unless null, at the rows where those that are wanted were:
   columns side by side, each lot of them for itself. */
static void move_rows(const Sheet *s, const Moved *m, const int *sign, const double *field, const double *gap,
                      double *lines, double *across)
{
    for (long k = 0; k < m->count[1]; k += SIDE) {
        const long wide = m->count[1] - k < SIDE ? m->count[1] - k : SIDE;
        double *lot = across + k * m->wanted[0];
        gather_sheet(s, sign, field, gap, m->low[0], m->count[0], m->low[1] + k, wide, lines);
        coefficients(lines, m->count[0], wide);
        if (wide == SIDE) interpolate(1, m->count[0], SIDE, lines, m->wanted[0], m->at[0], lot);
        else interpolate(1, m->count[0], wide, lines, m->wanted[0], m->at[0], lot);
    }
}

/* found (wanted columns, SIDE) = what lies across, at the columns where those that are wanted were, of SIDE rows
   from one on, or as many as there are. */
CLONES static void move_columns(const Moved *m, const double *across, long row, double *lines, double *found)
{
    const long rows = m->wanted[0], count = m->count[1], side = rows - row < SIDE ? rows - row : SIDE;
    for (long k = 0; k < count; k += SIDE) {
        const long wide = count - k < SIDE ? count - k : SIDE;
        const double *restrict lot = across + k * rows + row * wide;
        for (long n = 0; n < wide; n++)
            for (long l = 0; l < SIDE; l++) lines[(k + n) * SIDE + l] = l < side ? lot[l * wide + n] : 0.0;
    }
    coefficients(lines, count, SIDE);
    interpolate(1, count, SIDE, lines, m->wanted[1], m->at[1], found);
}

/* The lowest gap of a plane, and the nodes of each direction within which the law acts. */
CLONES static double find_near(const long *shape, const double *displacement, const double *gap, double range,
                               long *wanted)
{
    double lowest = INFINITY;
    wanted[0] = wanted[1] = 0;
    for (long j = 0; j < shape[0]; j++) {
        const double *restrict u = displacement + j * shape[1], *restrict a = gap + j * shape[1];
        double least[LINES], here = INFINITY;
        long k = 0;
        for (long l = 0; l < LINES; l++) least[l] = INFINITY;
        for (; k + LINES <= shape[1]; k += LINES)
            for (long l = 0; l < LINES; l++) {
                const double g = u[k + l] + a[k + l];
                least[l] = g < least[l] ? g : least[l];
            }
        for (; k < shape[1]; k++) here = u[k] + a[k] < here ? u[k] + a[k] : here;
        for (long l = 0; l < LINES; l++) here = least[l] < here ? least[l] : here;
        lowest = here < lowest ? here : lowest;
        if (!(here < range)) continue;
        wanted[0] = j + 1;
        for (k = shape[1]; k > wanted[1]; k--)
            if (u[k - 1] + a[k - 1] < range) wanted[1] = k;
    }
    return lowest;
}

enum { SHEETS = 4 }; /* that are followed, at most */

/* A row of what is followed: near places as they are, in lots of SIDE, others as they are known. */
CLONES static void end_row(long planes, const double *const *known, const double *weights, long n, long at,
                           long wanted, const double *restrict near, const double *restrict gap, double lowest,
                           double *restrict x)
{
    for (long p = 0; p < planes; p++) {
        const double *restrict u = known[p] + at;
        for (long k = wanted; k < n; k++) x[k] = p ? x[k] + weights[p] * u[k] : weights[p] * u[k];
    }
    for (long k = 0; k < wanted; k++) x[k] = near[k * SIDE];
    if (!gap) return;
    for (long k = wanted; k < n; k++) x[k] += gap[k];
    /* an extrapolation into deep overlap would meet the exponential */
    for (long k = 0; k < n; k++) x[k] = (x[k] < lowest - 1.0 ? lowest - 1.0 : x[k]) - gap[k];
}

/* sum = found times a weight, or that and what was there. */
CLONES static void add_found(long n, double weight, int adds, const double *restrict found, double *restrict sum)
{
    if (adds)
        for (long k = 0; k < n; k++) sum[k] += weight * found[k];
    else
        for (long k = 0; k < n; k++) sum[k] = weight * found[k];
}

/* `followed` of planes: out (components, *shape); here (planes, 2, places), there (2, places). work, for each
   plane: shape[0] + shape[1] + shape[0] (half[1] + MORE); besides: SIDE (the largest half + MORE + 2 shape[1]). */
int followed_plane(long components, const long *shape, long planes, const double *const *known,
                   const double *const *fields, const double *const *gaps, const Sheet *sheets, const int *signs,
                   const int *extent, double range, const double *weights, long places, const double *here,
                   const double *there, double *work, double *out)
{
    const double *gap = gaps[planes - 1];
    double *across[SHEETS];
    Moved moved[SHEETS];
    long wanted[2];
    if (planes > SHEETS) return 1;
    const double lowest = find_near(shape, known[planes - 1], gap, range, wanted);
    if (!wanted[0]) return 1;
    for (int axis = 0; axis < 2; axis++) {
        const long most = extent[axis] - extent[axis] / 2, more = wanted[axis] + 2;
        wanted[axis] = more < most ? more : most;
    }
    for (long p = 0; p < planes; p++) {
        moved[p] = (Moved){.wanted = {wanted[0], wanted[1]}, .at = {work, work + shape[0]}};
        if (find_moved(&sheets[p], extent, places, here + 2 * p * places, there, &moved[p])) return 1;
        across[p] = work + shape[0] + shape[1];
        work = across[p] + wanted[0] * moved[p].count[1];
    }
    double *found = work, *sum = found + SIDE * wanted[1], *lines = sum + SIDE * wanted[1];
    for (long i = 0; i < components; i++) {
        for (long p = 0; p < planes; p++)
            move_rows(&sheets[p], &moved[p], signs + 2 * i, fields[p] + i * sheets[p].half[0] * sheets[p].half[1],
                      i ? 0 : gaps[p], lines, across[p]);
        for (long j = 0; j < shape[0]; j++) {
            const long at = (i * shape[0] + j) * shape[1], beside = j < wanted[0] ? wanted[1] : 0;
            for (long p = 0; p < planes && beside && j % SIDE == 0; p++) {
                move_columns(&moved[p], across[p], j, lines, found);
                add_found(SIDE * wanted[1], weights[p], p > 0, found, sum);
            }
            end_row(planes, known, weights, shape[1], at, beside, sum + j % SIDE, i ? 0 : gap + j * shape[1], lowest,
                    out + at);
        }
    }
    return 0;
}

enum { SOME = 256, FEW = 16 }; /* nodes at a time, places at most */

/* Adds what some nodes release on their way, and what linear springs do, of one component. */
CLONES static void add_works(long n, long count, const double *restrict way, double part,
                             const double *const *traction, const double *restrict shares, double trifle,
                             double *restrict released, double *restrict springs)
{
    double sum[SOME];
    for (long k = 0; k < n; k++) sum[k] = 0.0;
    for (long p = 0; p < count; p++)
        for (long k = 0; k < n; k++) sum[k] += shares[p] * traction[p][k];
    for (long k = 0; k < n; k++) {
        const double weighted = part * way[k], change = fabs(traction[1][k] - traction[0][k]);
        released[k] += sum[k] * weighted;
        springs[k] += (change > trifle ? change : trifle) * fabs(weighted);
    }
}

/* works (2, nodes): what each node releases on the straight way from gap by change (components, nodes),
   and what linear springs do, by a quadrature: shares of the tractions at places, the first two of
   which are the ends. `parts`: weights of the components. */
CLONES void works(const Law *law, long components, long nodes, const double *gap, const double *change,
                  const double *parts, long count, const double *places, const double *shares, double trifle,
                  double *found)
{
    double at[MOST * SOME], traction[FEW][MOST * SOME];
    memset(found, 0, 2 * nodes * sizeof *found);
    for (long from = 0; from < nodes; from += SOME) {
        const long n = nodes - from < SOME ? nodes - from : SOME;
        for (long p = 0; p < count; p++) {
            for (long i = 0; i < components; i++)
                for (long k = 0; k < n; k++)
                    at[i * n + k] = gap[i * nodes + from + k]
                        + places[p] * change[i * nodes + from + k];
            evaluate(law, components, n, at, traction[p], 0);
        }
        for (long i = 0; i < components; i++) {
            const double *of[FEW];
            for (long p = 0; p < count; p++) of[p] = traction[p] + i * n;
            add_works(n, count, change + i * nodes + from, parts[i], of, shares, trifle, found + from,
                      found + nodes + from);
        }
    }
}
