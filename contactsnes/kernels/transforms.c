/* The transforms of `precision.h` in double and single precision, and what chooses between these: a
   transform says which its numbers are of. */
#include "kernels.h"
#include <string.h>

struct Libraries libraries;

#define BODY "precision.h"
#include "both.h"

#define IN_ITS_PRECISION(t, name, ...) \
    do { \
        if ((t)->single) name##_in_single(__VA_ARGS__); \
        else name##_in_double(__VA_ARGS__); \
    } while (0)

/* Rows of an even field, or an odd one, one after another, from the axis outwards, in place; or back. The
   first `used` numbers of each hold anything, or are asked for. */
void along_rows(const Line *l, void *x, long count, int back, int odd, long used, int single)
{
    if (single) rows_in_single(l, x, count, back, odd, used);
    else rows_in_double(l, x, count, back, odd, used);
}

/* b (columns x rows) = transpose of a (rows x columns), or a that of b */
void turn_field(void *a, long rows, long columns, void *b, int back, int single)
{
    if (single && back) transpose_back_in_single(b, rows, columns, a, rows);
    else if (single) transpose_in_single(a, rows, columns, b, rows);
    else if (back) transpose_back_in_double(b, rows, columns, a, rows);
    else transpose_in_double(a, rows, columns, b, rows);
}

/* Two transforms in single precision count as one where there is a limit. */
static int counted(const Transform *t)
{
    double *c = t->counter;
    c[t->single ? 2 : 0] += t->cost;
    return c[0] + 0.5 * c[2] > c[1] ? TOO_MANY : 0;
}

/* real to spectrum; in the plane only the first `used` rows of an even field hold anything */
int forward(Transform *t, long used)
{
    IN_ITS_PRECISION(t, forward, t, used, t->shape[1]);
    return counted(t);
}

/* spectrum to real, of an even field in the plane the first `used` rows only */
int backward(Transform *t, long used)
{
    IN_ITS_PRECISION(t, backward, t, used, t->shape[1]);
    return counted(t);
}

/* zeros in the columns beyond a box, and in the rows beyond it that a transform reads */
void clear_beyond(const Transform *t, const long *shape)
{
    if (t->packed) packed_clear_beyond(t, shape);
    else IN_ITS_PRECISION(t, clear_beyond, t, shape);
}

/* x, or weight x, to a row of a field from its first column on */
void put_row(const Transform *t, long field, long row, long first, const double *weight, const double *x,
             long n)
{
    if (t->packed) packed_put_row(t, field, row, first, weight, x, n);
    else IN_ITS_PRECISION(t, put_row, t, field, row, first, weight, x, n);
}

/* zeros to a field */
void clear_field(const Transform *t, long field)
{
    const long n = t->shape[0] * t->shape[1] * (t->single ? sizeof(float) : sizeof(double));
    memset((char *)t->real + field * n, 0, n);
}

/* x to n places of a field */
void put_nodes(const Transform *t, long field, const int *at, const double *x, long n)
{
    IN_ITS_PRECISION(t, put_nodes, t, field, at, x, n);
}

/* out = (row - mean) factor scale + own; out may be own */
void take_row(const Transform *t, long field, long row, double mean, double factor, const double *scale,
              const double *own, double *out, long n)
{
    if (t->packed) packed_take_row(t, field, row, mean, factor, scale, own, out, n);
    else IN_ITS_PRECISION(t, take_row, t, field, row, mean, factor, scale, own, out, n);
}

/* the same without a scale from n places of a field */
void take_nodes(const Transform *t, long field, const int *at, double mean, double factor,
                const double *own, double *out, long n)
{
    IN_ITS_PRECISION(t, take_nodes, t, field, at, mean, factor, own, out, n);
}

/* out = x + back (row - into x); out may be x */
void blend_row(const Transform *t, long field, long row, const double *into, const double *back,
               const double *x, double *out, long n)
{
    if (t->packed) packed_blend_row(t, field, row, into, back, x, out, n);
    else IN_ITS_PRECISION(t, blend_row, t, field, row, into, back, x, out, n);
}

/* weight x of some nodes added to places of the first field, some of which several nodes have */
void add_nodes(const Transform *t, const int *at, const int *node, const double *weight, const double *x, long n)
{
    IN_ITS_PRECISION(t, add_nodes, t, at, node, weight, x, n);
}

/* x of some nodes less weight times (own weight x + what stands in places of the first field) */
void subtract_nodes(const Transform *t, const int *at, const int *node, const double *weight, double own, double *x,
                    long n)
{
    IN_ITS_PRECISION(t, subtract_nodes, t, at, node, weight, own, x, n);
}

/* where a node stands in a field */
long place_of(const Transform *t, long row, long column)
{
    return t->packed ? packed_place(t, row, column) : row * t->shape[1] + column;
}

/* What stands in boxes of a shape to its spectrum. */
static int there(Transform *t, const long *shape)
{
    if (!t->even) clear_beyond(t, shape);
    IN_ITS_PRECISION(t, forward, t, shape[0], shape[1]);
    return counted(t);
}

/* The same back: of even fields nothing else is known then. */
static int back(Transform *t, const long *shape)
{
    IN_ITS_PRECISION(t, backward, t, shape[0], shape[1]);
    return counted(t);
}

/* What stands in boxes of a shape times real symbols of its precision, one after another, in place. */
int filter(Transform *t, const long *shape, const void *symbol)
{
    int status;
    if (t->multiply) {
        clear_beyond(t, shape);
        return t->multiply(0, symbol, 0);
    }
    if (t->packed) {
        clear_beyond(t, shape);
        if (t->even) folded_multiply(t, 0, symbol, shape, 0);
        else packed_multiply(t, 0, symbol, shape[0], 0);
        return counted(t) || counted(t) ? TOO_MANY : 0;
    }
    if ((status = there(t, shape))) return status;
    for (long i = 0; i < t->count; i++)
        IN_ITS_PRECISION(t, filter, t, i,
                         (const char *)symbol + i * t->waves * (t->single ? sizeof(float) : sizeof(double)));
    return back(t, shape);
}

/* the symbol 1 / gain / (1 + C D) on a transform's waves, in its precision */
void invert(const Transform *t, const double *compliance, double stiffness, double gain, void *symbol)
{
    if (t->packed && t->even) folded_invert(t, compliance, stiffness, gain, symbol);
    else if (t->packed) packed_invert(t, compliance, stiffness, gain, symbol);
    else IN_ITS_PRECISION(t, invert, t->waves, compliance, stiffness, gain, symbol);
}

/* (whole - symbol) share in place of a symbol on a transform's waves */
void complement(const Transform *t, double whole, double share, void *symbol)
{
    IN_ITS_PRECISION(t, complement, t->waves, whole, share, symbol);
}

/* x += s y, or conj(s) y, for complex x and y and a symbol that is real or complex */
void add_times(double *x, const double *s, const double *y, long n, int is_complex, double sign)
{
    add_times_in_double(x, s, y, n, is_complex, sign);
}

/* The operator, or its transpose, times what stands in the transform's boxes, in place. */
int convolve(const Response *r, int transposed)
{
    Transform *t = r->transform;
    int status;
    if (t->packed && !r->on_circle) clear_beyond(t, r->shape); /* fields of picked nodes have been cleared */
    if (t->multiply) return t->multiply(r, 0, transposed);
    if (t->packed) {
        if (t->even) folded_multiply(t, r, 0, r->shape, transposed);
        else packed_multiply(t, r, 0, r->shape[0], transposed);
        return counted(t) || counted(t) ? TOO_MANY : 0;
    }
    if ((status = there(t, r->shape))) return status;
    IN_ITS_PRECISION(t, multiply, r, transposed);
    return back(t, r->shape);
}
