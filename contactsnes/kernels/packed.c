/* Products with symbols in single precision for fields over a plane: two rows are transformed as one of
   complex numbers, whose FFTs take vectors of a processor as real ones do not, and columns block by block,
   there, times the symbol and back while the block is in the processor's cache.

   Rows a and b are one, z = a + i b, so that a wave of them is A = (Z(k) + conj Z(-k)) / 2 and
   B = (Z(k) - conj Z(-k)) / 2i. Symbols are column after column. */
#include "kernels.h"
#include <string.h>

enum { LINE = 4 }; /* pairs of rows whose numbers of a column are a line of the cache */

long packed_place(const Transform *t, long row, long column)
{
    return (row / 2) * 2 * t->shape[1] + row % 2 + 2 * column;
}

#define BODY "pairs.h"
#include "both.h"

void packed_clear_beyond(const Transform *t, const long *shape)
{
    if (t->single) packed_clear_beyond_in_single(t, shape);
    else packed_clear_beyond_in_double(t, shape);
}

void packed_put_row(const Transform *t, long field, long row, long first, const double *weight, const double *x,
                    long n)
{
    if (t->single) packed_put_row_in_single(t, field, row, first, weight, x, n);
    else packed_put_row_in_double(t, field, row, first, weight, x, n);
}

void packed_take_row(const Transform *t, long field, long row, double mean, double factor, const double *scale,
                     const double *own, double *out, long n)
{
    if (t->single) packed_take_row_in_single(t, field, row, mean, factor, scale, own, out, n);
    else packed_take_row_in_double(t, field, row, mean, factor, scale, own, out, n);
}

CLONES void packed_blend_row(const Transform *t, long field, long row, const double *restrict into,
                             const double *restrict back, const double *x, double *out, long n)
{
    const float *restrict r = row_of_in_single(t, field, row);
    for (long k = 0; k < n; k++) out[k] = x[k] + back[k] * (r[2 * k] - into[k] * x[k]);
}

/* waves of some columns of a field's rows, a column after the other, zero beyond the rows used: a line of the
   cache of each column at a time, as columns may all have their places in one set of the cache */
CLONES static void gather(const Transform *t, long field, long first, long columns, long used)
{
    const long r = t->shape[0], c = t->shape[1];
    float *restrict to = (float *)t->block + field * COLUMNS * 2 * r;
    const long pairs = (used + 1) / 2;
    for (long begin = 0; begin < pairs; begin += LINE)
        for (long k = 0; k < columns; k++) {
            const long here = 2 * (first + k), there = here ? 2 * c - here : 0;
            const long end = begin + LINE < pairs ? begin + LINE : pairs;
            const float *restrict z = field_of_in_single(t, field) + begin * 2 * c;
            float *restrict o = to + 2 * (k * r + 2 * begin);
            for (long p = begin; p < end; p++, z += 2 * c, o += 4) {
                const float a = z[here], b = z[here + 1], d = z[there], e = z[there + 1];
                o[0] = 0.5f * (a + d);
                o[1] = 0.5f * (b - e);
                o[2] = 0.5f * (b + e);
                o[3] = 0.5f * (d - a);
            }
        }
    const long filled = used + used % 2;
    for (long k = 0; k < columns; k++)
        memset(to + 2 * (k * r + filled), 0, 2 * (r - filled) * sizeof *to);
    memset(to + 2 * columns * r, 0, 2 * (COLUMNS - columns) * r * sizeof *to);
}

CLONES static void scatter(const Transform *t, const float *found, long field, long first, long columns, long used)
{
    const long r = t->shape[0], c = t->shape[1];
    const float *restrict from = found + field * COLUMNS * 2 * r;
    for (long p = 0; p < (used + 1) / 2; p++) {
        float *restrict z = field_of_in_single(t, field) + p * 2 * c;
        for (long k = 0; k < columns; k++) {
            const long here = 2 * (first + k), there = 2 * c - here;
            const float *restrict o = from + 2 * (k * r + 2 * p);
            if (here == 0 || here == c) { /* rows are real: so are these waves of theirs */
                z[here] = o[0];
                z[here + 1] = o[2];
                continue;
            }
            z[here] = o[0] - o[3];
            z[here + 1] = o[1] + o[2];
            z[there] = o[0] + o[3];
            z[there + 1] = o[2] - o[1];
        }
    }
}

/* the blocks, or their transpose, times the waves of some columns, which go where the columns came from */
static void couple(const Response *r, long first, long columns, int transposed)
{
    const Transform *t = r->transform;
    const long rows = t->shape[0], n = columns * rows, m = r->boxes, wide = 2 * COLUMNS * rows;
    float *x = t->block, *waves = t->spectrum;
    memset(x, 0, t->count * wide * sizeof *x);
    for (long i = 0; i < r->components; i++)
        for (long j = 0; j < r->components; j++) {
            const long numbers = r->is_complex[i][j] ? 2 : 1;
            const float *s = r->symbol[i][j];
            if (!s) continue;
            for (long a = 0; a < m; a++)
                for (long b = 0; b < m; b++) {
                    const float *own = s + ((a * m + b) * t->waves + first * rows) * numbers;
                    const long to = transposed ? j * m + b : i * m + a;
                    const long from = transposed ? i * m + a : j * m + b;
                    add_times_in_single(x + to * wide, own, waves + from * wide, n, r->is_complex[i][j],
                                        transposed ? -1.0f : 1.0f);
                }
        }
}

/* Some columns of all fields, transformed, times symbols, and back. Out of place: in place FFTW would copy
   them besides. */
static void columns_of(const Transform *t, const Response *response, const float *symbol, long first,
                       long columns, long used, int transposed)
{
    const long r = t->shape[0];
    float *waves = t->spectrum, *found = t->block;
    for (long i = 0; i < t->count; i++) gather(t, i, first, columns, used);
    libraries.execute_rows(t->columns, t->block, waves);
    if (response && response->product) {
        couple(response, first, columns, transposed);
        waves = t->block;
        found = t->spectrum;
    } else
        for (long i = 0; i < t->count; i++) {
            const float *s = response ? response->symbol[i][i] : symbol + i * t->waves;
            times_in_single(waves + i * 2 * COLUMNS * r, s + first * r, columns * r);
        }
    libraries.execute_rows(t->columns_back, waves, found);
    for (long i = 0; i < t->count; i++) scatter(t, found, i, first, columns, used);
}

/* The rows of all fields that are used, transformed, or back, by way of a row of other memory. */
static void along(const Transform *t, void *plan, long used)
{
    const long c = t->shape[1];
    for (long i = 0; i < t->count; i++)
        for (long p = 0; p < (used + 1) / 2; p++) {
            float *z = field_of_in_single(t, i) + p * 2 * c;
            libraries.execute_rows(plan, z, t->spectrum);
            memcpy(z, t->spectrum, 2 * c * sizeof *z);
        }
}

/* Fields on their circle times the blocks of a response or, without one, each times its symbol of some
   that stand in a row; only `used` rows are filled, and asked for. */
void packed_multiply(const Transform *t, const Response *response, const void *symbol, long used,
                     int transposed)
{
    const long waves = t->shape[1] / 2 + 1;
    along(t, t->forward, used);
    for (long first = 0; first < waves; first += COLUMNS) {
        const long columns = waves - first < COLUMNS ? waves - first : COLUMNS;
        columns_of(t, response, symbol, first, columns, used, transposed);
    }
    along(t, t->backward, used);
}

/* the symbol 1 / gain / (1 + C D), column after column */
CLONES void packed_invert(const Transform *t, const double *compliance, double stiffness, double gain,
                          float *restrict symbol)
{
    enum { TILE = 16 };
    const long rows = t->shape[0], waves = t->shape[1] / 2 + 1;
    float tile[TILE][TILE];
    for (long j = 0; j < rows; j += TILE)
        for (long k = 0; k < waves; k += TILE) {
            const long high = rows - j < TILE ? rows - j : TILE, wide = waves - k < TILE ? waves - k : TILE;
            for (long i = 0; i < high; i++) {
                const double *restrict c = compliance + (j + i) * waves + k;
                for (long l = 0; l < wide; l++) tile[i][l] = 1.0 / gain / (c[l] * stiffness + 1.0);
            }
            for (long l = 0; l < wide; l++)
                for (long i = 0; i < high; i++) symbol[(k + l) * rows + j + i] = tile[i][l];
        }
}
