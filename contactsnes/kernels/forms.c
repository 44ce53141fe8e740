/* The displacement form, v + C t(a + v) - vbar = 0 (contact/forms.py), with the scales of even states
   (contact/even_form.py), and the row and column of arc length (contact/bordered.py). */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { PART = 264 }; /* nodes of which the law's numbers stay in the processor's nearest memory: no less than
                        the 257 of a row from the axis to the edge of a cell of 512 */
static const double NEGLIGIBLE = 1e-30; /* as contact/forms.py has it */

/* Fields of some nodes: where they begin, and how far components are from each other. */
typedef struct {
    double *at;
    long apart;
} Part;

CLONES static void sheared_part(const Law *law, long components, long n, const double *gap, long apart,
                                Part traction, Part tangent)
{
    double slip[PART], normal[PART], secant[PART], na[PART], nb[PART], sa[PART], sb[PART];
    const double *s[MOST] = {0};
    for (long k = 0; k < n; k++) slip[k] = 0.0;
    for (long i = 1; i < components; i++) {
        s[i] = gap + i * apart;
        for (long k = 0; k < n; k++) slip[k] += s[i][k] * s[i][k];
    }
    for (long k = 0; k < n; k++) slip[k] = sqrt(slip[k]);
    if (tangent.at) law->sheared(n, law->parameters, gap, slip, normal, secant, na, nb, sa, sb);
    else law->tractions(n, law->parameters, gap, slip, normal, secant);
    if (tangent.at) memcpy(tangent.at, na, n * sizeof *na);
    for (long i = 1; i < components && tangent.at; i++) {
        double *restrict weakening = tangent.at + i * tangent.apart;
        double *restrict opening = tangent.at + i * components * tangent.apart;
        for (long k = 0; k < n; k++) {
            weakening[k] = nb[k] * s[i][k];
            opening[k] = sa[k] * s[i][k];
        }
        for (long j = 1; j < components; j++) {
            double *restrict slipping = tangent.at + (i * components + j) * tangent.apart;
            for (long k = 0; k < n; k++) slipping[k] = sb[k] * s[i][k] * s[j][k];
            for (long k = 0; k < n && i == j; k++) slipping[k] += secant[k];
        }
    }
    for (long i = 1; i < components; i++)
        for (long k = 0; k < n; k++) traction.at[i * traction.apart + k] = secant[k] * s[i][k];
    memcpy(traction.at, normal, n * sizeof *normal);
}

/* Tractions of at most PART nodes and, unless null, the tangent; the traction may be the gap. */
static void evaluate_part(const Law *law, long components, long n, const double *gap, long apart,
                          Part traction, Part tangent)
{
    double normal[PART], slope[PART];
    if (components > 1) {
        sheared_part(law, components, n, gap, apart, traction, tangent);
        return;
    }
    law->normal(n, law->parameters, gap, normal, slope);
    memcpy(traction.at, normal, n * sizeof *normal);
    if (tangent.at) memcpy(tangent.at, slope, n * sizeof *slope);
}

static Part part_of(double *field, long at, long nodes)
{
    return (Part){field ? field + at : 0, nodes};
}

/* Tractions and, unless null, the tangent (components, components, nodes); traction may be gap. */
void evaluate(const Law *law, long components, long nodes, const double *gap, double *traction,
              double *tangent)
{
    for (long at = 0; at < nodes; at += PART) {
        const long n = nodes - at < PART ? nodes - at : PART;
        evaluate_part(law, components, n, gap + at, nodes, part_of(traction, at, nodes),
                      part_of(tangent, at, nodes));
    }
}

CLONES static double total(const double *restrict x, const double *restrict w, long n)
{
    double sum = 0.0;
    if (w)
        for (long k = 0; k < n; k++) sum += x[k] * w[k];
    else
        for (long k = 0; k < n; k++) sum += x[k];
    return sum;
}

/* the gap of some nodes */
CLONES static void gap_of(const Form *f, const double *unknown, long at, long n, double *part)
{
    const double *restrict z = f->unscale ? f->unscale + at : 0, *restrict a = f->initial_gap + at;
    for (long i = 0; i < f->components; i++) {
        double *restrict g = part + i * PART;
        const double *restrict u = unknown + i * f->nodes + at;
        if (z)
            for (long k = 0; k < n; k++) g[k] = u[k] * z[k] * f->root;
        else
            for (long k = 0; k < n; k++) g[k] = u[k] * f->root;
        for (long k = 0; k < n && i == 0; k++) g[k] += a[k];
    }
}

/* What goes to a transform of at most PART nodes, of a vector: components are PART apart. */
typedef void (*Fill)(const Form *, const void *vector, long at, long n, double *part);

/* Tractions; the tangent is kept for a linearisation at the same unknown, where there is room for it. */
static void fill_tractions(const Form *f, const void *unknown, long at, long n, double *part)
{
    gap_of(f, unknown, at, n, part);
    evaluate_part(f->law, f->components, n, part, PART, (Part){part, PART},
                  part_of(f->ahead, at, f->nodes));
}

/* D vector / scale, of some nodes of a vector in numbers NUMBER */
#define STIFFEN(NUMBER, NAME)                                                                                \
    CLONES static void NAME(const Form *f, const void *vector, long at, long n, double *part)                \
    {                                                                                                        \
        const long m = f->components, nodes = f->nodes;                                                      \
        const double *restrict z = f->unscale;                                                               \
        const NUMBER *restrict v = (const NUMBER *)vector + at;                                              \
        for (long i = 0; i < m; i++) {                                                                       \
            double *restrict w = part + i * PART;                                                            \
            const double *restrict d = f->tangent + i * m * nodes + at;                                      \
            if (m == 3)                                                                                      \
                for (long k = 0; k < n; k++)                                                                 \
                    w[k] = d[k] * v[k] + d[nodes + k] * v[nodes + k] + d[2 * nodes + k] * v[2 * nodes + k];  \
            else {                                                                                           \
                for (long k = 0; k < n; k++) w[k] = d[k] * v[k];                                             \
                for (long j = 1; j < m; j++)                                                                 \
                    for (long k = 0; k < n; k++) w[k] += d[j * nodes + k] * v[j * nodes + k];                \
            }                                                                                                \
            for (long k = 0; k < n && z; k++) w[k] *= z[at + k];                                             \
        }                                                                                                    \
    }
STIFFEN(double, fill_stiffened)
STIFFEN(float, fill_stiffened_in_single)

/* numbers in single precision in double, and back */
CLONES void widen(const float *restrict x, double *restrict out, long n)
{
    for (long k = 0; k < n; k++) out[k] = x[k];
}

CLONES void narrow(const double *restrict x, float *restrict out, long n)
{
    for (long k = 0; k < n; k++) out[k] = x[k];
}

/* vector / scale */
CLONES static void fill_vector(const Form *f, const void *given, long at, long n, double *part)
{
    const double *restrict vector = given;
    for (long i = 0; i < f->components; i++)
        for (long k = 0; k < n; k++)
            part[i * PART + k] = vector[i * f->nodes + at + k] * (f->unscale ? f->unscale[at + k] : 1.0);
}

/* whether a residual, or a product, takes sums over the cell */
static int asks_for_sums(const Form *f)
{
    int asks = f->forced_count > 0;
    for (long i = 0; i < f->components; i++) asks |= f->rigid[i] != 0.0;
    return asks;
}

/* Puts what some nodes after the other are filled with in the transform of r, and adds it to sums where these
   are asked for. */
static void put(const Form *f, const Response *r, const void *vector, Fill fill, double *sum)
{
    const long m = f->components, rows = r->shape[0], c = r->on_circle ? f->nodes : r->shape[1];
    const long lines = r->on_circle ? 1 : r->boxes * rows, parts = c > PART ? (c + PART - 1) / PART : 1;
    const long most = ((c + parts - 1) / parts + 7) / 8 * 8; /* of a row's parts: vectors of a processor */
    const int sums_up = asks_for_sums(f);
    double part[MOST * PART];
    for (long i = 0; i < m && r->on_circle; i++) clear_field(r->transform, i);
    for (long line = 0; line < lines; line++)
        for (long first = 0; first < c; first += most) {
            const long at = line * c + first, n = c - first < most ? c - first : most;
            fill(f, vector, at, n, part);
            for (long i = 0; i < m; i++) {
                const double *x = part + i * PART;
                if (sums_up) sum[i] += total(x, f->weight ? f->weight + at : 0, n);
                if (r->on_circle) put_nodes(r->transform, i, r->on_circle + at, x, n);
                else put_row(r->transform, i * r->boxes + line / rows, line % rows, first, 0, x, n);
            }
        }
}

/* out = (response - mean) factor scale + own, by component */
void assemble(const Form *f, const Response *r, const double *mean, double factor,
                     const double *own, double *out)
{
    const long n = f->nodes, c = r->shape[1];
    long at = 0;
    for (long i = 0; i < f->components && r->on_circle; i++)
        take_nodes(r->transform, i, r->on_circle, mean[i], factor, own + i * n, out + i * n, n);
    for (long i = 0; i < f->components && !r->on_circle; i++)
        for (long b = 0; b < r->boxes; b++)
            for (long j = 0; j < r->shape[0]; j++, at += c)
                take_row(r->transform, i * r->boxes + b, j, mean[i], factor,
                         f->scale ? f->scale + at - i * n : 0, own + at, out + at, c);
}

/* what products respond by */
static const Response *chosen(const Form *f)
{
    return f->single ? f->quick : f->response;
}

/* Sums over processes of numbers, in place, where these share out the nodes. */
int add_up(const Form *f, double *numbers, long count)
{
    return f->add_up ? f->add_up(numbers, count) : 0;
}

/* Of a vector whose scalars are its `tail`, or part of it: the sums over the cell, of which those of the nodes
   that are here stand in numbers, and behind these the scalars, on all processes. */
static int totals(const Form *f, const double *tail, double *numbers)
{
    for (long row = 0; row < f->forced_count; row++) numbers[MOST + row] = row < f->held ? tail[row] : 0.0;
    return asks_for_sums(f) ? add_up(f, numbers, MOST + f->forced_count) : 0;
}

/* Tractions at an unknown, in the transform; their sums over the cell, and the unknown's scalars. */
int begin_residual(Form *f, const double *unknown, const double *tail, double *numbers)
{
    memset(numbers, 0, MOST * sizeof *numbers);
    f->evaluations++;
    put(f, f->response, unknown, fill_tractions, numbers);
    if (f->ahead) memcpy(f->last, unknown, f->components * f->nodes * sizeof *unknown);
    f->known = f->ahead != 0;
    int status = totals(f, tail, numbers);
    memcpy(f->total, numbers, sizeof f->total);
    return status;
}

int residual(Form *f, const double *unknown, double *out)
{
    const long n = f->nodes, m = f->components;
    const double *counter = f->response->transform->counter;
    double sum[2 * MOST], *scalars = sum + MOST, mean[MOST];
    int status = begin_residual(f, unknown, unknown + m * n, sum);
    if (status || (status = convolve(f->response, 0))) return status;
    f->answered = counter[0] + counter[2];
    for (long i = 0; i < m; i++) mean[i] = f->far[i] - f->rigid[i] * sum[i] / f->size;
    for (long row = 0; row < f->forced_count; row++) mean[f->forced[row]] = scalars[row];
    assemble(f, f->response, mean, 1.0 / f->root, unknown, out);
    for (long row = 0; row < f->held; row++) {
        const long i = f->forced[row];
        out[m * n + row] = f->row_scale[i] * sum[i] - f->target[i];
    }
    return 0;
}

CLONES static void clear_negligible(double *restrict x, long n)
{
    for (long k = 0; k < n; k++) x[k] = fabs(x[k]) < NEGLIGIBLE ? 0.0 : x[k];
}

/* Takes the tangent, that of the last residual if it was at the same unknown. */
void linearise(Form *f, const double *unknown)
{
    const long m = f->components, n = f->nodes;
    double part[MOST * PART];
    if (f->known && !memcmp(f->last, unknown, m * n * sizeof *unknown)) {
        memcpy(f->tangent, f->ahead, m * m * n * sizeof *unknown);
        clear_negligible(f->tangent, m * m * n);
        return;
    }
    for (long at = 0; at < n; at += PART) {
        const long count = n - at < PART ? n - at : PART;
        gap_of(f, unknown, at, count, part);
        evaluate_part(f->law, m, count, part, PART, (Part){part, PART}, part_of(f->tangent, at, n));
        for (long i = 0; i < m * m; i++) clear_negligible(f->tangent + i * n + at, count);
    }
}

/* What a vector is filled with, in the transform; its sums over the cell, and the vector's scalars. */
static int begin_product(Form *f, const void *vector, Fill fill, const double *tail, double *numbers)
{
    memset(numbers, 0, MOST * sizeof *numbers);
    f->products++;
    put(f, chosen(f), vector, fill, numbers);
    return totals(f, tail, numbers);
}

/* Means of a product by the sums of what the law answers, and a vector's scalars. */
static void means_of(const Form *f, const double *sum, const double *scalars, double *mean)
{
    for (long i = 0; i < f->components; i++) mean[i] = -f->rigid[i] * sum[i] / f->size;
    for (long row = 0; row < f->forced_count; row++) mean[f->forced[row]] = scalars[row] / f->root;
}

/* The row of a force in a product. */
static double force_row(const Form *f, long row, const double *sum, const double *scalars)
{
    const long i = f->forced[row];
    return f->row_scale[i] * (sum[i] * f->root + f->drag[i] * scalars[row]);
}

int product(Form *f, const double *vector, double *out)
{
    const long count = f->components * f->nodes;
    double sum[2 * MOST], *scalars = sum + MOST, mean[MOST];
    int status = begin_product(f, vector, fill_stiffened, vector + count, sum);
    if (status || (status = convolve(chosen(f), 0))) return status;
    means_of(f, sum, scalars, mean);
    assemble(f, chosen(f), mean, 1.0, vector, out);
    for (long row = 0; row < f->held; row++) out[count + row] = force_row(f, row, sum, scalars);
    return 0;
}

/* The product of a vector in single precision, of one box whose transform has all of its nodes. */
int product_in_single(Form *f, const float *vector, float *out)
{
    const long n = f->nodes, m = f->components, rows = f->response->shape[0], c = f->response->shape[1];
    double sum[2 * MOST], *scalars = sum + MOST, mean[MOST], tail[MOST], row[c];
    widen(vector + m * n, tail, f->held);
    int status = begin_product(f, vector, fill_stiffened_in_single, tail, sum);
    if (status || (status = convolve(chosen(f), 0))) return status;
    means_of(f, sum, scalars, mean);
    for (long i = 0; i < m; i++)
        for (long j = 0; j < rows; j++) {
            const long at = i * n + j * c;
            widen(vector + at, row, c);
            take_row(chosen(f)->transform, i, j, mean[i], 1.0, f->scale ? f->scale + j * c : 0, row, row, c);
            narrow(row, out + at, c);
        }
    for (long k = 0; k < f->held; k++) out[m * n + k] = force_row(f, k, sum, scalars);
    return 0;
}

/* out = vector + D^T scale (response - mean) */
CLONES static void end_transposed(Form *f, const double *mean, const double *vector, double *out)
{
    const long nodes = f->nodes, m = f->components;
    double part[MOST * PART];
    memset(out, 0, m * nodes * sizeof *out);
    assemble(f, chosen(f), mean, 1.0, out, out); /* which is zero: the scaled response alone */
    for (long at = 0; at < nodes; at += PART) {
        const long n = nodes - at < PART ? nodes - at : PART;
        for (long j = 0; j < m; j++) memcpy(part + j * PART, out + j * nodes + at, n * sizeof *part);
        for (long i = 0; i < m; i++) {
            double *restrict o = out + i * nodes + at;
            memcpy(o, vector + i * nodes + at, n * sizeof *o);
            for (long j = 0; j < m; j++) {
                const double *restrict d = f->tangent + (j * m + i) * nodes + at, *restrict w = part + j * PART;
                for (long k = 0; k < n; k++) o[k] += d[k] * w[k];
            }
        }
    }
}

int transposed_product(Form *f, const double *vector, double *out)
{
    const long m = f->components, n = f->nodes;
    double sum[2 * MOST], *scalars = sum + MOST, mean[MOST];
    int status = begin_product(f, vector, fill_vector, vector + m * n, sum);
    if (status) return status;
    for (long i = 0; i < m; i++) mean[i] = -f->rigid[i] / f->size * sum[i];
    for (long row = 0; row < f->forced_count; row++) {
        const long i = f->forced[row];
        mean[i] = -f->row_scale[i] * f->root * scalars[row];
        if (row < f->held) out[m * n + row] = -sum[i] / f->root;
    }
    if ((status = convolve(chosen(f), 1))) return status;
    end_transposed(f, mean, vector, out);
    return 0;
}

/* ---- one more unknown, the load s, and a row for the length along the branch */

static long size_of(const Form *f)
{
    return f->components * f->nodes + f->forced_count;
}

CLONES static double inner(const double *restrict x, const double *restrict y, long n)
{
    double sum = 0.0;
    for (long k = 0; k < n; k++) sum += x[k] * y[k];
    return sum;
}

static void set_position(const Form *f, const Arc *arc, double position)
{
    for (long i = 0; i < f->components; i++) {
        const double load = arc->start[i] + position * arc->direction[i];
        const double least = fabs(load) > 1.0 ? fabs(load) : 1.0;
        arc->load[i] = load;
        arc->row_scale[i] = arc->factor[i] / least;
        arc->target[i] = load / least;
        arc->far[i] = arc->factor[i + MOST] * load;
    }
}

/* How far an unknown has gone from the anchor along the tangent. */
CLONES static double gone(const Arc *arc, const double *restrict unknown, long n)
{
    const double *restrict tangent = arc->tangent;
    const float *restrict anchor = arc->anchor;
    double sum = 0.0;
    for (long k = 0; k < n; k++) sum += tangent[k] * (unknown[k] - (double)anchor[k]);
    return sum;
}

/* out += position times dF/ds. */
CLONES static void add_load(const Form *f, const Arc *arc, double position, double *out)
{
    const long n = f->nodes, m = f->components;
    const double *restrict scale = f->scale;
    for (long i = 0; i < m; i++) {
        double *restrict field = out + i * n;
        const double slope = arc->load_column[i];
        if (scale)
            for (long k = 0; k < n; k++) field[k] += position * (slope * scale[k]);
        else
            for (long k = 0; k < n; k++) field[k] += position * slope;
    }
    for (long row = 0; row < f->forced_count; row++) out[m * n + row] += position * arc->load_column[m + row];
}

/* Sum of a component's field over nodes, each times its scale. */
CLONES static double sum_of(const Form *f, const double *restrict field)
{
    double sum = 0.0;
    for (long k = 0; k < f->nodes; k++) sum += f->scale ? f->scale[k] * field[k] : field[k];
    return sum;
}

int arc_residual(Form *f, const Arc *arc, const double *unknown, double *out)
{
    const long n = size_of(f);
    set_position(f, arc, unknown[n]);
    int status = residual(f, unknown, out);
    out[n] = gone(arc, unknown, n) + arc->rate * unknown[n] - arc->length;
    return status;
}

void arc_linearise(Form *f, const Arc *arc, const double *unknown)
{
    const long m = f->components;
    set_position(f, arc, unknown[size_of(f)]);
    linearise(f, unknown);
    for (long i = 0; i < m; i++)
        arc->load_column[i] = -arc->factor[i + MOST] * arc->direction[i] / f->root;
    for (long row = 0; row < f->forced_count; row++) {
        const long i = f->forced[row];
        const double least = fabs(arc->load[i]) > 1.0 ? fabs(arc->load[i]) : 1.0;
        arc->load_column[i] = 0.0;
        arc->load_column[m + row] = -arc->direction[i] / least;
    }
}

/* dF/ds of the last linearisation, in full. */
void load_column(const Form *f, const Arc *arc, double *out)
{
    memset(out, 0, size_of(f) * sizeof *out);
    add_load(f, arc, 1.0, out);
}

int arc_product(Form *f, const Arc *arc, const double *vector, double *out)
{
    const long n = size_of(f);
    int status = product(f, vector, out);
    add_load(f, arc, vector[n], out);
    out[n] = inner(arc->tangent, vector, n) + arc->rate * vector[n];
    return status;
}

int arc_transposed(Form *f, const Arc *arc, const double *vector, double *out)
{
    const long n = size_of(f);
    int status = transposed_product(f, vector, out);
    out[n] = arc->rate * vector[n];
    for (long i = 0; i < f->components; i++) out[n] += arc->load_column[i] * sum_of(f, vector + i * f->nodes);
    for (long row = 0; row < f->forced_count; row++)
        out[n] += arc->load_column[f->components + row] * vector[f->components * f->nodes + row];
    for (long k = 0; k < n; k++) out[k] += vector[n] * arc->tangent[k];
    return status;
}

/* ---- Newton's step taken in w = a + N(a) / stiffness where it is long (Law.regularised_step) */

/* One iteration for the gaps of some nodes: whether one of them goes on. */
CLONES static int nearer(long n, const double *restrict target, double stiffness,
                         const double *restrict normal, const double *restrict slope, double *restrict low,
                         double *restrict high, double *restrict now, double *restrict going)
{
    double left = 0.0;
    for (long k = 0; k < n; k++) {
        const double excess = now[k] + normal[k] / stiffness - target[k];
        low[k] = excess < 0.0 ? now[k] : low[k];
        high[k] = excess > 0.0 ? now[k] : high[k];
        double trial = now[k] - excess / (1.0 + slope[k] / stiffness);
        trial = trial >= low[k] && trial <= high[k] ? trial : 0.5 * (low[k] + high[k]);
        trial = going[k] > 0.0 ? trial : now[k];
        going[k] = fabs(trial - now[k]) <= 1e-10 * (1.0 + fabs(trial)) ? 0.0 : going[k];
        now[k] = trial;
        left += going[k];
    }
    return left > 0.0;
}

/* The gaps with a + N(a) / stiffness = target, by a bracketed Newton iteration; out may be target. */
void gaps_of_regularised(const Law *law, long nodes, const double *target, double stiffness, double *out)
{
    double now[PART], low[PART], high[PART], normal[PART], slope[PART], going[PART];
    for (long at = 0; at < nodes; at += PART) {
        const long n = nodes - at < PART ? nodes - at : PART;
        for (long k = 0; k < n; k++) {
            const double w = target[at + k];
            now[k] = w < 0.0 ? -law->repulsion * log1p(-stiffness * w) : w;
            low[k] = w > 0.0 ? w - law->peak / stiffness : w;
            high[k] = w > 0.0 ? w + law->barrier / stiffness : 0.0;
            going[k] = 1.0;
        }
        for (int turn = 0; turn < 60; turn++) {
            law->normal(n, law->parameters, now, normal, slope);
            if (!nearer(n, target + at, stiffness, normal, slope, low, high, now, going)) break;
        }
        memcpy(out + at, now, n * sizeof *out);
    }
}

/* Changes the steps (the update is unknown - step) of nodes that would go further than 0.1. */
void regularised_step(const Form *f, double stiffness, const double *unknown, double *step, int *changed)
{
    double gap[PART], normal[PART], slope[PART], target[PART];
    long node[PART], count = 0;
    *changed = 0;
    for (long k = 0; k <= f->nodes; k++) {
        if (k < f->nodes) {
            const double root = f->unscale ? f->root * f->unscale[k] : f->root;
            if (!(fabs(step[k]) * root > 0.1)) continue;
            gap[count] = unknown[k] * root + f->initial_gap[k];
            node[count++] = k;
        }
        if (count < PART && (k < f->nodes || !count)) continue;
        f->law->normal(count, f->law->parameters, gap, normal, slope);
        for (long l = 0; l < count; l++) {
            const double root = f->unscale ? f->root * f->unscale[node[l]] : f->root;
            target[l] = gap[l] + normal[l] / stiffness - (1.0 + slope[l] / stiffness) * root * step[node[l]];
        }
        gaps_of_regularised(f->law, count, target, stiffness, target);
        for (long l = 0; l < count; l++)
            step[node[l]] = -(target[l] - gap[l]) / (f->unscale ? f->root * f->unscale[node[l]] : f->root);
        *changed = 1;
        count = 0;
    }
}
