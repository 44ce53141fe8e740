/* Products with symbols in single precision for even and odd fields over a plane, as `packed.c` for others:
   two rows, and then two columns, are one of complex numbers, to which the transforms of `precision.h`,
   which are linear, apply as they are. Columns are transformed block by block, times the symbol, and back
   while the block is in the processor's cache.

   Symbols are pair after pair of columns, the two side by side. */
#include "kernels.h"
#include <string.h>

enum { SOME = 4, PAIRS = COLUMNS / 2 }; /* complex numbers of a vector; pairs of columns of a block */

typedef float Vector __attribute__((vector_size(2 * SOME * sizeof(float)), aligned(sizeof(float))));
typedef int Order __attribute__((vector_size(2 * SOME * sizeof(int))));

static const Order REVERSED = {6, 7, 4, 5, 2, 3, 0, 1}, SWAPPED = {1, 0, 3, 2, 5, 4, 7, 6};

static float *field_of(const Transform *t, long field)
{
    return (float *)t->real + field * (t->shape[0] + t->shape[0] % 2) * t->shape[1];
}

/* a pair of rows: of slabs, those of this process lie elsewhere */
static float *pair_of(const Transform *t, const Shares *s, long field, long pair)
{
    return s ? row_that_came(s, field, pair, field_of(t, field), t->shape[1])
             : field_of(t, field) + 2 * pair * t->shape[1];
}

/* to w, for k from 1 on, what stands at n - k, times a sign */
CLONES static void mirror(const float *restrict x, float *restrict w, long n, float sign)
{
    long k = 1;
    for (; k + SOME <= n; k += SOME) {
        const Vector there = *(const Vector *)(x + 2 * (n - k - SOME + 1));
        *(Vector *)(w + 2 * k) = sign * __builtin_shuffle(there, REVERSED);
    }
    for (; k < n; k++) {
        w[2 * k] = sign * x[2 * (n - k)];
        w[2 * k + 1] = sign * x[2 * (n - k) + 1];
    }
}

/* w = (x_k - i x_(n-k)) exp(i pi k / 2n) */
CLONES static void turn(const Line *l, const float *restrict x, float *restrict w)
{
    const long n = l->points;
    const float *restrict along = l->turn, *restrict across = along + 2 * n;
    const Vector sign = {1, -1, 1, -1, 1, -1, 1, -1};
    long k = 1;
    w[0] = x[0];
    w[1] = x[1];
    for (; k + SOME <= n; k += SOME) {
        const Vector there = __builtin_shuffle(*(const Vector *)(x + 2 * (n - k - SOME + 1)), REVERSED);
        const Vector u = *(const Vector *)(x + 2 * k) + sign * __builtin_shuffle(there, SWAPPED);
        *(Vector *)(w + 2 * k) = u * *(const Vector *)(along + 2 * k)
            + __builtin_shuffle(u, SWAPPED) * *(const Vector *)(across + 2 * k);
    }
    for (; k < n; k++) {
        const float u = x[2 * k] + x[2 * (n - k) + 1], v = x[2 * k + 1] - x[2 * (n - k)];
        w[2 * k] = u * along[2 * k] + v * across[2 * k];
        w[2 * k + 1] = v * along[2 * k + 1] + u * across[2 * k + 1];
    }
}

/* x = w_k exp(-i pi k / 2n) + w_(n-k) exp(i pi k / 2n) */
CLONES static void turn_back(const Line *l, const float *restrict w, float *restrict x)
{
    const long n = l->points;
    const float *restrict along = l->turn, *restrict across = along + 2 * n;
    long k = 1;
    x[0] = 2 * w[0];
    x[1] = 2 * w[1];
    for (; k + SOME <= n; k += SOME) {
        const Vector there = __builtin_shuffle(*(const Vector *)(w + 2 * (n - k - SOME + 1)), REVERSED);
        const Vector here = *(const Vector *)(w + 2 * k);
        *(Vector *)(x + 2 * k) = (here + there) * *(const Vector *)(along + 2 * k)
            + __builtin_shuffle(there - here, SWAPPED) * *(const Vector *)(across + 2 * k);
    }
    for (; k < n; k++) {
        const float u = w[2 * k], v = w[2 * k + 1], a = w[2 * (n - k)], b = w[2 * (n - k) + 1];
        x[2 * k] = (u + a) * along[2 * k] + (b - v) * across[2 * k];
        x[2 * k + 1] = (v + b) * along[2 * k + 1] + (a - u) * across[2 * k + 1];
    }
}

/* changes the signs of waves of odd number */
static void alternate(const Line *l, float *x)
{
    for (long k = 2 * ((l->points + 1) / 2); k < 2 * l->points; k++) x[k] = -x[k];
}

/* what a line's FFT takes, from x, which does not survive */
static void enter(const Line *l, float *restrict x, float *restrict w, int back, long odd)
{
    const long n = l->points, m = n - 1;
    if (l->closed) {
        if (odd) x[0] = x[1] = x[2 * m] = x[2 * m + 1] = 0.0f;
        memcpy(w, x, 2 * n * sizeof *w);
        mirror(x, w + 2 * m, m, odd ? -1.0f : 1.0f);
        return;
    }
    if (odd && back) alternate(l, x);
    if (back) {
        memcpy(w, x, 2 * n * sizeof *w);
        return;
    }
    if (odd) {
        x[0] = x[1] = 0.0f;
        mirror(x, w, n, 1.0f);
        memcpy(x + 2, w + 2, 2 * (n - 1) * sizeof *x);
    }
    turn(l, x, w);
}

/* what comes from it */
CLONES static void leave(const Line *l, float *restrict w, float *restrict x, int back, long odd)
{
    const long n = l->points;
    if (l->closed && odd) {
        for (long k = 0; k < n; k++) { /* i w */
            x[2 * k] = -w[2 * k + 1];
            x[2 * k + 1] = w[2 * k];
        }
        x[0] = x[1] = x[2 * n - 2] = x[2 * n - 1] = 0.0f;
    } else if (l->closed || !back) {
        memcpy(x, w, 2 * n * sizeof *x);
        if (odd) alternate(l, x);
    } else {
        turn_back(l, w, x);
        if (odd) {
            mirror(x, w, n, 1.0f);
            memcpy(x + 2, w + 2, 2 * (n - 1) * sizeof *x);
            x[0] = x[1] = 0.0f;
        }
    }
}

/* Some lines, `apart` complex numbers from each other, transformed in place. */
static void lines(const Line *l, float *x, long apart, long count, int back, long odd)
{
    const long wide = 2 * (l->closed ? 2 * (l->points - 1) : l->points + l->points % 2);
    float *w = l->row, *found = l->half; /* in place FFTW would copy them besides */
    for (long done = 0; done < count; done += PAIRS) {
        const long some = count - done < PAIRS ? count - done : PAIRS;
        float *first = x + done * 2 * apart;
        for (long i = 0; i < some; i++) enter(l, first + i * 2 * apart, w + i * wide, back, odd);
        libraries.execute_single(l->closed || back ? l->to_half : l->to_row);
        for (long i = 0; i < some; i++) leave(l, found + i * wide, first + i * 2 * apart, back, odd);
    }
}

/* Some columns of a field's rows, pair after pair, zero beyond the rows used. */
CLONES static void gather(const Transform *t, const Shares *s, long field, long first, long columns, long used)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), pairs = (columns + 1) / 2;
    const long filled = used + used % 2;
    float *restrict to = t->block + field * PAIRS * apart;
    for (long p = 0; p < filled / 2; p++) {
        const float *restrict z = pair_of(t, s, field, p) + 2 * first;
        for (long q = 0; q < pairs; q++) {
            const int two = 2 * q + 1 < columns;
            float *restrict o = to + q * apart + 4 * p;
            o[0] = z[4 * q];
            o[1] = two ? z[4 * q + 2] : 0.0f;
            o[2] = z[4 * q + 1];
            o[3] = two ? z[4 * q + 3] : 0.0f;
        }
    }
    for (long q = 0; q < pairs; q++) memset(to + q * apart + 2 * used, 0, (apart - 2 * used) * sizeof *to);
}

CLONES static void scatter(const Transform *t, const Shares *s, long field, long first, long columns,
                           long used)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), pairs = (columns + 1) / 2;
    const float *restrict from = t->block + field * PAIRS * apart;
    for (long p = 0; p < (used + 1) / 2; p++) {
        float *restrict z = pair_of(t, s, field, p) + 2 * first;
        for (long q = 0; q < pairs; q++) {
            const float *restrict o = from + q * apart + 4 * p;
            z[4 * q] = o[0];
            z[4 * q + 1] = o[2];
            if (2 * q + 1 == columns) break;
            z[4 * q + 2] = o[1];
            z[4 * q + 3] = o[3];
        }
    }
}

/* x = s x, or x += s y, for a pair of columns */
CLONES static void times(float *restrict x, const float *restrict s, long n)
{
    for (long k = 0; k < n; k++) x[k] *= s[k];
}

CLONES static void add(float *restrict x, const float *restrict s, const float *restrict y, long n)
{
    for (long k = 0; k < n; k++) x[k] += s[k] * y[k];
}

/* the symbols of a response, or each field's own, times the columns of a block */
static void multiply(const Transform *t, const Response *response, const float *symbol, long first,
                     long pairs, int transposed)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), wide = PAIRS * apart, at = first * r;
    const int coupled = response && response->product;
    float *x = t->block, *y = coupled ? response->product : 0;
    if (coupled) {
        memcpy(y, x, t->count * wide * sizeof *x);
        memset(x, 0, t->count * wide * sizeof *x);
    }
    for (long i = 0; i < t->count; i++)
        for (long j = 0; j < t->count; j++) {
            const float *s = response ? response->symbol[i][j] : i == j ? symbol + i * t->waves : 0;
            const long to = transposed ? j : i, from = transposed ? i : j;
            for (long q = 0; q < pairs && s; q++) {
                const float *own = s + at + q * 2 * r;
                if (coupled) add(x + to * wide + q * apart, own, y + from * wide + q * apart, 2 * r);
                else if (i == j) times(x + i * wide + q * apart, own, 2 * r);
            }
        }
}

/* The rows of all fields, of which some are used, transformed; or back. Of slabs they go to what is sent
   while they are in the processor's cache, or come from there. */
void folded_rows(const Transform *t, const Shares *s, long used, int back)
{
    const long c = t->shape[1], pairs = (used + 1) / 2;
    for (long i = 0; i < t->count; i++)
        for (long p = 0; p < pairs; p += PAIRS) {
            const long some = pairs - p < PAIRS ? pairs - p : PAIRS;
            float *x = field_of(t, i) + 2 * p * c;
            if (s && back) share_rows(s, i, p, some, x, back);
            lines(&t->line[1], x, c, some, back, t->odd[i][1]);
            if (s && !back) share_rows(s, i, p, some, x, back);
        }
}

/* The columns of rows that are transformed: there, times symbols, and back. */
void folded_columns(const Transform *t, const Shares *s, const Response *response, const float *symbol,
                    long used, int transposed)
{
    const long r = t->shape[0], c = t->shape[1], apart = r + r % 2, wide = PAIRS * 2 * apart;
    for (long first = 0; first < c; first += COLUMNS) {
        const long columns = c - first < COLUMNS ? c - first : COLUMNS, pairs = (columns + 1) / 2;
        for (long i = 0; i < t->count; i++) {
            gather(t, s, i, first, columns, used);
            lines(&t->line[0], t->block + i * wide, apart, pairs, 0, t->odd[i][0]);
        }
        multiply(t, response, symbol, first, pairs, transposed);
        for (long i = 0; i < t->count; i++) {
            lines(&t->line[0], t->block + i * wide, apart, pairs, 1, t->odd[i][0]);
            scatter(t, s, i, first, columns, used);
        }
    }
}

/* As `packed_multiply`. */
void folded_multiply(const Transform *t, const Response *response, const float *symbol, long used,
                     int transposed)
{
    folded_rows(t, 0, used, 0);
    folded_columns(t, 0, response, symbol, used, transposed);
    folded_rows(t, 0, used, 1);
}

/* the symbol 1 / gain / (1 + C D), pair after pair, from compliances column after column */
CLONES void folded_invert(const Transform *t, const double *restrict compliance, double stiffness,
                          double gain, float *restrict symbol)
{
    const long r = t->shape[0], c = t->shape[1];
    for (long k = 0; k < c; k++) {
        float *restrict s = symbol + (k / 2) * 2 * r + k % 2;
        for (long j = 0; j < r; j++) s[2 * j] = 1.0 / gain / (compliance[k * r + j] * stiffness + 1.0);
        for (long j = 0; j < r && k == c - 1 && c % 2; j++) s[2 * j + 1] = 0.0f;
    }
}
