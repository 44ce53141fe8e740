/* Krylov vectors in single precision or less, rows of floats or of short integers: sums over pieces of the
   vector are in double, a piece at a time for all rows, while it is in the cache. */
#include "kernels.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { PIECE = 1024, AT_ONCE = 4 };
static const double SHORTEST = 32767.0; /* largest of the short integers */

/* Pieces of rows, AT_ONCE of them at a time, so that a number of the vector is read once for all, and no sum
   waits for the one before: of floats in double precision, of short integers in floats, which hold these. */
#define PRODUCTS(KIND, REAL, DOT, ADD)                                                                      \
    CLONES static void DOT(long n, const KIND *restrict a, const KIND *restrict b, const KIND *restrict c,  \
                           const KIND *restrict d, const REAL *restrict v, double *found)                   \
    {                                                                                                       \
        REAL p = 0, q = 0, r = 0, s = 0;                                                                    \
        for (long i = 0; i < n; i++) {                                                                      \
            p += (REAL)a[i] * v[i];                                                                         \
            q += (REAL)b[i] * v[i];                                                                         \
            r += (REAL)c[i] * v[i];                                                                         \
            s += (REAL)d[i] * v[i];                                                                         \
        }                                                                                                   \
        found[0] = p;                                                                                       \
        found[1] = q;                                                                                       \
        found[2] = r;                                                                                       \
        found[3] = s;                                                                                       \
    }                                                                                                       \
    CLONES static void ADD(long n, const KIND *restrict a, const KIND *restrict b, const KIND *restrict c,  \
                           const KIND *restrict d, const double *factor, REAL *restrict v)                  \
    {                                                                                                       \
        const REAL p = factor[0], q = factor[1], r = factor[2], s = factor[3];                              \
        for (long i = 0; i < n; i++)                                                                        \
            v[i] += p * (REAL)a[i] + q * (REAL)b[i] + (r * (REAL)c[i] + s * (REAL)d[i]);                    \
    }
PRODUCTS(float, double, dot_floats, add_floats)
PRODUCTS(short, float, dot_shorts, add_shorts)
PRODUCTS(float, float, dot_singles, add_singles)

CLONES static void add_narrow(long n, const float *restrict x, double *restrict v)
{
    for (long i = 0; i < n; i++) v[i] += x[i];
}

/* the scale of a row's piece */
static double scale_of(const double *const *scales, long row, long from)
{
    return scales ? scales[row][from / PIECE] : 1.0;
}

/* Of rows k to k + AT_ONCE, the last of all in place of those beyond: where their pieces begin. */
static void places(const void *const *rows, long k, long count, long from, int is_short, const void **at)
{
    for (long j = 0; j < AT_ONCE; j++) {
        const void *row = rows[k + j < count ? k + j : count - 1];
        at[j] = is_short ? (const void *)((const short *)row + from) : (const void *)((const float *)row + from);
    }
}

CLONES static double square_of(long n, const double *restrict v)
{
    double square = 0.0;
    for (long i = 0; i < n; i++) square += v[i] * v[i];
    return square;
}

/* found[k] = inner product of row k and a vector of doubles, and last that of the vector with itself; of
   rows of floats there are no scales. */
void inner_products(long count, long size, const void *const *rows, const double *const *scales,
                    const double *vector, double *found)
{
    for (long k = 0; k <= count; k++) found[k] = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        const double *v = vector + from;
        float narrowed[PIECE];
        if (scales) narrow(v, narrowed, n);
        for (long k = 0; k < count; k += AT_ONCE) {
            const void *at[AT_ONCE];
            double sums[AT_ONCE];
            places(rows, k, count, from, scales != 0, at);
            if (scales) dot_shorts(n, at[0], at[1], at[2], at[3], narrowed, sums);
            else dot_floats(n, at[0], at[1], at[2], at[3], v, sums);
            for (long j = k; j < count && j < k + AT_ONCE; j++) found[j] += sums[j - k] * scale_of(scales, j, from);
        }
        found[count] += square_of(n, v);
    }
}

/* vector += sum over k of factors[k] times row k; its inner product with itself then. */
double add_rows(long count, long size, const void *const *rows, const double *const *scales,
                const double *factors, double *vector)
{
    double found = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        double *v = vector + from;
        float added[PIECE] = {0.0f};
        for (long k = 0; k < count; k += AT_ONCE) {
            const void *at[AT_ONCE];
            double own[AT_ONCE] = {0.0};
            places(rows, k, count, from, scales != 0, at);
            for (long j = k; j < count && j < k + AT_ONCE; j++) own[j - k] = factors[j] * scale_of(scales, j, from);
            if (scales) add_shorts(n, at[0], at[1], at[2], at[3], own, added);
            else add_floats(n, at[0], at[1], at[2], at[3], own, v);
        }
        if (scales) add_narrow(n, added, v);
        found += square_of(n, v);
    }
    return found;
}

CLONES static void round_piece(long n, double *restrict v, double factor, short *restrict row, double *scale)
{
    /* sizes of numbers are in the order of their bits, what is no number last: vectors compare these */
    long long most = 0;
    for (long i = 0; i < n; i++) {
        long long bits;
        memcpy(&bits, v + i, sizeof bits);
        bits &= 0x7fffffffffffffffLL;
        most = bits > most ? bits : most;
    }
    double largest;
    memcpy(&largest, &most, sizeof most);
    const int known = largest <= DBL_MAX; /* else its piece is none */
    const double own = *scale = known ? largest * factor / SHORTEST : NAN;
    const double inverse = known && largest > 0.0 ? SHORTEST / largest : 0.0;
    for (long i = 0; i < n; i++) {
        const double x = v[i] * inverse;
        const int whole = (int)(x + copysign(0.5, x));
        row[i] = whole;
        v[i] = whole * own;
    }
}

/* Rounds a vector times a positive factor to short integers times a scale for each piece, the row. */
void rounded(long size, double *vector, double factor, short *row, double *scales)
{
    for (long from = 0; from < size; from += PIECE)
        round_piece(size - from < PIECE ? size - from : PIECE, vector + from, factor, row + from,
                    scales + from / PIECE);
}

/* ---- one iteration whose vectors are in single precision throughout */

CLONES static double square_in_single(long n, const float *restrict v)
{
    double square = 0.0;
    for (long i = 0; i < n; i++) square += (double)v[i] * v[i];
    return square;
}

/* `inner_products` of a vector in single precision */
static void products_in_single(long count, long size, const void *const *rows, const double *const *scales,
                               const float *vector, double *found)
{
    for (long k = 0; k <= count; k++) found[k] = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        for (long k = 0; k < count; k += AT_ONCE) {
            const void *at[AT_ONCE];
            double sums[AT_ONCE];
            places(rows, k, count, from, scales != 0, at);
            if (scales) dot_shorts(n, at[0], at[1], at[2], at[3], vector + from, sums);
            else dot_singles(n, at[0], at[1], at[2], at[3], vector + from, sums);
            for (long j = k; j < count && j < k + AT_ONCE; j++) found[j] += sums[j - k] * scale_of(scales, j, from);
        }
        found[count] += square_in_single(n, vector + from);
    }
}

/* A piece of a vector += sign times the sum over k of factors[k] times row k. */
static void add_in_single(long count, long from, long n, const void *const *rows, const double *const *scales,
                          double sign, const double *factors, float *piece)
{
    for (long k = 0; k < count; k += AT_ONCE) {
        const void *at[AT_ONCE];
        double own[AT_ONCE] = {0.0};
        places(rows, k, count, from, scales != 0, at);
        for (long j = k; j < count && j < k + AT_ONCE; j++) own[j - k] = sign * factors[j] * scale_of(scales, j, from);
        if (scales) add_shorts(n, at[0], at[1], at[2], at[3], own, piece);
        else add_singles(n, at[0], at[1], at[2], at[3], own, piece);
    }
}

/* vector -= sum over k of factors[k] times row k; its inner product with itself then */
static double subtract_in_single(long count, long size, const void *const *rows, const double *const *scales,
                                 const double *factors, float *vector)
{
    double found = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        add_in_single(count, from, n, rows, scales, -1.0, factors, vector + from);
        found += square_in_single(n, vector + from);
    }
    return found;
}

CLONES static void round_single(long n, float *restrict v, double factor, short *restrict row, double *scale)
{
    int most = 0; /* as of `round_piece` */
    for (long i = 0; i < n; i++) {
        int bits;
        memcpy(&bits, v + i, sizeof bits);
        bits &= 0x7fffffff;
        most = bits > most ? bits : most;
    }
    float largest;
    memcpy(&largest, &most, sizeof most);
    const int known = largest <= FLT_MAX;
    const double exact = *scale = known ? largest * factor / SHORTEST : NAN;
    const float own = exact, inverse = known && largest > 0.0f ? SHORTEST / largest : 0.0;
    for (long i = 0; i < n; i++) {
        const float x = v[i] * inverse;
        const int whole = (int)(x + copysignf(0.5f, x));
        row[i] = whole;
        v[i] = whole * own;
    }
}

CLONES static void scale_single(long n, float *restrict v, float factor, float *restrict row)
{
    for (long i = 0; i < n; i++) row[i] = v[i] *= factor;
}

/* Takes a vector times a positive factor, in place, as a row: its pieces rounded where it has scales. */
static void keep(long size, float *vector, double factor, void *row, double *scales)
{
    if (!scales) scale_single(size, vector, factor, row);
    for (long from = 0; from < size && scales; from += PIECE)
        round_single(size - from < PIECE ? size - from : PIECE, vector + from, factor, (short *)row + from,
                     scales + from / PIECE);
}

/* The vector less what rows hold of it: found, its products with them and with itself, and its length then. */
static int leave_rows(const Form *f, long count, long size, const void *const *rows, const double *const *scales,
                      float *vector, double *found, double *length)
{
    products_in_single(count, size, rows, scales, vector, found);
    int status = add_up(f, found, count + 1);
    if (status) return status;
    *length = subtract_in_single(count, size, rows, scales, found, vector);
    status = add_up(f, length, 1);
    *length = sqrt(*length);
    return status;
}

/* An iteration: the vector times a factor becomes row number `place`; the preconditioner makes of it what fills
   `made`, which is rounded to short integers, `kept` with its scales, unless that is null; of the product with
   that the vector is what the rows leave. found: its products with these, and
   its length, 0 where they span it: what is shorter than `cancelled` times what it was is made orthogonal once
   more, and nothing below `left`. work: as many numbers as rows, and one more. */
int iterate(Form *f, Zone *z, long place, long size, void *const *rows, double *const *scales, double factor,
            float *vector, float *made, short *kept, double *kept_scales, double cancelled, double left,
            double *found, double *work)
{
    const void *const *known = (const void *const *)rows;
    const double *const *sizes = (const double *const *)scales;
    const long count = place + 1;
    double length;
    int status;
    keep(size, vector, factor, rows[place], scales ? scales[place] : 0);
    if ((status = precondition_in_single(z, vector, made))) return status;
    if (kept) keep(size, made, 1.0, kept, kept_scales);
    if ((status = product_in_single(f, made, vector))) return status;
    if ((status = leave_rows(f, count, size, known, sizes, vector, found, &length))) return status;
    const double before = sqrt(found[count]);
    if (length < cancelled * before) {
        if ((status = leave_rows(f, count, size, known, sizes, vector, work, &length))) return status;
        for (long k = 0; k < count; k++) found[k] += work[k];
    }
    found[count] = length > left * before ? length : 0.0;
    return 0;
}

/* A vector's numbers in single precision, one after another: in the vector's own memory from its begin or its
   middle on, or in any other. */
void narrowed(long size, const double *vector, float *out)
{
    float piece[PIECE];
    const long count = (size + PIECE - 1) / PIECE;
    for (long k = 0; k < count; k++) {
        /* behind the begin, from the last one on: they take the place of those that are done */
        const long from = (out > (const float *)vector ? count - 1 - k : k) * PIECE;
        const long n = size - from < PIECE ? size - from : PIECE;
        narrow(vector + from, piece, n);
        memcpy(out + from, piece, n * sizeof *piece);
    }
}

/* The same back, in place. */
static void widened(long size, double *vector)
{
    float piece[PIECE];
    for (long end = size; end > 0;) { /* from the last one on: they take the place of those behind them */
        const long n = end % PIECE ? end % PIECE : PIECE;
        end -= n;
        memcpy(piece, (float *)vector + end, n * sizeof *piece);
        widen(piece, vector + end, n);
    }
}

/* out = the sum of rows times factors or, if `asks`, what the preconditioner makes of that: in single
   precision, and in double at last. */
int sum_up(Zone *z, long count, long size, const void *const *rows, const double *const *scales,
           const double *factors, int asks, float *vector, double *out)
{
    float *sum = asks ? vector : (float *)out;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        float piece[PIECE] = {0.0f};
        add_in_single(count, from, n, rows, scales, 1.0, factors, piece);
        memcpy(sum + from, piece, n * sizeof *piece);
    }
    const int status = asks ? precondition_in_single(z, vector, (float *)out) : 0;
    widened(size, out);
    return status;
}

/* out += what two grids made of the sum of rows times factors, where that of what stood for patches is in their
   sums. */
void add_from_patches(const TwoGrids *g, long count, const void *const *rows, const double *const *scales,
                      const double *factors, double *out)
{
    for (long from = 0; from < g->nodes; from += PIECE) {
        const long n = g->nodes - from < PIECE ? g->nodes - from : PIECE;
        float piece[PIECE] = {0.0f};
        add_in_single(count, from, n, rows, scales, 1.0, factors, piece);
        add_on_two_grids(g, piece, from, n, out + from);
    }
}
