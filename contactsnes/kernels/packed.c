/* Products with symbols for fields over a plane: two rows are transformed as one of complex numbers, whose FFTs
   take vectors of a processor as real ones do not, and columns block by block, there, times the symbol and back
   while the block is in the processor's cache.

   Rows a and b are one, z = a + i b, so that a wave of them is A = (Z(k) + conj Z(-k)) / 2 and
   B = (Z(k) - conj Z(-k)) / 2i. Symbols are column after column. */
#include "kernels.h"
#include <string.h>

enum { LINE = 4 }; /* pairs of rows whose numbers of a column are a line of the cache */

long packed_place(const Transform *t, long row, long column)
{
    return (row / 2) * 2 * width_of(t) + row % 2 + 2 * column;
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

void packed_blend_row(const Transform *t, long field, long row, const double *into, const double *back,
                      const double *x, double *out, long n)
{
    if (t->single) packed_blend_row_in_single(t, field, row, into, back, x, out, n);
    else packed_blend_row_in_double(t, field, row, into, back, x, out, n);
}

/* Fields on their circle times the blocks of a response or, without one, each times its symbol of some
   that stand in a row; only `used` rows are filled, and asked for. */
void packed_multiply(const Transform *t, const Response *response, const void *symbol, long used,
                     int transposed)
{
    if (t->single) packed_multiply_in_single(t, response, symbol, used, transposed);
    else packed_multiply_in_double(t, response, symbol, used, transposed);
}

/* The same of slabs, in steps between which processes exchange waves: rows, columns, and rows back. */
void shared_rows(const Transform *t, const Shares *s, const Response *response, int back)
{
    if (t->single) shared_rows_in_single(t, s, response, back);
    else shared_rows_in_double(t, s, response, back);
}

void shared_columns(const Transform *t, const Shares *s, const Response *response, const void *symbol,
                    int transposed)
{
    if (t->single) shared_columns_in_single(t, s, response, symbol, transposed);
    else shared_columns_in_double(t, s, response, symbol, transposed);
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
