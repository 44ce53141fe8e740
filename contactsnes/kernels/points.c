/* What is asked of points and of the steps between them, in one pass over their nodes: numbers of a
   state (contact/survey.py), and how it lies to its prediction and to the point before it
   (contact/acceptance.py, contact/states.py). Sums count a node by its weight (null: each once). */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { SOME = 256 }; /* nodes at a time */

static double greater(double a, double b)
{
    return a > b ? a : b;
}

/* Softening of the gap and of the slip along its own direction at a node; `tangent` (m, m, n) from it on. */
static double softening(long m, long n, const double *tangent, const double *slip, double size,
                        double normal, double sharp)
{
    double opening = 0.0, weakening = 0.0, slipping = 0.0;
    const double first = tangent[0] * normal * normal;
    if (m == 1) return -first;
    for (long i = 1; i < m; i++) {
        /* (without slip every direction is alike; to one side or the other nothing changes) */
        const double e = m == 2 ? 1.0 : size > 0.0 ? slip[i * n] / size : sqrt(0.5);
        opening += tangent[i * n] * e;
        weakening += tangent[i * m * n] * e;
        for (long j = 1; j < m; j++) {
            const double f = m == 2 ? 1.0 : size > 0.0 ? slip[j * n] / size : sqrt(0.5);
            slipping += e * tangent[(i * m + j) * n] * f;
        }
    }
    slipping *= sharp * sharp;
    const double half = 0.5 * (first - slipping);
    const double root = half * half + opening * weakening * normal * normal * sharp * sharp;
    return root >= 0.0 ? greater(sqrt(root) - 0.5 * (first + slipping), 0.0) : 0.0;
}

CLONES static double weighted_squares(const double *restrict x, const double *restrict weight, long n)
{
    double sum = 0.0;
    if (weight)
        for (long k = 0; k < n; k++) sum += weight[k] * x[k] * x[k];
    else
        for (long k = 0; k < n; k++) sum += x[k] * x[k];
    return sum;
}

/* Numbers of displacements (m, nodes): lowest normal gap, largest slip in contact,
   largest pressure, largest shear traction, steepest softening; nodes in contact, those that stick;
   sums of tractions and of tractions times displacements by component. limits: gap of contact, slip at
   the peak of the friction, Maugis parameters. `traction` (m, nodes) takes the tractions. */
void survey(const Law *law, long m, long nodes, const double *displacement, const double *initial_gap,
            const double *weight, const double *limits, double *numbers, double *traction)
{
    double at[MOST * SOME], t[MOST * SOME], tangent[MOST * MOST * SOME];
    double lowest = INFINITY, slipped = 0.0, pressure = 0.0, shear = 0.0, steepest = 0.0, count = 0.0;
    double sticking = 0.0, sums[2 * MOST] = {0};
    for (long from = 0; from < nodes; from += SOME) {
        const long n = nodes - from < SOME ? nodes - from : SOME;
        for (long i = 0; i < m; i++) {
            const double *restrict u = displacement + i * nodes + from;
            for (long k = 0; k < n; k++) at[i * n + k] = u[k] + (i ? 0.0 : initial_gap[from + k]);
        }
        evaluate(law, m, n, at, t, tangent);
        for (long i = 0; i < m; i++) memcpy(traction + i * nodes + from, t + i * n, n * sizeof *t);
        double part[2 * MOST] = {0};
        for (long k = 0; k < n; k++) {
            const double w = weight ? weight[from + k] : 1.0;
            double slip = 0.0, drag = 0.0;
            for (long i = 1; i < m; i++) {
                slip += at[i * n + k] * at[i * n + k];
                drag += t[i * n + k] * t[i * n + k];
            }
            slip = sqrt(slip);
            lowest = at[k] < lowest || at[k] != at[k] ? at[k] : lowest;
            pressure = greater(-t[k], pressure);
            shear = greater(drag, shear);
            steepest = greater(softening(m, n, tangent + k, at + k, slip, limits[2], limits[3]), steepest);
            if (at[k] < limits[0]) {
                count += w;
                slipped = greater(slip, slipped);
                if (!(slip > limits[1])) sticking += w;
            }
            for (long i = 0; i < m; i++) {
                part[i] += w * t[i * n + k];
                part[m + i] += w * t[i * n + k] * displacement[i * nodes + from + k];
            }
        }
        for (long i = 0; i < 2 * m; i++) sums[i] += part[i];
    }
    const double found[] = {lowest, slipped, pressure, sqrt(shear), steepest, count, sticking};
    memcpy(numbers, found, sizeof found);
    memcpy(numbers + 7, sums, 2 * m * sizeof *sums);
}

/* Of two fields (m, nodes): the largest difference where the law acts on either (normal gap below
   `reach`), how many nodes these are, and the sum of its squares there. */
CLONES void apart(long m, long nodes, const double *first, const double *second, const double *initial_gap,
                  const double *weight, double reach, double *numbers)
{
    double largest = 0.0, count = 0.0, squares = 0.0;
    for (long from = 0; from < nodes; from += SOME) {
        const long n = nodes - from < SOME ? nodes - from : SOME;
        double near[SOME];
        for (long k = from; k < from + n; k++) {
            const double closer = first[k] < second[k] ? first[k] : second[k];
            near[k - from] = closer + initial_gap[k] < reach ? 1.0 : 0.0;
        }
        for (long k = 0; k < n; k++) count += near[k] * (weight ? weight[from + k] : 1.0);
        for (long i = 0; i < m; i++) {
            const double *restrict a = first + i * nodes + from, *restrict b = second + i * nodes + from;
            double part = 0.0;
            for (long k = 0; k < n; k++) {
                const double change = near[k] > 0.0 ? b[k] - a[k] : 0.0;
                largest = greater(fabs(change), largest);
                part += change * change * (weight ? weight[from + k] : 1.0);
            }
            squares += part;
        }
    }
    numbers[0] = largest;
    numbers[1] = count;
    numbers[2] = squares;
}

/* numbers: the largest size of a change (m, nodes), times `root`, over `scale` (m, nodes) where there is
   one, at the nodes that count (1, else 0), and the sum of their squares. */
CLONES void extremes(long m, long nodes, const double *change, double root, const double *counts,
                     const double *scale, const double *weight, double *numbers)
{
    double largest = 0.0, squares = 0.0;
    for (long i = 0; i < m; i++)
        for (long k = 0; k < nodes; k++) {
            const double moved = fabs(change[i * nodes + k] * root) * counts[k];
            const double size = scale ? moved / scale[i * nodes + k] : moved;
            largest = greater(size, largest);
            squares += size * size * (weight ? weight[k] : 1.0);
        }
    numbers[0] = largest;
    numbers[1] = squares;
}

typedef struct { /* as contactsnes/contact/acceptance.py has them, in `_limits` */
    double strays, share, longest, reach, held, open, doubtful, trifle, contact, peak;
} Limits;

/* How far a node may end from its prediction after a way of its own. */
static double allowed(const Limits *l, double way)
{
    return l->strays + l->share * (way < l->longest ? way : l->longest);
}

/* Whether slip sticks somewhere on a straight way between two ends that slide. */
static int through_sticking(long m, long nodes, const double *began, const double *ended, double peak)
{
    double first = 0.0, last = 0.0, along = 0.0, way = 0.0, least = 0.0;
    for (long i = 1; i < m; i++) {
        const double a = began[i * nodes], b = ended[i * nodes];
        first += a * a;
        last += b * b;
        along -= a * (b - a);
        way += (b - a) * (b - a);
    }
    double part = along / greater(way, 1e-300);
    part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
    for (long i = 1; i < m; i++) {
        const double x = began[i * nodes] + part * (ended[i * nodes] - began[i * nodes]);
        least += x * x;
    }
    return first > peak * peak && last > peak * peak && least < peak * peak;
}

/* numbers: farthest beyond what is allowed; largest way where the law acts; nodes held at first, and those
   of them that open; the same of the last ones; nodes in contact that pass through sticking; nodes where the
   law acts at the end or was foretold to, and squares of how far these ended from there; where it acts at
   either end, and squares of the way of these. */
void strays(long m, long nodes, const double *foretold, const double *ended, const double *began,
            const double *initial_gap, const double *weight, const Limits *l, double *numbers)
{
    double beyond = -l->strays, moved = 0.0, sums[9] = {0};
    for (long k = 0; k < nodes; k++) {
        const double w = weight ? weight[k] : 1.0, first = began[k] + initial_gap[k];
        const double last = ended[k] + initial_gap[k];
        const double closest = (foretold[k] < ended[k] ? foretold[k] : ended[k]) + initial_gap[k];
        double way = 0.0, aside = -INFINITY, missed = 0.0, gone = 0.0;
        for (long i = 0; i < m; i++) {
            const double change = fabs(ended[i * nodes + k] - began[i * nodes + k]);
            const double off = closest < l->reach ? fabs(ended[i * nodes + k] - foretold[i * nodes + k]) : 0.0;
            way = greater(change, way);
            aside = greater(off - allowed(l, change), aside);
            missed += off * off;
            gone += change * change;
        }
        beyond = greater(aside, beyond);
        if (closest < l->reach) {
            sums[5] += w;
            sums[6] += w * missed;
        }
        if ((first < last ? first : last) < l->reach) {
            moved = greater(way, moved);
            sums[7] += w;
            sums[8] += w * gone;
        }
        if (first < l->held) {
            sums[0] += w;
            if (last > l->open) sums[1] += w;
        }
        if (last < l->held) {
            sums[2] += w;
            if (first > l->open) sums[3] += w;
        }
        if (m > 1 && first < l->contact && last < l->contact
            && through_sticking(m, nodes, began + k, ended + k, l->peak))
            sums[4] += w;
    }
    numbers[0] = beyond;
    numbers[1] = moved;
    memcpy(numbers + 2, sums, sizeof sums);
}

/* numbers: what nodes release on the straight way of a step over linear springs, and what these do
   (`works`), summed over three sets: those aside of their prediction, those where the law acts, and those
   of them that move by more than half of `moved`. */
void releases(const Law *law, long m, long nodes, const double *foretold, const double *ended,
              const double *began, const double *initial_gap, const double *weight, const double *parts,
              long count, const double *places, const double *shares, const Limits *l, double moved,
              double *numbers)
{
    double gap[MOST * SOME], change[MOST * SOME], found[2 * SOME];
    unsigned char sets[SOME];
    long node[SOME], held = 0;
    memset(numbers, 0, 6 * sizeof *numbers);
    for (long k = 0; k <= nodes; k++) {
        if (k < nodes) {
            const double g = initial_gap[k];
            const double closest = (foretold[k] < ended[k] ? foretold[k] : ended[k]) + g;
            const int near = (began[k] < ended[k] ? began[k] : ended[k]) + g < l->reach;
            double way = 0.0;
            int off = 0;
            for (long i = 0; i < m; i++) {
                const double change = fabs(ended[i * nodes + k] - began[i * nodes + k]);
                way = greater(change, way);
                off |= closest < l->reach && fabs(ended[i * nodes + k] - foretold[i * nodes + k])
                                                 > l->doubtful * allowed(l, change);
            }
            if (near || off) {
                sets[held] = (unsigned char)(off | near << 1 | (near && way > 0.5 * moved) << 2);
                node[held++] = k;
            }
        }
        if (held < SOME && k < nodes) continue;
        for (long i = 0; i < m; i++)
            for (long h = 0; h < held; h++) {
                const double from = began[i * nodes + node[h]];
                gap[i * held + h] = from + (i ? 0.0 : initial_gap[node[h]]);
                change[i * held + h] = ended[i * nodes + node[h]] - from;
            }
        works(law, m, held, gap, change, parts, count, places, shares, l->trifle, found);
        for (long h = 0; h < held; h++)
            for (long set = 0; set < 3; set++)
                if (sets[h] >> set & 1) {
                    const double w = weight ? weight[node[h]] : 1.0;
                    numbers[set] += w * found[h];
                    numbers[3 + set] += w * found[held + h];
                }
        held = 0;
    }
}

/* What the equations say of displacements, and of the means of forced components: the sum of squares of F,
   the largest imbalance at a node where the law acts, ranges, and at how many it does. */
int imbalance(Form *f, const double *displacement, const double *scalars, double reach, double *numbers)
{
    const long n = f->nodes, m = f->components;
    Form plain = *f; /* whose unknowns are the displacements */
    double sum[MOST], mean[MOST], squares = 0.0, largest = 0.0, acting = 0.0;
    plain.root = 1.0;
    plain.scale = plain.unscale = 0;
    begin_residual(&plain, displacement, sum);
    f->evaluations = plain.evaluations;
    if ((f->known = plain.known)) /* at the unknown that they are packed to */
        for (long k = 0; k < m * n; k++)
            f->last[k] = displacement[k] / f->root * (f->scale ? f->scale[k % n] : 1.0);
    int status = convolve(f->response, 0);
    if (status) return status;
    for (long i = 0; i < m; i++) mean[i] = f->far[i] - f->rigid[i] * sum[i] / f->size;
    for (long row = 0; row < f->forced_count; row++) mean[f->forced[row]] = scalars[row];
    assemble(&plain, f->response, mean, 1.0, displacement, f->work);
    for (long i = 0; i < m; i++) squares += weighted_squares(f->work + i * n, f->weight, n);
    for (long k = 0; k < n; k++) {
        if (!(displacement[k] + f->initial_gap[k] < reach)) continue;
        for (long i = 0; i < m; i++) largest = greater(fabs(f->work[i * n + k]), largest);
        acting += 1.0;
    }
    squares /= f->root * f->root;
    for (long row = 0; row < f->forced_count; row++) {
        const double missing = f->row_scale[f->forced[row]] * sum[f->forced[row]] - f->target[f->forced[row]];
        squares += missing * missing;
    }
    numbers[0] = squares;
    numbers[1] = largest;
    numbers[2] = acting;
    return 0;
}

/* Where values on a line cross a level, places in nodes, and 1 (upwards) or -1 there: as
   grid/contours.py; how many there are, `most` of which at most are told. */
long crossings(long count, const double *values, double level, long most, double *places, double *signs)
{
    long found = 0;
    for (long i = 0; i + 1 < count; i++) {
        const int above = values[i] >= level, next = values[i + 1] >= level;
        if (above == next) continue;
        const double left = values[i] - level, right = values[i + 1] - level;
        double place = left / (left - right);
        if (i > 0 && i < count - 2) {
            const double before = values[i - 1] - level, after = values[i + 2] - level;
            const double rise = (2 * left - right - before) / 2, fall = (2 * right - left - after) / 2;
            const double twist = (fall - rise) / 3, chord = right - left;
            double low = 0.0, high = 1.0;
            for (int turn = 0; turn < 60; turn++) {
                const double rest = rise + twist + twist * place, room = place * (1 - place);
                const double value = left + place * chord + room * rest;
                if (value == 0.0) break;
                if ((value < 0.0) == (left < 0.0)) low = place;
                else high = place;
                const double slope = chord + (1 - 2 * place) * rest + room * twist;
                double nearer = slope != 0.0 ? place - value / slope : low;
                if (!(low < nearer && nearer < high)) nearer = 0.5 * (low + high);
                if (fabs(nearer - place) < 1e-15) break;
                place = nearer;
            }
        }
        if (found < most) {
            places[found] = (double)i + place;
            signs[found] = next ? 1.0 : -1.0;
        }
        found++;
    }
    return found;
}

enum { REACH = 4 }; /* of the eighth difference */

enum { LANES = 8, CHUNK = 64 };

static const double DIFFERENCE[] = {70.0, -56.0, 28.0, -8.0, 1.0};

/* The largest size of sums of nine numbers each, times factors, of n that stand in rows. */
CLONES static double largest_sum(const double *const *rows, const double *factors, long n)
{
    double most[LANES] = {0}, found = 0.0;
    for (long from = 0; from < n; from += CHUNK) {
        const long count = n - from < CHUNK ? n - from : CHUNK;
        double sum[CHUNK] = {0};
        for (long d = 0; d < 2 * REACH + 1; d++) {
            const double *restrict row = rows[d] + from;
            for (long i = 0; i < count; i++) sum[i] += factors[d] * row[i];
        }
        for (long i = 0; i < CHUNK; i += LANES)
            for (int l = 0; l < LANES; l++) most[l] = fabs(sum[i + l]) > most[l] ? fabs(sum[i + l]) : most[l];
    }
    for (int l = 0; l < LANES; l++) found = most[l] > found ? most[l] : found;
    return found;
}

/* Largest eighth difference, over 256, along the middle axis of values (outer, count, wide) and beyond its
   ends: nothing is there, or the axis is closed, or values begin at the middle of a field that is even
   (`image` 1) or odd (-1), and `closed` is whether they end at its image, too. Of so many at either end that
   are known `beyond` it is not asked. */
double alternation(long outer, long count, long wide, const double *values, int image, int closed,
                   long beyond)
{
    const long period = image ? 2 * (count - 1) : count;
    const long inside = wide == 1 && !beyond && count > 2 * REACH ? count - 2 * REACH : 0; /* of lines, in one go */
    const double *rows[2 * REACH + 1];
    double largest = 0.0, factors[2 * REACH + 1];
    for (long o = 0; o < outer; o++)
        for (long k = beyond; k < count - beyond; k++) {
            const int whole = inside && k == REACH;
            for (long d = -REACH; d <= REACH; d++) {
                long at = k + d;
                double factor = DIFFERENCE[d < 0 ? -d : d] / 256.0;
                if (closed && (at < 0 || at >= period)) at = ((at % period) + period) % period;
                if (image && (at < 0 || (closed && at >= count))) {
                    at = at < 0 ? -at : period - at;
                    factor *= image;
                }
                factors[d + REACH] = at < 0 || at >= count ? 0.0 : factor;
                rows[d + REACH] = values + (o * count + (at < 0 || at >= count ? k : at)) * wide;
            }
            largest = greater(largest_sum(rows, factors, whole ? inside : wide), largest);
            if (whole) k += inside - 1;
        }
    return largest;
}

enum { POINTS = 4 }; /* of a path, at most */

/* Work of forces over displacements (count, m), weighted by component, from point number `first` of a path
   to its last one: polynomials through all, by distance along them, of which a force counts by how much
   gives way to it. points, shares: Gauss and Legendre's rule of as many points, which is exact.
   (Lagrange's polynomials are summed up first: next to each other they make large numbers that cancel.) */
double line_work(long count, long first, long m, const double *displacements, const double *forces,
                 const double *give, const double *weights, const double *points, const double *shares)
{
    double place[POINTS] = {0}, work = 0.0;
    for (long k = 1; k < count; k++) {
        double squares = 0.0;
        for (long i = 0; i < m; i++) {
            const double moved = displacements[k * m + i] - displacements[(k - 1) * m + i];
            const double pushed = give[i] * forces[k * m + i] - give[i] * forces[(k - 1) * m + i];
            squares += moved * moved + pushed * pushed;
        }
        place[k] = place[k - 1] + sqrt(squares);
    }
    const double half = 0.5 * (place[count - 1] - place[first]);
    for (long p = 0; p < count; p++) {
        const double at = place[first] + half * (1.0 + points[p]);
        double force[MOST] = {0}, moving[MOST] = {0};
        for (long j = 0; j < count; j++) {
            double value = 1.0, slope = 0.0;
            for (long other = 0; other < count; other++) {
                if (other == j) continue;
                const double apart = at - place[other], scale = 1.0 / (place[j] - place[other]);
                slope = (slope * apart + value) * scale;
                value *= apart * scale;
            }
            for (long i = 0; i < m; i++) {
                force[i] += value * forces[j * m + i];
                moving[i] += slope * displacements[j * m + i];
            }
        }
        for (long i = 0; i < m; i++) work += half * shares[p] * weights[i] * force[i] * moving[i];
    }
    return work;
}
