/* The core-zone preconditioner of the displacement form (solvers/core_zone.py and core_blocks.py have its
   mathematics), set up and applied; under arc length the load is eliminated besides. */
#include "kernels.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double at_or_one(const double *x, long k)
{
    return x ? x[k] : 1.0;
}

static long nodes_of_box(const Form *f)
{
    return f->response->shape[0] * f->response->shape[1];
}

/* The node of a line of n that continues it at k: around, by mirror images (even fields) or by its
   ends. */
static long continued(long k, long n, int wraps, int mirrors)
{
    if (k >= 0 && k < n) return k;
    if (wraps) return k < 0 ? k + n : k - n;
    if (mirrors) return k < 0 ? -k : 2 * n - 2 - k;
    return k < 0 ? 0 : n - 1;
}

/* Running mean of 2 reach + 1 numbers along a row. */
static void mean_along(const double *from, double *to, long n, long reach, int wraps, int mirrors)
{
    const double width = 2 * reach + 1;
    double sum = 0.0;
    for (long k = -reach; k <= reach; k++) sum += from[continued(k, n, wraps, mirrors)];
    to[0] = sum / width;
    for (long k = 1; k < n; k++) {
        sum += from[continued(k + reach, n, wraps, mirrors)]
            - from[continued(k - reach - 1, n, wraps, mirrors)];
        to[k] = sum / width;
    }
}

/* The same across n rows of some columns, whose sums are kept. */
CLONES static void mean_across(const double *from, double *to, double *restrict sums, const long *shape,
                               long reach, int wraps, int mirrors)
{
    const long n = shape[0], c = shape[1];
    const double width = 2 * reach + 1;
    memset(sums, 0, c * sizeof *sums);
    for (long j = -reach; j < reach; j++) {
        const double *restrict row = from + continued(j, n, wraps, mirrors) * c;
        for (long k = 0; k < c; k++) sums[k] += row[k];
    }
    for (long j = 0; j < n; j++) {
        const double *restrict next = from + continued(j + reach, n, wraps, mirrors) * c;
        const double *restrict old = from + continued(j - reach, n, wraps, mirrors) * c;
        double *restrict out = to + j * c;
        for (long k = 0; k < c; k++) {
            sums[k] += next[k];
            out[k] = sums[k] / width;
            sums[k] -= old[k];
        }
    }
}

static void smooth_axis(const Zone *z, double **mask, double **blur, int axis, int even)
{
    const long *shape = z->form->response->shape, reach = z->reach[axis], c = shape[1];
    const int wraps = (int)z->wraps[axis];
    for (int turn = 0; turn < 3 && reach; turn++) {
        if (axis == 0) mean_across(*mask, *blur, z->sums, shape, reach, wraps, even);
        else
            for (long j = 0; j < shape[0]; j++)
                mean_along(*mask + j * c, *blur + j * c, c, reach, wraps, even);
        double *swap = *mask;
        *mask = *blur;
        *blur = swap;
    }
}

/* Weights of the core, 0 to 1, of one box into z->mask, which is zero before. */
static void smooth(Zone *z, const double *tangent, double level, int even)
{
    const Response *r = z->form->response;
    const long n = nodes_of_box(z->form), known = r->picked ? r->picked : n;
    double *mask = z->mask, *blur = z->blur;
    int any = 0;
    for (long k = 0; k < known; k++) {
        mask[r->picked ? r->in_box[k] : k] = tangent[k] > level;
        any |= tangent[k] > level;
    }
    if (!any) return;
    if (z->form->response->shape[0] > 1) smooth_axis(z, &mask, &blur, 0, even);
    smooth_axis(z, &mask, &blur, 1, even);
    for (long k = 0; k < n; k++)
        /* running sums leave rounding where they have passed the last value */
        blur[k] = fabs(mask[k]) < 1e-12 ? 0.0 : mask[k] < 1.0 ? mask[k] : 1.0;
    if (blur != z->mask) memcpy(z->mask, blur, n * sizeof *blur);
}

static void widen(Block *b, const long *shape, const double *weight, int even, long *last)
{
    for (long j = 0; j < shape[0]; j++)
        for (long k = 0; k < shape[1]; k++)
            if (weight[j * shape[1] + k] > 0.0) {
                if (j < b->first[0]) b->first[0] = j;
                if (k < b->first[1]) b->first[1] = k;
                if (j > last[0]) last[0] = j;
                if (k > last[1]) last[1] = k;
            }
    if (even) b->first[0] = b->first[1] = 0;
}

static double largest(const double *x, long n)
{
    double most = x[0];
    for (long k = 1; k < n; k++) most = x[k] > most ? x[k] : most;
    return most;
}

/* The same of picked nodes: those of the core, their weights and mean tangent, and its extent. */
static int find_picked(Zone *z, Block *b, const double *tangent, double level)
{
    const Response *r = z->form->response;
    const long c = r->shape[1];
    long last[2] = {-1, -1};
    double count = 0.0, sum = 0.0;
    memset(z->mask, 0, nodes_of_box(z->form) * sizeof *z->mask);
    smooth(z, tangent, level, 0);
    b->picked = 0;
    for (long k = 0; k < r->picked; k++) {
        const double w = z->mask[r->in_box[k]];
        const long place[2] = {r->in_box[k] / c, r->in_box[k] % c};
        if (!(w > 0.0)) continue;
        b->node[b->picked] = (int)k;
        b->into[b->picked] = b->back[b->picked] = sqrt(w);
        b->outside[b->picked++] = 1.0 - w;
        for (int axis = 0; axis < 2; axis++) {
            if (place[axis] < b->first[axis]) b->first[axis] = place[axis];
            if (place[axis] > last[axis]) last[axis] = place[axis];
        }
        count += w;
        sum += w * tangent[k];
    }
    b->mean[0] = sum / (count > 0.0 ? count : 1.0);
    for (int axis = 0; axis < 2; axis++) b->extent[axis] = last[axis] + 1 - b->first[axis];
    return 1;
}

/* Weight of each node of the window, in b->outside until the block has taken it; mean tangents; extent. */
CLONES static int find_core(Zone *z, long i)
{
    const Form *f = z->form;
    const long n = nodes_of_box(f), *shape = f->response->shape, m = f->components;
    const double *tangent = f->tangent + (i * m + i) * f->nodes;
    const double most = largest(tangent, f->nodes), level = z->threshold * (most < 1.0 ? most : 1.0);
    const int even = (int)f->response->transform->even;
    Block *b = &z->block[i];
    long last[2] = {-1, -1};
    b->on = most > 1e-6;
    if (!b->on) return 0;
    b->first[0] = shape[0];
    b->first[1] = shape[1];
    if (f->response->picked) return find_picked(z, b, tangent, level);
    for (long box = 0; box < f->response->boxes; box++) {
        double count = 0.0, sum = 0.0;
        memset(z->mask, 0, n * sizeof *z->mask);
        smooth(z, tangent + box * n, level, even);
        widen(b, shape, z->mask, even, last);
        for (long k = 0; k < n; k++) {
            const double w = z->mask[k] * at_or_one(f->weight, k);
            count += w;
            sum += w * tangent[box * n + k];
        }
        b->mean[box] = sum / (count > 0.0 ? count : 1.0);
        memcpy(b->outside + box * n, z->mask, n * sizeof *z->mask);
    }
    for (int axis = 0; axis < 2; axis++) b->extent[axis] = last[axis] + 1 - b->first[axis];
    return 1;
}

CLONES static void keep_weights(Zone *z, Block *b)
{
    const Form *f = z->form;
    const long *shape = f->response->shape, n = nodes_of_box(f);
    long at = 0;
    for (long box = 0; box < f->response->boxes && !f->response->picked; box++)
        for (long j = 0; j < b->extent[0]; j++)
            for (long k = 0; k < b->extent[1]; k++, at++) {
                const long node = (b->first[0] + j) * shape[1] + b->first[1] + k;
                /* what is written never lies beyond what is read */
                const double w = b->outside[box * n + node], root = sqrt(w);
                b->outside[at] = 1.0 - w;
                b->into[at] = root * at_or_one(f->unscale, node);
                b->back[at] = root * at_or_one(f->scale, node);
            }
}

static long rounded(double extent) /* up to a sixteenth of its power of two */
{
    long unit = 1;
    while (extent >= 32.0 * unit) unit *= 2;
    return (long)ceil(extent / unit) * unit;
}

static int find_circle(Zone *z, long i)
{
    Block *b = &z->block[i];
    const long first = rounded(z->pad * b->extent[0]), second = rounded(z->pad * b->extent[1]);
    for (int turn = 0; turn < 2; turn++) {
        for (long k = 0; k < z->circle_count[i]; k++) {
            b->circle = &z->circles[i][k];
            if (b->circle->raw[0] == first && b->circle->raw[1] == second) return 0;
        }
        if (turn == 0 && z->missing(i, first, second)) break;
    }
    return 1;
}

/* The block's circle for the precision of the form's products: its symbol and, of picked nodes, their
   places on it. */
static Transform *circle_of(const Zone *z, Block *b)
{
    const Form *f = z->form;
    const Response *r = f->response;
    Transform *t = f->single ? b->circle->quick : b->circle->transform;
    char *symbol = b->circle->symbol;
    double gain = 1.0;
    if (b->made == f->single) return t;
    for (int axis = 0; axis < 2; axis++) {
        const long n = t->shape[axis];
        if (t->even) gain *= n == 1 ? 1.0 : t->line[axis].closed ? 2.0 * (n - 1) : 2.0 * n;
        else gain *= n;
    }
    for (long box = 0; box < r->boxes; box++)
        invert(t, b->circle->compliance, b->mean[box], gain,
               symbol + box * t->waves * (f->single ? sizeof(float) : sizeof(double)));
    for (long k = 0; k < b->picked; k++) {
        const long place = r->in_box[b->node[k]], c = r->shape[1];
        b->at[k] = (int)place_of(t, place / c - b->first[0], place % c - b->first[1]);
    }
    b->made = f->single;
    return t;
}

static int apply_block(const Zone *z, Block *b, double *field)
{
    const Response *response = z->form->response;
    const long *shape = response->shape, n = nodes_of_box(z->form), *e = b->extent;
    const long boxes = response->boxes;
    Transform *t = circle_of(z, b);
    double *first = field + b->first[0] * shape[1] + b->first[1];
    int status;
    long at = 0;
    if (response->picked) put_nodes(t, 0, b->at, b->node, b->into, field, b->picked);
    for (long box = 0; box < boxes && !response->picked; box++)
        for (long j = 0; j < e[0]; j++, at += e[1])
            put_row(t, box, j, b->into + at, first + box * n + j * shape[1], e[1]);
    if ((status = filter(t, e, b->circle->symbol))) return status;
    at = 0;
    if (response->picked) blend_nodes(t, 0, b->at, b->node, b->outside, b->back, field, b->picked);
    for (long box = 0; box < boxes && !response->picked; box++)
        for (long j = 0; j < e[0]; j++, at += e[1])
            blend_row(t, box, j, b->outside + at, b->back + at, first + box * n + j * shape[1], e[1]);
    return 0;
}

/* sums of D field over each box */
CLONES static void by_box(const Zone *z, long i, const double *field, double *sums)
{
    const Form *f = z->form;
    const long n = nodes_of_box(f);
    const double *restrict d = f->tangent + (i * f->components + i) * f->nodes;
    for (long box = 0; box < f->response->boxes; box++) {
        sums[box] = 0.0;
        for (long k = 0; k < n; k++) sums[box] += d[box * n + k] * field[box * n + k];
    }
}

static int apply_component(Zone *z, long i, double *field)
{
    Block *b = &z->block[i];
    const long boxes = z->form->response->boxes, n = nodes_of_box(z->form);
    if (!b->on) return 0;
    int status = apply_block(z, b, field);
    if (status || boxes == 1) return status;
    double *sums = b->mean + boxes;
    by_box(z, i, field, sums);
    for (long a = 0; a < boxes; a++) {
        double change = 0.0;
        for (long c = 0; c < boxes; c++) change += b->inverse[a * boxes + c] * sums[c];
        for (long k = 0; k < n; k++) field[a * n + k] -= change * b->column[a * n + k];
    }
    return 0;
}

/* Boxes know of each other as a whole: inverse = (1 + k R)^-1 k, singular values at least 0.1, R the
   response of each to its column (core_blocks.CoupledBlock). */
static int couple_boxes(Zone *z, long i)
{
    Block *b = &z->block[i];
    const long m = z->form->response->boxes, n = z->form->nodes;
    double *sums = b->mean + m, *matrix = b->inverse, *between = matrix + m * m;
    for (long k = 0; k < n; k++) b->column[k] = 1.0;
    int status = apply_block(z, b, b->column);
    if (status) return status;
    by_box(z, i, b->column, sums);
    memcpy(between, z->between[i], m * m * sizeof *between);
    for (long a = 0; a < m; a++) between[a * m + a] = z->kernel_at_zero[i] - b->circle->no_lag;
    for (long a = 0; a < m; a++)
        for (long c = 0; c < m; c++) matrix[a * m + c] = between[a * m + c] * sums[c] + (a == c);
    pseudo_inverse(matrix, m, 0.1, matrix + 2 * m * m);
    double *result = matrix + 2 * m * m;
    for (long a = 0; a < m; a++)
        for (long c = 0; c < m; c++) {
            double value = 0.0;
            for (long d = 0; d < m; d++) value += matrix[a * m + d] * between[d * m + c];
            result[a * m + c] = value;
        }
    memcpy(matrix, result, m * m * sizeof *matrix);
    return 0;
}

/* Replaces a matrix by its inverse, singular values at least `floor`; without a floor those below
   1e-13 of the largest have none, and a matrix that is next to nothing is left out. One-sided Jacobi
   rotations (Golub and Van Loan, Matrix Computations, section 8.6.3); work: 3 n n + n. */
void pseudo_inverse(double *matrix, long n, double floor, double *work)
{
    double *u = work, *v = work + n * n, *s = work + 2 * n * n, most = 0.0;
    for (long k = 0; k < n * n; k++) most = fabs(matrix[k]) > most ? fabs(matrix[k]) : most;
    if (floor == 0.0 && (most < 1e-100 || n == 1)) {
        for (long k = 0; k < n * n; k++) matrix[k] = most < 1e-100 ? 0.0 : 1.0 / matrix[k];
        return;
    }
    for (long k = 0; k < n * n; k++) {
        u[k] = matrix[k];
        v[k] = k / n == k % n;
    }
    for (int sweep = 0, turned = 1; turned && sweep < 60; sweep++) {
        turned = 0;
        for (long p = 0; p < n; p++)
            for (long q = p + 1; q < n; q++) {
                double a = 0.0, b = 0.0, c = 0.0;
                for (long k = 0; k < n; k++) {
                    a += u[k * n + p] * u[k * n + p];
                    b += u[k * n + q] * u[k * n + q];
                    c += u[k * n + p] * u[k * n + q];
                }
                if (!(fabs(c) > 1e-15 * sqrt(a * b)) || c == 0.0) continue;
                turned = 1;
                const double tau = (b - a) / (2.0 * c);
                const double t = (tau >= 0.0 ? 1.0 : -1.0) / (fabs(tau) + sqrt(1.0 + tau * tau));
                const double cs = 1.0 / sqrt(1.0 + t * t), sn = cs * t;
                for (long k = 0; k < n; k++) {
                    const double up = u[k * n + p], vp = v[k * n + p];
                    u[k * n + p] = cs * up - sn * u[k * n + q];
                    u[k * n + q] = sn * up + cs * u[k * n + q];
                    v[k * n + p] = cs * vp - sn * v[k * n + q];
                    v[k * n + q] = sn * vp + cs * v[k * n + q];
                }
            }
    }
    most = 0.0;
    for (long p = 0; p < n; p++) {
        s[p] = 0.0;
        for (long k = 0; k < n; k++) s[p] += u[k * n + p] * u[k * n + p];
        s[p] = sqrt(s[p]);
        most = s[p] > most ? s[p] : most;
    }
    for (long a = 0; a < n; a++)
        for (long b = 0; b < n; b++) {
            double value = 0.0;
            for (long p = 0; p < n; p++) {
                const double least = s[p] > floor ? s[p] : floor;
                if (s[p] > (floor > 0.0 ? 0.0 : 1e-13 * most))
                    value += v[a * n + p] / least * u[b * n + p] / s[p];
            }
            matrix[a * n + b] = value;
        }
}

static int is_forced(const Form *f, long i)
{
    for (long row = 0; row < f->forced_count; row++)
        if (f->forced[row] == i) return 1;
    return 0;
}

/* sum over the cell of what component i of the law answers to component j of a field of this form */
CLONES static double answer(const Form *f, long i, long j, const double *field)
{
    const long n = f->nodes;
    const double *restrict d = f->tangent + (i * f->components + j) * n;
    const double *restrict w = f->scale ? f->scale : f->weight; /* weight / scale is scale */
    double sum = 0.0;
    if (w)
        for (long k = 0; k < n; k++) sum += w[k] * d[k] * field[k];
    else
        for (long k = 0; k < n; k++) sum += d[k] * field[k];
    return sum;
}

static double count_acting(const Form *f)
{
    double count = 0.0;
    for (long k = 0; k < f->nodes; k++)
        if (f->tangent[k] != 0.0) count += at_or_one(f->weight, k);
    return count > 1.0 ? count : 1.0;
}

static int eliminate_means(Zone *z)
{
    const Form *f = z->form;
    const long n = f->nodes, q = z->mean_count;
    double scale[MOST], work[4 * MOST * MOST], *matrix = z->inverse;
    for (long place = 0; place < q; place++) {
        const long i = z->means[place];
        double *column = z->columns + place * n;
        for (long k = 0; k < n; k++) column[k] = at_or_one(f->scale, k);
        int status = apply_component(z, i, column);
        if (status) return status;
        for (long row = 0; row < q; row++)
            matrix[row * q + place] = answer(f, z->means[row], i, column);
    }
    for (long row = 0; row < q; row++) {
        const long i = z->means[row];
        scale[row] = 1.0;
        if (is_forced(f, i)) {
            matrix[row * q + row] += f->drag[i];
            scale[row] = count_acting(f);
        } else {
            for (long k = 0; k < q; k++) matrix[row * q + k] *= f->rigid[i] / f->size;
            matrix[row * q + row] += 1.0;
        }
        for (long k = 0; k < q; k++) matrix[row * q + k] /= scale[row];
    }
    if (q) pseudo_inverse(matrix, q, z->floor, work);
    for (long row = 0; row < q; row++)
        for (long k = 0; k < q; k++) matrix[row * q + k] /= scale[k];
    return 0;
}

CLONES static int apply_zone(Zone *z, const double *vector, double *out)
{
    const Form *f = z->form;
    const long n = f->nodes, m = f->components, q = z->mean_count;
    double right[MOST], scalar[MOST] = {0};
    memcpy(out, vector, (m * n + f->forced_count) * sizeof *out);
    for (long i = 0; i < m; i++) {
        int status = apply_component(z, i, out + i * n);
        if (status) return status;
    }
    for (long row = 0; row < q; row++) {
        const long i = z->means[row];
        right[row] = 0.0;
        for (long j = 0; j < m; j++) right[row] -= answer(f, i, j, out + j * n);
        if (!is_forced(f, i)) right[row] *= f->rigid[i] / f->size;
        for (long k = 0; k < f->forced_count; k++)
            if (f->forced[k] == i) right[row] += vector[m * n + k] / (f->row_scale[i] * f->root);
    }
    for (long row = 0; row < q; row++) {
        const long i = z->means[row];
        double mean = 0.0, *restrict x = out + i * n, *restrict column = z->columns + row * n;
        for (long k = 0; k < q; k++) mean += z->inverse[row * q + k] * right[k];
        for (long k = 0; k < n; k++) x[k] += mean * column[k];
        scalar[i] = mean * f->root;
    }
    for (long k = 0; k < f->forced_count; k++) out[m * n + k] = scalar[f->forced[k]];
    return 0;
}

CLONES static double inner(const double *restrict x, const double *restrict y, long n)
{
    double sum = 0.0;
    for (long k = 0; k < n; k++) sum += x[k] * y[k];
    return sum;
}

/* The zones of the form's tangent, as it is. */
int set_up(Zone *z)
{
    const Form *f = z->form;
    int status;
    z->set_ups++;
    for (long i = 0; i < f->components; i++) {
        if (!find_core(z, i)) continue;
        if (find_circle(z, i)) return 1;
        keep_weights(z, &z->block[i]);
        z->block[i].made = NONE;
        if (f->response->boxes > 1 && (status = couple_boxes(z, i))) return status;
    }
    if ((status = eliminate_means(z)) || !z->arc) return status;
    const long n = f->components * f->nodes + f->forced_count;
    status = apply_zone(z, z->arc->load_column, z->column);
    z->slope = inner(z->arc->tangent, z->column, n) - z->arc->rate;
    return status;
}

int precondition(Zone *z, const double *vector, double *out)
{
    const long n = z->form->components * z->form->nodes + z->form->forced_count;
    z->applications++;
    int status = apply_zone(z, vector, out);
    if (status || !z->arc) return status;
    const double slope = fabs(z->slope) > 1e-300 ? z->slope : 1.0;
    out[n] = (inner(z->arc->tangent, out, n) - vector[n]) / slope;
    for (long k = 0; k < n; k++) out[k] -= out[n] * z->column[k];
    return 0;
}
