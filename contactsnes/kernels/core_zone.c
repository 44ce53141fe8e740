/* The core-zone preconditioner of the displacement form (solvers/core_zone.py and core_blocks.py have its
   mathematics), set up and applied; under arc length the load is eliminated besides. */
#include "kernels.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double at_or_one(const double *x, long k)
{
    return x ? x[k] : 1.0;
}

static void copy(const double *from, double *to, long n)
{
    if (to != from) memcpy(to, from, n * sizeof *to);
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

enum { ACROSS = 16, ALONG = 8 }; /* columns, and rows, of a box that are blurred side by side */

typedef float Across __attribute__((vector_size(ACROSS * sizeof(float)), aligned(sizeof(float))));
typedef double Along __attribute__((vector_size(ALONG * sizeof(double)), aligned(sizeof(double))));

/* Sums of 2 reach + 1 places along n of them, each of a few lines side by side. */
#define SUMS(name, Side) \
CLONES static void name(const Side *restrict from, Side *restrict to, long n, long reach, int wraps, \
                        int mirrors) \
{ \
    Side sum = {0}; \
    for (long j = -reach; j < reach; j++) sum += from[continued(j, n, wraps, mirrors)]; \
    for (long j = 0; j < n; j++) { \
        sum += from[continued(j + reach, n, wraps, mirrors)]; \
        to[j] = sum; \
        sum -= from[continued(j - reach, n, wraps, mirrors)]; \
    } \
}

SUMS(sums_across, Across)
SUMS(sums_along, Along)

/* The first and last row and column in which a mask over a box holds; `seen` is room for columns. */
CLONES static void find_ends(const long *shape, const unsigned char *mask, unsigned char *seen, long *first,
                             long *last)
{
    const long n = shape[0], c = shape[1];
    memset(seen, 0, c);
    for (long j = 0; j < n; j++) {
        const unsigned char *restrict row = mask + j * c;
        unsigned char any = 0;
        for (long k = 0; k < c; k++) {
            seen[k] |= row[k];
            any |= row[k];
        }
        if (any && j < first[0]) first[0] = j;
        if (any && j > last[0]) last[0] = j;
    }
    for (long k = 0; k < c; k++) {
        if (seen[k] && k < first[1]) first[1] = k;
        if (seen[k] && k > last[1]) last[1] = k;
    }
}

/* Nodes of a box in the plane that are stiff, rows and columns that have such. */
CLONES static void find_stiff(const Zone *z, const double *tangent, double level, unsigned char *stiff,
                              long *first, long *last)
{
    const Response *r = z->form->response;
    const long n = r->shape[0], c = r->shape[1];
    if (r->picked) {
        memset(stiff, 0, n * c);
        for (long k = 0; k < r->picked; k++) stiff[r->in_box[k]] = tangent[k] > level;
    } else
        for (long k = 0; k < n * c; k++) stiff[k] = tangent[k] > level;
    find_ends(r->shape, stiff, (unsigned char *)z->sums, first, last);
}

static double cube(double x)
{
    return x * x * x;
}

/* Sums across the rows of a box, for its columns from the first to the last; zero in the others. */
CLONES static void blur_columns(const Blur *b, const unsigned char *stiff, long first, long last, int mirrors,
                                float *out)
{
    const long n = b->shape[0], c = b->shape[1], reach = b->reach[0];
    float *from = (float *)b->sums, *to = from + n * ACROSS;
    for (long j = 0; j < n; j++) {
        memset(out + j * c, 0, first * sizeof *out);
        memset(out + j * c + last + 1, 0, (c - last - 1) * sizeof *out);
    }
    for (long k = first; k <= last; k += ACROSS) {
        const long wide = last + 1 - k < ACROSS ? last + 1 - k : ACROSS;
        for (long j = 0; j < n; j++)
            for (long l = 0; l < ACROSS; l++) from[j * ACROSS + l] = l < wide ? stiff[j * c + k + l] : 0;
        for (int turn = 0; turn < 3 && reach; turn++) {
            sums_across((Across *)from, (Across *)to, n, reach, (int)b->wraps[0], mirrors);
            float *swap = from;
            from = to;
            to = swap;
        }
        for (long j = 0; j < n; j++)
            for (long l = 0; l < wide; l++) out[j * c + k + l] = from[j * ACROSS + l];
    }
}

/* Sums along at most ALONG rows, as weights 0 to 1, one row after another. */
CLONES static void blur_rows(const Blur *b, const float *rows, long count, int mirrors, double *weights)
{
    const long c = b->shape[1], reach = b->reach[1];
    const double gain = 1.0 / (cube(2 * b->reach[0] + 1) * cube(2 * reach + 1));
    double *from = b->sums, *to = from + c * ALONG;
    for (long l = 0; l < ALONG; l++)
        for (long k = 0; k < c; k++) from[k * ALONG + l] = l < count ? rows[l * c + k] : 0.0f;
    for (int turn = 0; turn < 3 && reach; turn++) {
        sums_along((Along *)from, (Along *)to, c, reach, (int)b->wraps[1], mirrors);
        double *swap = from;
        from = to;
        to = swap;
    }
    for (long l = 0; l < count; l++) {
        double *restrict weight = weights + l * c;
        for (long k = 0; k < c; k++) {
            const double w = from[k * ALONG + l] * gain;
            weight[k] = w < 1e-12 ? 0.0 : w < 1.0 ? w : 1.0;
        }
    }
}

/* Weights 0 to 1 of rows of a mask over a box, blurred: of those from the first on, so many. */
void smooth_mask(const Blur *b, const unsigned char *mask, int mirrors, long first_row, long count,
                 float *sums, double *out)
{
    long first[2] = {LONG_MAX, LONG_MAX}, last[2] = {-1, -1};
    const long c = b->shape[1], reach = 3 * b->reach[0];
    find_ends(b->shape, mask, (unsigned char *)b->sums, first, last);
    /* rows that the blur comes to */
    const long begin = last[0] < 0 ? count : first[0] - reach - first_row;
    const long low = begin < 0 ? 0 : begin < count ? begin : count;
    const long end = last[0] + reach + 1 - first_row, high = end < low ? low : end < count ? end : count;
    memset(out, 0, low * c * sizeof *out);
    memset(out + high * c, 0, (count - high) * c * sizeof *out);
    if (low == high) return;
    blur_columns(b, mask, first[1], last[1], 0, sums);
    for (long j = low; j < high; j += ALONG)
        blur_rows(b, sums + (first_row + j) * c, high - j < ALONG ? high - j : ALONG, mirrors, out + j * c);
}

/* The extent of a core whose stiff nodes, somewhere in all boxes, lie between two places: as far as a
   blur reaches, and from a row of even number on where rows are on both sides of a plane's axis. */
static void set_extent(const Zone *z, Block *b, const long *first, const long *last, const int *even)
{
    for (int axis = 0; axis < 2; axis++) {
        const long n = z->form->response->shape[axis], margin = 3 * z->reach[axis];
        long low = first[axis] - margin, high = last[axis] + margin;
        if ((low < 0 || high >= n) && z->wraps[axis]) low = 0, high = n - 1;
        low = low < 0 || even[axis] ? 0 : low;
        if (axis == 0 && even[1] && !even[0]) low -= low % 2;
        high = high < n ? high : n - 1;
        b->first[axis] = low;
        b->extent[axis] = high + 1 - low;
    }
}

/* What of a row of weights the block keeps, and its part of their sum and of the tangent's. */
CLONES static void keep_row(const Form *f, Block *b, const double *restrict weight, const double *restrict tangent,
                            long node, long at, double *restrict count, double *restrict sum)
{
    const long n = b->extent[1];
    double *restrict into = b->into + at, *restrict back = b->back + at;
    double whole = 0.0, stiffness = 0.0;
    for (long k = 0; k < n; k++) {
        const double w = weight[k], own = f->weight ? w * f->weight[node + k] : w;
        whole += own;
        stiffness += own * tangent[k];
    }
    *count += whole;
    *sum += stiffness;
    if (f->scale)
        for (long k = 0; k < n; k++) {
            const double root = sqrt(weight[k]);
            back[k] = root * f->scale[node + k];
            into[k] = root * f->unscale[node + k];
        }
    else
        for (long k = 0; k < n; k++) into[k] = sqrt(weight[k]);
}

/* The core in the plane: weights 0 or 1 of its nodes, blurred. Sums of these are exact: they are scaled
   once, at the end. Of picked nodes weights are left in z->mask. */
CLONES static void find_plane(Zone *z, Block *b, const double *tangent, double level, const int *even)
{
    const Form *f = z->form;
    const Response *r = f->response;
    const long n = nodes_of_box(f), c = r->shape[1];
    const Blur blur = {{r->shape[0], c}, {z->reach[0], z->reach[1]}, {z->wraps[0], z->wraps[1]}, z->sums};
    float *sums = (float *)z->blur;
    unsigned char *stiff = (unsigned char *)(sums + n);
    long first[2] = {LONG_MAX, LONG_MAX}, last[2] = {-1, -1}, at = 0;
    for (long box = 0; box < r->boxes; box++) find_stiff(z, tangent + box * n, level, stiff, first, last);
    set_extent(z, b, first, last, even);
    for (long box = 0; box < r->boxes; box++) {
        const double *d = tangent + box * n;
        double count = 0.0, sum = 0.0;
        if (r->boxes > 1) {
            first[1] = LONG_MAX;
            last[1] = -1;
            find_stiff(z, d, level, stiff, first, last);
            if (last[1] < 0) first[1] = last[1] = 0;
        }
        blur_columns(&blur, stiff, first[1], last[1], even[0], sums);
        for (long j = b->first[0]; j < b->first[0] + b->extent[0]; j += ALONG) {
            const long rest = b->first[0] + b->extent[0] - j, rows = rest < ALONG ? rest : ALONG;
            double *weight = z->mask + (r->picked ? j * c : 0) + b->first[1];
            blur_rows(&blur, sums + j * c, rows, even[1], weight - b->first[1]);
            for (long l = 0; l < rows && !r->picked; l++, at += b->extent[1]) {
                const long node = (j + l) * c + b->first[1];
                keep_row(f, b, weight + l * c, d + node, node, at, &count, &sum);
            }
        }
        b->mean[box] = sum / (count > 0.0 ? count : 1.0);
    }
}

/* Sums of 2 reach + 1 numbers along a line of n, from one node to before another: the others hold zero. */
static void sums_of_line(const long *restrict from, long *restrict to, long n, long reach, int wraps,
                         int mirrors, long low, long high)
{
    const long inner = low > reach ? low : reach + 1, outer = high < n - reach ? high : n - reach;
    long sum = 0, k = low;
    for (long j = low - reach; j < low + reach; j++) sum += from[continued(j, n, wraps, mirrors)];
    while (k < high) {
        for (; k < high && (k < inner || k >= outer); k++) {
            to[k] = sum += from[continued(k + reach, n, wraps, mirrors)];
            sum -= from[continued(k - reach, n, wraps, mirrors)];
        }
        for (; k < outer && k >= inner; k++) {
            to[k] = sum += from[k + reach];
            sum -= from[k - reach];
        }
    }
}

/* Weights of the core of a box of a line, 0 to 1, blurred; the first node that has one and the last, if
   they lie beyond what is known of others. */
CLONES static void smooth_line(const Zone *z, const double *restrict tangent, double level, int even,
                               double *restrict out, long *first, long *last)
{
    const long n = z->form->response->shape[1], reach = z->reach[1], margin = 3 * reach;
    const double gain = 1.0 / cube(2 * reach + 1);
    long *mask = (long *)z->mask, *blur = (long *)z->blur, low = 0, high = n;
    while (high > 0 && !(tangent[high - 1] > level)) high--;
    while (low < high && !(tangent[low] > level)) low++;
    if ((low < margin || high > n - margin) && z->wraps[1]) low = 0, high = n;
    low = low < margin ? 0 : low - margin;
    high = high < n - margin ? high + margin : n;
    memset(blur, 0, n * sizeof *blur);
    for (long k = 0; k < n; k++) mask[k] = tangent[k] > level;
    for (int turn = 0; turn < 3 && reach; turn++) {
        sums_of_line(mask, blur, n, reach, (int)z->wraps[1], even, low, high);
        long *swap = mask;
        mask = blur;
        blur = swap;
    }
    memset(out, 0, n * sizeof *out);
    for (long k = low; k < high; k++) {
        const double weight = mask[k] * gain;
        out[k] = weight < 1e-12 ? 0.0 : weight < 1.0 ? weight : 1.0;
    }
    while (high > low && !(out[high - 1] > 0.0)) high--;
    while (low < high && !(out[low] > 0.0)) low++;
    *first = low < *first && low < high ? low : *first;
    *last = high - 1 > *last && low < high ? high - 1 : *last;
}

/* The core among picked nodes, whose weights in their box are in z->mask. */
static void keep_picked(Zone *z, Block *b, const double *tangent)
{
    const Response *r = z->form->response;
    const long c = r->shape[1];
    double count = 0.0, sum = 0.0;
    long first[2] = {LONG_MAX, LONG_MAX}, last[2] = {-1, -1};
    const long low = b->first[0] * c, high = (b->first[0] + b->extent[0]) * c;
    b->picked = 0;
    for (long k = 0; k < r->picked; k++) {
        const long here = r->in_box[k];
        const double w = here >= low && here < high ? z->mask[here] : 0.0;
        const long place[2] = {here / c, here % c};
        if (!(w > 0.0)) continue;
        b->node[b->picked] = (int)k;
        b->into[b->picked] = sqrt(w);
        b->picked++;
        for (int axis = 0; axis < 2; axis++) {
            if (place[axis] < first[axis]) first[axis] = place[axis];
            if (place[axis] > last[axis]) last[axis] = place[axis];
        }
        count += w;
        sum += w * tangent[k];
    }
    b->mean[0] = sum / (count > 0.0 ? count : 1.0);
    for (int axis = 0; axis < 2; axis++) {
        b->first[axis] = first[axis];
        b->extent[axis] = last[axis] + 1 - first[axis];
    }
}

/* The core on a line. */
CLONES static void find_line(Zone *z, Block *b, const double *tangent, double level, int even)
{
    const Form *f = z->form;
    const long n = nodes_of_box(f), boxes = f->response->boxes;
    long first = n, last = -1, at = 0;
    for (long box = 0; box < boxes; box++) {
        /* they stay there until the block has taken them: what is written never lies beyond */
        double *weight = b->into + box * n;
        smooth_line(z, tangent + box * n, level, even, weight, &first, &last);
    }
    b->first[0] = 0;
    b->extent[0] = 1;
    b->first[1] = even ? 0 : first;
    b->extent[1] = last + 1 - b->first[1];
    for (long box = 0; box < boxes; box++, at += b->extent[1]) {
        double count = 0.0, sum = 0.0;
        memcpy(z->mask, b->into + box * n + b->first[1], b->extent[1] * sizeof *z->mask);
        keep_row(f, b, z->mask, tangent + box * n + b->first[1], b->first[1], at, &count, &sum);
        b->mean[box] = sum / (count > 0.0 ? count : 1.0);
    }
}

/* The core of a component: its extent, weights and mean tangents; whether there is one. */
static int find_core(Zone *z, long i)
{
    const Form *f = z->form;
    const double *tangent = f->tangent + (i * f->components + i) * f->nodes;
    const double most = largest_of(tangent[0], tangent, f->nodes), level = z->threshold * (most < 1.0 ? most : 1.0);
    const Transform *t = f->response->transform;
    const int even[2] = {t->even && !t->both[0], t->even && !t->both[1]};
    Block *b = &z->block[i];
    b->on = most > 1e-6;
    if (!b->on) return 0;
    if (f->response->shape[0] > 1) find_plane(z, b, tangent, level, even);
    else find_line(z, b, tangent, level, even[1]);
    if (f->response->picked) keep_picked(z, b, tangent);
    return 1;
}

static long rounded_up(double extent) /* up to a sixteenth of its power of two */
{
    long unit = 1;
    while (extent >= 32.0 * unit) unit *= 2;
    return (long)ceil(extent / unit) * unit;
}

/* Patches of a core: how many nodes each has, and where the first one begins: they are those of the cell. */
static void find_patches(const Zone *z, Block *b, long i)
{
    b->apart = 0;
    for (long k = 0; k < PATCHES && z->patched && !b->apart; k++) {
        const double product = z->shortest[i][k] * b->mean[0];
        if (!(z->shortest[i][k] > 0.0) || product > z->left[k]) continue;
        b->apart = z->sizes[k];
        b->within = product / (1.0 + product);
    }
    for (int axis = 0; axis < 2; axis++)
        b->before[axis] = b->apart ? (z->start[axis] + b->first[axis]) % b->apart : 0;
}

static int find_circle(Zone *z, long i)
{
    Block *b = &z->block[i];
    const long *both = z->form->response->transform->both;
    long asked[2];
    find_patches(z, b, i);
    for (int axis = 0; axis < 2; axis++) {
        const long extent = b->extent[axis] + b->before[axis];
        asked[axis] = rounded_up(z->pad * (both[axis] ? extent / 2 + 1 : extent)); /* points from an axis outwards */
    }
    const long first = asked[0], second = asked[1], apart = b->apart ? b->apart : 1;
    for (int turn = 0; turn < 2; turn++) {
        for (long k = 0; k < z->circle_count[i]; k++) {
            const Circle *c = b->circle = &z->circles[i][k];
            if (c->raw[0] == first && c->raw[1] == second && c->apart == apart) return 0;
        }
        if (turn == 0 && z->missing(i, first, second, apart)) break;
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
    if (b->apart) complement(t, (1.0 - b->within) / gain, 1.0 / (b->apart * b->apart), symbol);
    for (long k = 0; k < b->picked; k++) {
        const long place = r->in_box[b->node[k]], c = r->shape[1];
        const long row = place / c - b->first[0] + b->before[0], column = place % c - b->first[1] + b->before[1];
        b->at[k] = (int)place_of(t, row / b->apart, column / b->apart);
    }
    b->made = f->single;
    return t;
}

/* weights times the first nodes of rows, `apart` from each other, to those of a transform's field */
void put_box(const Transform *t, long field, const long *extent, const double *weight, const double *x,
             long apart)
{
    for (long j = 0; j < extent[0]; j++)
        put_row(t, field, j, 0, weight + j * extent[1], x + j * apart, extent[1]);
}

/* x = x + back (field - into x) for these nodes */
void blend_box(const Transform *t, long field, const long *extent, const double *into, const double *back,
               double *x, long apart)
{
    for (long j = 0; j < extent[0]; j++, into += extent[1], back += extent[1], x += apart)
        blend_row(t, field, j, into, back, x, x, extent[1]);
}

/* The block times a field, to another one or in place. */
static int apply_block(const Zone *z, Block *b, const double *field, double *out)
{
    const Response *response = z->form->response;
    const long *shape = response->shape, n = nodes_of_box(z->form), *e = b->extent;
    const long boxes = response->boxes, c = shape[1], right = b->first[1] + e[1];
    Transform *t = circle_of(z, b);
    int status;
    long at = 0;
    if (b->apart) return apply_patched(z, b, t, field, out);
    for (long box = 0; box < boxes; box++, at += e[0] * e[1])
        put_box(t, box, e, b->into + at, field + box * n + b->first[0] * c + b->first[1], c);
    if ((status = filter(t, e, b->circle->symbol))) return status;
    at = 0;
    for (long box = 0; box < boxes; box++) {
        const double *x = field + box * n;
        double *y = out + box * n;
        copy(x, y, b->first[0] * c);
        for (long j = b->first[0]; j < b->first[0] + e[0]; j++, at += e[1]) {
            const long row = j * c, first = row + b->first[1];
            copy(x + row, y + row, b->first[1]);
            blend_row(t, box, j - b->first[0], b->into + at, b->back + at, x + first, y + first, e[1]);
            copy(x + row + right, y + row + right, c - right);
        }
        copy(x + (b->first[0] + e[0]) * c, y + (b->first[0] + e[0]) * c, n - (b->first[0] + e[0]) * c);
    }
    return 0;
}

/* The block of one box times a field in single precision, row by row in doubles that stay in the cache. */
static int apply_block_in_single(const Zone *z, Block *b, const float *field, float *out)
{
    const long c = z->form->response->shape[1], *e = b->extent, left = b->first[1];
    Transform *t = circle_of(z, b);
    double row[c];
    int status;
    if (b->apart) return apply_patched_in_single(z, b, t, field, out);
    for (long j = 0; j < e[0]; j++) {
        const float *x = field + (b->first[0] + j) * c + left;
        widen(x, row, e[1]);
        put_row(t, 0, j, 0, b->into + j * e[1], row, e[1]);
    }
    if ((status = filter(t, e, b->circle->symbol))) return status;
    memcpy(out, field, nodes_of_box(z->form) * sizeof *out);
    for (long j = 0; j < e[0]; j++) {
        float *y = out + (b->first[0] + j) * c + left;
        widen(y, row, e[1]);
        blend_row(t, 0, j, b->into + j * e[1], b->back + j * e[1], row, row, e[1]);
        narrow(row, y, e[1]);
    }
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

static int apply_component(Zone *z, long i, const double *from, double *field)
{
    Block *b = &z->block[i];
    const long boxes = z->form->response->boxes, n = nodes_of_box(z->form);
    if (z->grids[i]) return on_two_grids(z->grids[i], from, field);
    if (!b->on) {
        copy(from, field, z->form->nodes);
        return 0;
    }
    int status = apply_block(z, b, from, field);
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
    int status = apply_block(z, b, b->column, b->column);
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

/* Sums over the nodes that are here of what each component of the law answers to fields. */
void answers(const Form *f, const double *fields, double *sums)
{
    for (long i = 0; i < f->components; i++) {
        sums[i] = 0.0;
        for (long j = 0; j < f->components; j++) sums[i] += answer(f, i, j, fields + j * f->nodes);
    }
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
        int status = apply_component(z, i, column, column);
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
    for (long i = 0; i < m; i++) {
        int status = apply_component(z, i, vector + i * n, out + i * n);
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

enum { SOME = 1024 }; /* nodes whose fields stay in the cache */

/* What `answer` sums up of some nodes of a field in single precision. */
CLONES static double answer_in_single(const Form *f, long i, long j, long at, long n, const float *restrict field)
{
    const double *restrict d = f->tangent + (i * f->components + j) * f->nodes + at;
    const double *restrict w = f->scale ? f->scale : f->weight;
    double sum = 0.0;
    if (w)
        for (long k = 0; k < n; k++) sum += w[at + k] * d[k] * field[k];
    else
        for (long k = 0; k < n; k++) sum += d[k] * field[k];
    return sum;
}

CLONES static void add_column(double mean, const double *restrict column, float *restrict x, long n)
{
    for (long k = 0; k < n; k++) x[k] += mean * column[k];
}

/* The preconditioner of a form without arc length times a vector in single precision, of one box all of whose
   nodes the form has. */
int precondition_in_single(Zone *z, const float *vector, float *out)
{
    const Form *f = z->form;
    const long n = f->nodes, m = f->components, q = z->mean_count;
    double right[MOST] = {0}, scalar[MOST] = {0};
    int status;
    z->applications++;
    if (z->elsewhere) return z->elsewhere(vector, out);
    for (long i = 0; i < m; i++) {
        const float *x = vector + i * n;
        status = 0;
        if (z->grids[i]) status = on_two_grids_of_floats(z->grids[i], x, out + i * n);
        else if (z->block[i].on) status = apply_block_in_single(z, &z->block[i], x, out + i * n);
        else memcpy(out + i * n, x, n * sizeof *out);
        if (status) return status;
    }
    for (long at = 0; at < n && q; at += SOME)
        for (long row = 0; row < q; row++)
            for (long j = 0; j < m; j++)
                right[row] -= answer_in_single(f, z->means[row], j, at, n - at < SOME ? n - at : SOME,
                                               out + j * n + at);
    for (long row = 0; row < q; row++) {
        const long i = z->means[row];
        if (!is_forced(f, i)) right[row] *= f->rigid[i] / f->size;
        for (long k = 0; k < f->held; k++)
            if (f->forced[k] == i) right[row] += vector[m * n + k] / (f->row_scale[i] * f->root);
    }
    if (q && (status = add_up(f, right, q))) return status;
    for (long row = 0; row < q; row++) {
        double mean = 0.0;
        for (long k = 0; k < q; k++) mean += z->inverse[row * q + k] * right[k];
        add_column(mean, z->columns + row * n, out + z->means[row] * n, n);
        scalar[z->means[row]] = mean * f->root;
    }
    for (long k = 0; k < f->held; k++) out[m * n + k] = scalar[f->forced[k]];
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
        if (z->grids[i] || !find_core(z, i)) continue;
        if (find_circle(z, i)) return 1;
        z->block[i].made = NONE;
        if (f->response->boxes > 1 && (status = couple_boxes(z, i))) return status;
    }
    if ((status = eliminate_means(z)) || !z->arc) return status;
    const long n = f->components * f->nodes + f->forced_count;
    load_column(z->form, z->arc, z->column);
    status = apply_zone(z, z->column, z->column);
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
