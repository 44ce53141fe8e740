/* What is asked of points and of the steps between them, in one pass over their nodes: numbers of a
   state (contact/survey.py), and how it lies to its prediction and to the point before it
   (contact/acceptance.py, contact/states.py). Sums count a node by its weight (null: each once). */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { SOME = 256, WIDE = 64, FEW = 8 }; /* nodes at a time, numbers side by side, and places looked for */
enum { STRETCH = 64 }; /* nodes that are passed over together */

static double greater(double a, double b)
{
    return a > b ? a : b;
}

/* The largest of some numbers, unless one is known that is larger: of many side by side, which is what
   compilers make vectors of. */
CLONES double largest_of(double known, const double *restrict x, long n)
{
    double most[WIDE];
    for (long l = 0; l < WIDE; l++) most[l] = known;
    for (long from = 0; from < n; from += WIDE) {
        const long some = n - from < WIDE ? n - from : WIDE;
        for (long l = 0; l < some; l++) most[l] = x[from + l] > most[l] ? x[from + l] : most[l];
    }
    for (long half = WIDE / 2; half; half /= 2)
        for (long l = 0; l < half; l++) most[l] = most[half + l] > most[l] ? most[half + l] : most[l];
    return most[0];
}

/* Softening of the gap and of the slip along its own direction at each of some nodes: of a tangent (m, m, n),
   slips (m, n), whose first are none, and their sizes. */
CLONES static void softening(long m, long n, const double *restrict tangent, const double *restrict slip,
                             const double *restrict size, double normal, double sharp, double *restrict out)
{
    double opening[SOME], weakening[SOME], slipping[SOME];
    for (long k = 0; k < n && m == 1; k++) out[k] = -tangent[k] * normal * normal;
    if (m == 1) return;
    for (long k = 0; k < n; k++) opening[k] = weakening[k] = slipping[k] = 0.0;
    for (long i = 1; i < m; i++)
        for (long k = 0; k < n; k++) {
            /* (without slip every direction is alike; to one side or the other nothing changes) */
            const double e = m == 2 ? 1.0 : size[k] > 0.0 ? slip[i * n + k] / size[k] : sqrt(0.5);
            opening[k] += tangent[i * n + k] * e;
            weakening[k] += tangent[i * m * n + k] * e;
            for (long j = 1; j < m; j++) {
                const double f = m == 2 ? 1.0 : size[k] > 0.0 ? slip[j * n + k] / size[k] : sqrt(0.5);
                slipping[k] += e * tangent[(i * m + j) * n + k] * f;
            }
        }
    for (long k = 0; k < n; k++) {
        const double first = tangent[k] * normal * normal, last = slipping[k] * sharp * sharp;
        const double half = 0.5 * (first - last);
        const double root = half * half + opening[k] * weakening[k] * normal * normal * sharp * sharp;
        const double soft = sqrt(root < 0.0 ? 0.0 : root) - 0.5 * (first + last);
        out[k] = root >= 0.0 && soft > 0.0 ? soft : 0.0;
    }
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

typedef struct { /* of at most SOME nodes: gaps and tractions (m, n), the tangent (m, m, n), sizes of slip and
                    of shear traction, the largest of what is asked of each */
    double gap[MOST * SOME], traction[MOST * SOME], tangent[MOST * MOST * SOME], slip[SOME], drag[SOME];
    double each[SOME];
} Nodes;

/* Sizes of slips and shear tractions. */
CLONES static void find_sizes(long m, long n, Nodes *restrict a)
{
    for (long k = 0; k < n; k++) a->slip[k] = a->drag[k] = 0.0;
    for (long i = 1; i < m; i++)
        for (long k = 0; k < n; k++) {
            a->slip[k] += a->gap[i * n + k] * a->gap[i * n + k];
            a->drag[k] += a->traction[i * n + k] * a->traction[i * n + k];
        }
    for (long k = 0; k < n; k++) {
        a->slip[k] = sqrt(a->slip[k]);
        a->drag[k] = sqrt(a->drag[k]);
    }
}

/* Adds to sums: nodes in contact, those that stick; tractions, and tractions times displacements, by
   component. */
CLONES static void add_sums(const Site *site, long m, long n, const Nodes *restrict a,
                            const double *restrict displacement, const double *restrict weight, double *sums)
{
    const long apart = site->nodes;
    double touching = 0.0, sticking = 0.0;
    for (long k = 0; k < n; k++) {
        const double w = weight ? weight[k] : 1.0;
        touching += a->gap[k] < site->contact ? w : 0.0;
        sticking += a->gap[k] < site->contact && !(a->slip[k] > site->peak) ? w : 0.0;
    }
    sums[0] += touching;
    sums[1] += sticking;
    for (long i = 0; i < m; i++) {
        double total = 0.0, work = 0.0;
        for (long k = 0; k < n; k++) {
            const double t = (weight ? weight[k] : 1.0) * a->traction[i * n + k];
            total += t;
            work += t * displacement[i * apart + k];
        }
        sums[2 + i] += total;
        sums[2 + m + i] += work;
    }
}

static double alternation_of_halves(const Site *site, long m, double *fields);

/* Numbers of displacements (m, nodes): lowest normal gap, largest slip in contact,
   largest pressure, largest shear traction, steepest softening; nodes in contact, those that stick;
   sums of tractions and of tractions times displacements by component; of half a line, how far tractions
   alternate. `traction` (m, nodes) takes the tractions, which are its own then. */
void survey(const Site *site, long m, const double *displacement, double *numbers, double *traction)
{
    const long nodes = site->nodes;
    const double *initial_gap = site->initial_gap, *weight = site->weight;
    Nodes a;
    double deepest = -INFINITY, no_number = 0.0, slipped = 0.0, pressure = 0.0, shear = 0.0, steepest = 0.0;
    double sums[2 + 2 * MOST] = {0};
    memset(a.slip, 0, sizeof a.slip); /* which one component has not */
    for (long from = 0; from < nodes; from += SOME) {
        const long n = nodes - from < SOME ? nodes - from : SOME;
        for (long i = 0; i < m; i++) {
            const double *restrict u = displacement + i * nodes + from;
            for (long k = 0; k < n; k++) a.gap[i * n + k] = u[k] + (i ? 0.0 : initial_gap[from + k]);
        }
        evaluate(site->law, m, n, a.gap, a.traction, a.tangent);
        for (long i = 0; i < m; i++)
            memcpy(traction + i * nodes + from, a.traction + i * n, n * sizeof *traction);
        if (m > 1) find_sizes(m, n, &a);
        softening(m, n, a.tangent, a.gap, a.slip, site->normal, site->sharp, a.each);
        steepest = largest_of(steepest, a.each, n);
        for (long k = 0; k < n; k++) a.each[k] = -a.traction[k];
        pressure = largest_of(pressure, a.each, n);
        if (m > 1) {
            shear = largest_of(shear, a.drag, n);
            for (long k = 0; k < n; k++) a.each[k] = a.gap[k] < site->contact ? a.slip[k] : 0.0;
            slipped = largest_of(slipped, a.each, n);
        }
        for (long k = 0; k < n; k++) {
            a.each[k] = -a.gap[k];
            no_number += a.gap[k] != a.gap[k] ? 1.0 : 0.0;
        }
        deepest = largest_of(deepest, a.each, n);
        add_sums(site, m, n, &a, displacement + from, weight ? weight + from : 0, sums);
    }
    const double found[] = {no_number > 0.0 ? NAN : -deepest, slipped, pressure, shear, steepest};
    memcpy(numbers, found, sizeof found);
    memcpy(numbers + 5, sums, (2 + 2 * m) * sizeof *sums);
    numbers[7 + 2 * m] = site->halved ? alternation_of_halves(site, m, traction) : 0.0;
}

/* Whether the law acts on some of n nodes, normal gaps below `reach`, at one of three displacements. */
CLONES static int acts(long n, const double *restrict one, const double *restrict two,
                       const double *restrict three, const double *restrict initial_gap, double reach)
{
    double count = 0.0;
    for (long k = 0; k < n; k++) {
        const double either = one[k] < two[k] ? one[k] : two[k];
        count += (three[k] < either ? three[k] : either) + initial_gap[k] < reach ? 1.0 : 0.0;
    }
    return count > 0.0;
}

/* The next nodes from *from on, SOME at most, on some of which the law acts at one of three displacements:
   how many, 0 behind the last of them; *from becomes their first. Those where it does not, which are most
   nodes of a rough plane, are not asked for more. */
static long next_acting(long nodes, long *from, const double *one, const double *two, const double *three,
                        const double *initial_gap, double reach)
{
    long n = 0;
    for (long at = *from, many; at < nodes && n < SOME; at += many) {
        many = nodes - at < STRETCH ? nodes - at : STRETCH;
        if (acts(many, one + at, two + at, three + at, initial_gap + at, reach)) {
            *from = n ? *from : at;
            n += many;
        } else if (n) break;
    }
    return n;
}

/* Of two fields (m, nodes): the largest difference where the law acts on either (normal gap below
   `reach`), how many nodes these are, and the sum of its squares there. */
CLONES void apart(long m, long nodes, const double *first, const double *second, const double *initial_gap,
                  const double *weight, double reach, double *numbers)
{
    double largest = 0.0, count = 0.0, squares = 0.0;
    for (long from = 0, n; (n = next_acting(nodes, &from, first, second, second, initial_gap, reach));
         from += n) {
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

/* Smallest normal gap. */
double closest(long nodes, const double *displacement, const double *initial_gap)
{
    double depth[SOME], deepest = -INFINITY;
    for (long from = 0; from < nodes; from += SOME) {
        const long n = nodes - from < SOME ? nodes - from : SOME;
        for (long k = 0; k < n; k++) depth[k] = -(displacement[from + k] + initial_gap[from + k]);
        deepest = largest_of(deepest, depth, n);
    }
    return -deepest;
}

/* out = weighted sum of fields (m, nodes), and of changes in single precision, without gaps below `floor`. */
CLONES void combined(long m, long nodes, long count, const double *const *known, const double *weights, long more,
                     const float *const *changes, const double *shares, const double *restrict initial_gap,
                     double floor, double *restrict out)
{
    for (long i = 0; i < m; i++)
        for (long from = 0; from < nodes; from += SOME) {
            const long n = nodes - from < SOME ? nodes - from : SOME, at = i * nodes + from;
            double *restrict sum = out + at;
            double part[SOME];
            for (long k = 0; k < n; k++) part[k] = weights[0] * known[0][at + k];
            for (long j = 1; j < count; j++) {
                const double *restrict x = known[j] + at, w = weights[j];
                for (long k = 0; k < n; k++) part[k] += w * x[k];
            }
            for (long j = 0; j < more; j++) {
                const float *restrict x = changes[j] + at;
                for (long k = 0; k < n; k++) part[k] += shares[j] * x[k];
            }
            for (long k = 0; k < n; k++) {
                const double least = i ? part[k] : floor - initial_gap[from + k];
                sum[k] = part[k] < least ? least : part[k];
            }
        }
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

/* How far a node may end from its prediction after a way of its own. */
static inline double allowed(const Limits *l, double way)
{
    return l->strays + l->share * (way < l->longest ? way : l->longest);
}

typedef struct { /* of at most SOME nodes: normal gaps at first, at last and the closest of the end and its
                    prediction; largest way of a component, and how far one ends beyond a part of what is
                    allowed; sums of squares of both */
    double first[SOME], last[SOME], closest[SOME], way[SOME], aside[SOME], gone[SOME], missed[SOME];
} Ways;

/* The ways of nodes from one on. */
CLONES static void ways(long m, long nodes, long from, long n, const double *foretold, const double *ended,
                        const double *began, const double *restrict initial_gap, const Limits *l, double part,
                        Ways *restrict w)
{
    for (long k = 0; k < n; k++) {
        const double g = initial_gap[from + k], there = ended[from + k], expected = foretold[from + k];
        w->first[k] = began[from + k] + g;
        w->last[k] = there + g;
        w->closest[k] = (expected < there ? expected : there) + g;
        w->way[k] = w->gone[k] = w->missed[k] = 0.0;
        w->aside[k] = -INFINITY;
    }
    for (long i = 0; i < m; i++) {
        const long at = i * nodes + from;
        const double *restrict a = began + at, *restrict b = ended + at, *restrict f = foretold + at;
        for (long k = 0; k < n; k++) {
            const double change = fabs(b[k] - a[k]);
            const double off = w->closest[k] < l->reach ? fabs(b[k] - f[k]) : 0.0;
            const double beyond = off - part * allowed(l, change);
            w->way[k] = change > w->way[k] ? change : w->way[k];
            w->aside[k] = beyond > w->aside[k] ? beyond : w->aside[k];
            w->gone[k] += change * change;
            w->missed[k] += off * off;
        }
    }
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
    if (!(first > peak * peak && last > peak * peak)) return 0;
    double part = along / greater(way, 1e-300);
    part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
    for (long i = 1; i < m; i++) {
        const double x = began[i * nodes] + part * (ended[i * nodes] - began[i * nodes]);
        least += x * x;
    }
    return least < peak * peak;
}

/* Adds to sums of `strays`, from the third on: what nodes count there by their ways. */
CLONES static void count_nodes(const Ways *restrict w, const double *restrict weight, long n, const Limits *l,
                         double *restrict sums)
{
    double held = 0.0, opened = 0.0, made = 0.0, closed = 0.0, near = 0.0, missed = 0.0, acting = 0.0;
    double gone = 0.0;
    for (long k = 0; k < n; k++) {
        const double own = weight ? weight[k] : 1.0, first = w->first[k], last = w->last[k];
        held += first < l->held ? own : 0.0;
        opened += first < l->held && last > l->open ? own : 0.0;
        made += last < l->held ? own : 0.0;
        closed += last < l->held && first > l->open ? own : 0.0;
        near += w->closest[k] < l->reach ? own : 0.0;
        missed += own * w->missed[k];
        acting += (first < last ? first : last) < l->reach ? own : 0.0;
        gone += (first < last ? first : last) < l->reach ? own * w->gone[k] : 0.0;
    }
    const double found[] = {held, opened, made, closed, 0.0, near, missed, acting, gone};
    for (long i = 0; i < 9; i++) sums[i] += found[i];
}

/* Of states foretold, where a step ended and where it began: farthest beyond what is allowed; largest way
   where the law acts; nodes held at first, and those of them that open; the same of the last ones; nodes in
   contact that pass through sticking; nodes where the law acts at the end or was foretold to, and squares of
   how far these ended from there; where it acts at either end, and squares of the way of these. */
void strays(const Site *site, long m, const double *const *known, const Limits *l, double *numbers)
{
    const long nodes = site->nodes;
    const double *foretold = known[0], *ended = known[1], *began = known[2];
    const double *initial_gap = site->initial_gap, *weight = site->weight, peak = site->peak;
    const double reach = m > 1 ? greater(l->reach, site->contact) : l->reach; /* beyond, nothing counts */
    double beyond = -l->strays, moved = 0.0, sums[9] = {0};
    Ways w;
    for (long from = 0, n; (n = next_acting(nodes, &from, foretold, ended, began, initial_gap, reach));
         from += n) {
        ways(m, nodes, from, n, foretold, ended, began, initial_gap, l, 1.0, &w);
        count_nodes(&w, weight ? weight + from : 0, n, l, sums);
        beyond = largest_of(beyond, w.aside, n);
        for (long k = 0; k < n; k++)
            if ((w.first[k] < w.last[k] ? w.first[k] : w.last[k]) >= l->reach) w.way[k] = 0.0;
        moved = largest_of(moved, w.way, n);
        for (long k = 0; k < n && m > 1; k++)
            if (w.first[k] < site->contact && w.last[k] < site->contact
                && through_sticking(m, nodes, began + from + k, ended + from + k, peak))
                sums[4] += weight ? weight[from + k] : 1.0;
    }
    numbers[0] = beyond;
    numbers[1] = moved;
    memcpy(numbers + 2, sums, sizeof sums);
}

typedef struct { /* nodes that are asked for their works: gaps and changes by component, and weights in each
                    of the sets they are in */
    long held;
    double gap[MOST * SOME], change[MOST * SOME], share[3][SOME];
} Asked;

/* Adds sums over the sets. */
CLONES static void add_works(const Asked *restrict a, const double *restrict found, double *restrict numbers)
{
    for (long set = 0; set < 3; set++) {
        double released = 0.0, springs = 0.0;
        for (long h = 0; h < a->held; h++) {
            const double w = a->share[set][h];
            released += w > 0.0 ? w * found[h] : 0.0;
            springs += w > 0.0 ? w * found[a->held + h] : 0.0;
        }
        numbers[set] += released;
        numbers[3 + set] += springs;
    }
}

/* numbers: what nodes release on the straight way of a step over linear springs, and what these do
   (`works`), summed over three sets: those aside of their prediction, those where the law acts, and those
   of them that move by more than half of `moved`. */
void releases(const Site *site, long m, const double *const *known, const Limits *l, double moved, double *numbers)
{
    const long nodes = site->nodes;
    const double *foretold = known[0], *ended = known[1], *began = known[2];
    const double *initial_gap = site->initial_gap, *weight = site->weight;
    double found[2 * SOME];
    Asked a;
    Ways w;
    memset(numbers, 0, 6 * sizeof *numbers);
    for (long from = 0, n; (n = next_acting(nodes, &from, foretold, ended, began, initial_gap, l->reach));
         from += n) {
        ways(m, nodes, from, n, foretold, ended, began, initial_gap, l, l->doubtful, &w);
        a.held = 0;
        for (long k = 0; k < n; k++) {
            const int near = (w.first[k] < w.last[k] ? w.first[k] : w.last[k]) < l->reach;
            const int off = w.aside[k] > 0.0;
            if (!near && !off) continue;
            const double own = weight ? weight[from + k] : 1.0;
            a.share[0][a.held] = off ? own : 0.0;
            a.share[1][a.held] = near ? own : 0.0;
            a.share[2][a.held] = near && w.way[k] > 0.5 * moved ? own : 0.0;
            for (long i = 0; i < m; i++) {
                const double begin = began[i * nodes + from + k];
                a.gap[i * SOME + a.held] = i ? begin : w.first[k];
                a.change[i * SOME + a.held] = ended[i * nodes + from + k] - begin;
            }
            a.held++;
        }
        if (!a.held) continue;
        for (long i = 1; i < m; i++) {
            memmove(a.gap + i * a.held, a.gap + i * SOME, a.held * sizeof *a.gap);
            memmove(a.change + i * a.held, a.change + i * SOME, a.held * sizeof *a.change);
        }
        works(site->law, m, a.held, a.gap, a.change, site->parts, l->count, l->places, l->shares, l->trifle, found);
        add_works(&a, found, numbers);
    }
}

/* the form whose unknowns are the displacements */
static Form plain_of(const Form *f)
{
    Form plain = *f;
    plain.root = 1.0;
    plain.scale = plain.unscale = 0;
    return plain;
}

/* Tractions at displacements, in the transform; their sums over the cell. */
static int begin_imbalance(Form *f, const double *displacement, double *sum)
{
    const long n = f->nodes, m = f->components;
    const double no_scalars[MOST] = {0};
    Form plain = plain_of(f);
    int status = begin_residual(&plain, displacement, no_scalars, sum);
    f->evaluations = plain.evaluations;
    if ((f->known = plain.known)) /* at the unknown that they are packed to */
        for (long k = 0; k < m * n; k++)
            f->last[k] = displacement[k] / f->root * (f->scale ? f->scale[k % n] : 1.0);
    return status;
}

/* What the imbalances of a component at some nodes, x, add to the numbers of `imbalance`. */
CLONES static void add_imbalances(const Form *f, const double *displacement, long at, long n, double reach,
                                  const double *restrict x, double *restrict numbers)
{
    const double *restrict u = displacement + at, *restrict gap = f->initial_gap + at;
    double acting = 0.0, size[SOME];
    for (long from = 0; from < n; from += SOME) {
        const long some = n - from < SOME ? n - from : SOME;
        for (long k = 0; k < some; k++) {
            const double counts = u[from + k] + gap[from + k] < reach ? 1.0 : 0.0;
            size[k] = counts > 0.0 ? fabs(x[from + k]) : 0.0;
            acting += counts;
        }
        numbers[1] = largest_of(numbers[1], size, some);
    }
    numbers[0] += weighted_squares(x, f->weight ? f->weight + at : 0, n);
    numbers[2] += acting;
}

/* Of the response to these: squares of F, the largest imbalance and at how many nodes the law acts, of the
   nodes here; a row at a time, for which there is room in `row`. */
static void end_imbalance(Form *f, const double *displacement, const double *mean, double reach, double *row,
                   double *numbers)
{
    const Response *r = f->response;
    const long n = f->nodes, c = r->shape[1];
    memset(numbers, 0, 3 * sizeof *numbers);
    for (long i = 0; i < f->components; i++)
        for (long at = 0; at < n; at += c) {
            const long some = n - at < c ? n - at : c, line = at / c;
            const double *own = displacement + i * n + at;
            if (r->on_circle) take_nodes(r->transform, i, r->on_circle + at, mean[i], 1.0, own, row, some);
            else take_row(r->transform, i * r->boxes + line / r->shape[0], line % r->shape[0], mean[i], 1.0, 0,
                          own, row, some);
            add_imbalances(f, displacement, at, some, reach, row, numbers);
        }
    numbers[0] /= f->root * f->root;
    numbers[2] /= f->components; /* for each of which they were counted */
}

/* What the equations say of displacements, and of the means of forced components: the sum of squares of F,
   the largest imbalance at a node where the law acts, ranges, and at how many it does, of what is here; row
   as above. Where the response is that of the last residual, in the transform still, it is not made again. */
int imbalance(Form *f, const double *displacement, const double *scalars, double reach, double *row,
              double *numbers, int answered)
{
    double sum[2 * MOST], mean[MOST];
    if (answered) memcpy(sum, f->total, sizeof f->total);
    else {
        int status = begin_imbalance(f, displacement, sum);
        if (status || (status = convolve(f->response, 0))) return status;
    }
    for (long i = 0; i < f->components; i++) mean[i] = f->far[i] - f->rigid[i] * sum[i] / f->size;
    for (long row = 0; row < f->forced_count; row++) mean[f->forced[row]] = scalars[row];
    end_imbalance(f, displacement, mean, reach, row, numbers);
    for (long row = 0; row < f->held; row++) {
        const double missing = f->row_scale[f->forced[row]] * sum[f->forced[row]] - f->target[f->forced[row]];
        numbers[0] += missing * missing;
    }
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

/* Where the only crossing of a level is, upwards if it has to be, within (0, end] nodes from the middle of an
   even line whose values (count, at least 3) stand from there outwards behind room for two more; 0 where
   there is none, or several. */
static double only_crossing(long count, double *values, double level, double end, int upwards)
{
    double places[FEW], signs[FEW], found = 0.0;
    values[0] = values[4]; /* which interpolation between the first two asks for */
    values[1] = values[3];
    const long all = crossings(count + 2, values, level, FEW, places, signs);
    for (long k = 0; k < all && k < FEW; k++) {
        const double place = places[k] - 2.0;
        if (!(place > 0.0 && place <= end)) continue;
        if (found > 0.0 || (upwards && signs[k] < 0.0)) return 0.0;
        found = place;
    }
    return found;
}

/* reaches: of an even line, fields (m, nodes, at least 3) from its middle outwards, in nodes from there, the
   end of contact, a slip front within it, and an end of pressure between these, `least` nodes from both; 0
   where there is none, or several, and of what hangs on it. last: how far the line reaches; work: nodes + 2
   numbers. */
void reaches(const Site *site, long m, const double *field, double last, double least, double *work, double *reaches)
{
    const long nodes = site->nodes;
    double *gap = work + 2;
    for (long k = 0; k < nodes; k++) gap[k] = field[k] + site->initial_gap[k];
    const double end = only_crossing(nodes, work, site->contact, last, 1);
    const double pressed = end > 0.0 && m > 1 ? only_crossing(nodes, work, 0.0, last, 0) : 0.0;
    for (long k = 0; k < nodes && end > 0.0 && m > 1; k++) gap[k] = fabs(field[nodes + k]);
    const double front = end > 0.0 && m > 1 ? only_crossing(nodes, work, site->peak, nextafter(end, 0.0), 1) : 0.0;
    reaches[0] = end;
    reaches[1] = front;
    reaches[2] = front > 0.0 && end - pressed > least && pressed - front > least ? pressed : 0.0;
}

enum { REACH = 4 }; /* of the eighth difference */

enum { CHUNK = 64 };

static const double DIFFERENCE[] = {70.0, -56.0, 28.0, -8.0, 1.0};

/* The largest size of sums of nine numbers each, times factors, of n that stand in rows. */
CLONES static double largest_sum(const double *const *rows, const double *factors, long n)
{
    const double *restrict a = rows[0], *restrict b = rows[1], *restrict c = rows[2], *restrict d = rows[3];
    const double *restrict e = rows[4], *restrict f = rows[5], *restrict g = rows[6], *restrict h = rows[7];
    const double *restrict i = rows[8], *restrict s = factors;
    double most[CHUNK] = {0};
    if (n == 1) return fabs(s[0] * *a + s[1] * *b + s[2] * *c + s[3] * *d + s[4] * *e + s[5] * *f + s[6] * *g
                            + s[7] * *h + s[8] * *i);
    for (long from = 0; from < n; from += CHUNK) {
        const long count = n - from < CHUNK ? n - from : CHUNK;
        double sum[CHUNK] = {0};
        for (long k = 0; k < count; k++) /* all at once: each number is read, none is put down in between */
            sum[k] = s[0] * a[from + k] + s[1] * b[from + k] + s[2] * c[from + k] + s[3] * d[from + k]
                + s[4] * e[from + k] + s[5] * f[from + k] + s[6] * g[from + k] + s[7] * h[from + k]
                + s[8] * i[from + k];
        for (long k = 0; k < CHUNK; k++) most[k] = fabs(sum[k]) > most[k] ? fabs(sum[k]) : most[k];
    }
    return largest_of(0.0, most, CHUNK);
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

/* The largest `alternation` of fields (m, nodes) of half a line, each over its largest size, or the least where
   that is less, by which it is divided. */
static double alternation_of_halves(const Site *site, long m, double *fields)
{
    const long nodes = site->nodes;
    double found = 0.0;
    for (long i = 0; i < m; i++) {
        double *own = fields + i * nodes, largest = site->least;
        for (long k = 0; k < nodes; k++) largest = greater(fabs(own[k]), largest);
        for (long k = 0; k < nodes; k++) own[k] /= largest;
        found = greater(alternation(1, nodes, 1, own, site->sign[i], site->closed, 0), found);
    }
    return found;
}

enum { POINTS = 4 }; /* of a path, at most */

typedef struct { /* points of a path: displacements and forces (count, m), by how much gives way to a force of
                    each component, and what it does in a common unit */
    long count, m;
    const double *displacements, *forces, *give, *weights;
} Path;

/* Square of the distance between two points, in which a force counts by how much gives way to it. */
static double square_between(const Path *p, long one, long other)
{
    double sum = 0.0;
    for (long i = 0; i < p->m; i++) {
        const double moved = p->displacements[other * p->m + i] - p->displacements[one * p->m + i];
        const double pushed = p->give[i] * p->forces[other * p->m + i] - p->give[i] * p->forces[one * p->m + i];
        sum += moved * moved + pushed * pushed;
    }
    return sum;
}

/* Appends a point of another path to one that has room for it. */
static void add_point(Path *p, const Path *other, long number, double *displacements, double *forces)
{
    memcpy(displacements + p->count * p->m, other->displacements + number * p->m, p->m * sizeof *displacements);
    memcpy(forces + p->count * p->m, other->forces + number * p->m, p->m * sizeof *forces);
    p->count++;
}

/* Marks the points without those that are `twins` of others beside the way from point number `first` to the
   last one; both stay. */
static void without_twins(const Path *p, long first, double twins, int *kept)
{
    const long last = p->count - 1;
    const double least = twins * twins * square_between(p, first, last);
    int all = 1;
    for (long k = 0; k < p->count; k++)
        for (long other = 0; other < k; other++) all &= square_between(p, k, other) > least;
    for (long k = 0; k < p->count; k++) kept[k] = all || k == first || k == last;
    for (long k = last - 1; k >= 0 && !all; k--) {
        int alone = k != first;
        for (long other = 0; other < p->count; other++)
            alone &= !kept[other] || square_between(p, k, other) > least;
        kept[k] |= alone;
    }
}

/* Gauss and Legendre's rule of so many points: places, before shares, of those of two points on. */
const double *rule_of(long count, const double *rules)
{
    for (long k = 2; k < count; k++) rules += 2 * k;
    return rules;
}

/* Lagrange's polynomials of so many places at a point, and their slopes. */
void lagrange(long count, const double *place, double at, double *value, double *slope)
{
    for (long j = 0; j < count; j++) {
        value[j] = 1.0;
        slope[j] = 0.0;
        for (long other = 0; other < count; other++) {
            if (other == j) continue;
            const double apart = at - place[other], scale = 1.0 / (place[j] - place[other]);
            slope[j] = (slope[j] * apart + value[j]) * scale;
            value[j] *= apart * scale;
        }
    }
}

/* Work from point number `first` of a path to its last one: polynomials through all, by distance along them.
   points, shares: Gauss and Legendre's rule of as many points, which is exact. (Lagrange's polynomials are
   summed up first: next to each other they make large numbers that cancel.) */
static double line_work(const Path *p, long first, const double *points, const double *shares)
{
    const long count = p->count, m = p->m;
    double place[POINTS] = {0}, work = 0.0;
    for (long k = 1; k < count; k++) place[k] = place[k - 1] + sqrt(square_between(p, k - 1, k));
    const double half = 0.5 * (place[count - 1] - place[first]);
    for (long k = 0; k < count; k++) {
        const double at = place[first] + half * (1.0 + points[k]);
        double force[MOST] = {0}, moving[MOST] = {0}, value[POINTS], slope[POINTS];
        lagrange(count, place, at, value, slope);
        for (long j = 0; j < count; j++)
            for (long i = 0; i < m; i++) {
                force[i] += value[j] * p->forces[j * m + i];
                moving[i] += slope[j] * p->displacements[j * m + i];
            }
        for (long i = 0; i < m; i++) work += half * shares[k] * p->weights[i] * force[i] * moving[i];
    }
    return work;
}

/* A work of `line_work`, or that of the chords between the points where it is none that forces between their
   values could do. */
static double held(double work, const Path *p, long first)
{
    double chords = 0.0, doubt = 0.0;
    for (long i = 0; i < p->m; i++) {
        double chord = 0.0, way = 0.0, change = 0.0;
        for (long k = first > 0 ? first : 1; k < p->count; k++)
            change = greater(fabs(p->forces[k * p->m + i] - p->forces[(k - 1) * p->m + i]), change);
        for (long k = first + 1; k < p->count; k++) {
            const long at = k * p->m + i, before = at - p->m;
            const double step = p->displacements[at] - p->displacements[before];
            chord += 0.5 * (p->forces[before] + p->forces[at]) * step;
            way += fabs(step);
        }
        chords += p->weights[i] * chord;
        doubt += p->weights[i] * 0.5 * change * way;
    }
    return fabs(work - chords) <= doubt ? work : chords;
}

/* `line_work` by some rules; *doubt: what it changes by without one of the points. */
static double doubted(const Path *p, long first, const double *rules, double *doubt)
{
    const long count = p->count, m = p->m, left = first == 0;
    const double *rule = rule_of(count, rules), *fewer = rule_of(count - 1, rules);
    const double work = line_work(p, first, rule, rule + count);
    *doubt = 0.0;
    if (count == 2) return work;
    double moved[POINTS * MOST], pushed[POINTS * MOST];
    Path some = {0, m, moved, pushed, p->give, p->weights};
    for (long k = 0; k < count; k++)
        if (k != left) add_point(&some, p, k, moved, pushed);
    *doubt = fabs(work - line_work(&some, first > 0 ? first - 1 : 0, fewer, fewer + count - 1));
    return work;
}

/* less: how much gives way to each force of points, or less, so that none goes further than a part `reach` of its
   displacement. */
static void reaching(const Path *p, double reach, double *less)
{
    for (long i = 0; i < p->m; i++) {
        double low[2], high[2];
        const double *of[2] = {p->displacements, p->forces};
        for (int one = 0; one < 2; one++) {
            low[one] = high[one] = of[one][i];
            for (long k = 1; k < p->count; k++) {
                low[one] = fmin(low[one], of[one][k * p->m + i]);
                high[one] = fmax(high[one], of[one][k * p->m + i]);
            }
        }
        const double moved = high[0] - low[0], pushed = high[1] - low[1];
        less[i] = pushed * p->give[i] > reach * moved ? reach * moved / fmax(pushed, 1e-300) : p->give[i];
    }
}

/* Work of forces over displacements (count, m) from point number `first` of a path to its last one, as
   contact/work_along.py has it. limits: its TWINS, REACH and SURER; rules: Gauss and Legendre's of two points on,
   the places of each before its shares. */
double path_work(long count, long first, long m, const double *displacements, const double *forces,
                 const double *give, const double *weights, const double *limits, const double *rules)
{
    const Path given = {count, m, displacements, forces, give, weights};
    double moved[POINTS * MOST], pushed[POINTS * MOST], less[MOST], doubt, other;
    Path path = {0, m, moved, pushed, give, weights}, leaner = path;
    int kept[POINTS];
    long begin = 0, all = 1;
    without_twins(&given, first, limits[0], kept);
    for (long k = 0; k < count; k++) {
        if (!kept[k]) continue;
        begin = k == first ? path.count : begin;
        add_point(&path, &given, k, moved, pushed);
    }
    double work = doubted(&path, begin, rules, &doubt);
    reaching(&path, limits[1], less);
    leaner.count = path.count;
    leaner.give = less;
    without_twins(&leaner, begin, limits[0], kept);
    for (long k = 0; k < path.count; k++) all &= kept[k];
    if (all && path.count > 2) {
        const double found = doubted(&leaner, begin, rules, &other);
        work = other < limits[2] * doubt ? found : work;
    }
    return held(work, &path, begin);
}
