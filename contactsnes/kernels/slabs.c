/* Spectra that are shared out among processes (grid/slab_transform.py): each has some columns of waves,
   which are transformed block by block, times the symbols of a response and back while the block is in
   the processor's cache. */
#include "kernels.h"
#include <string.h>

enum { TILE = 16 }; /* rows of which a block is filled at a time */

#define BODY "columns.h"
#include "both.h"

/* The columns here, transformed there, times the symbols of a response unless that is null, and back. */
void along_columns(const Columns *c, int there, int back, const Response *r, int transposed)
{
    if (c->single) along_columns_in_single(c, there, back, r, transposed);
    else along_columns_in_double(c, there, back, r, transposed);
}

/* Some rows of a field to the blocks of those that get their columns; or back. */
void share_rows(const Shares *s, long field, long row, long count, void *x, int back)
{
    const long wide = s->first[s->parts] * s->size;
    for (long part = 0; part < s->parts; part++) {
        const long first = s->first[part] * s->size, n = s->first[part + 1] * s->size - first;
        char *block = s->packed + field * s->field + s->rows * first + row * n, *own = (char *)x + first;
        for (long j = 0; j < count; j++)
            if (back) memcpy(own + j * wide, block + j * n, n);
            else memcpy(block + j * n, own + j * wide, n);
    }
}

/* The columns here of a row: those of this process stay where it packed them, which spares a copy of them,
   others come one after another, `wide` numbers each. */
void *row_that_came(const Shares *s, long field, long row, void *others, long wide)
{
    const long mine = row - s->place;
    if (mine < 0 || mine >= s->rows) return (char *)others + row * wide * s->size;
    return s->packed + field * s->field + (s->rows * s->first[s->own] + mine * wide) * s->size;
}

static double *field_of(const Transform *t, long field)
{
    return (double *)t->real + field * t->shape[0] * t->shape[1];
}

/* The rows here of even or odd fields, of which the first `used` numbers hold anything, to what is sent; or
   back, as far as they are asked for. */
void even_rows(const Transform *t, const Shares *s, long used, int back)
{
    for (long i = 0; i < t->count; i++)
        for (long j = 0; j < t->shape[0]; j++) {
            double *x = field_of(t, i) + j * t->shape[1];
            if (back) share_rows(s, i, j, 1, x, back);
            along_rows(&t->line[1], x, 1, back, (int)t->odd[i][1], used, 0);
            if (!back) share_rows(s, i, j, 1, x, back);
        }
}

/* Some columns of the rows used, one after another, or back. */
static void pick(const Transform *t, const Shares *s, long field, long first, long columns, long used,
                 double *block, int back)
{
    const long r = t->shape[0];
    for (long from = 0; from < used; from += TILE) {
        const long last = from + TILE < used ? from + TILE : used;
        for (long j = from; j < last; j++) {
            double *row = (double *)row_that_came(s, field, j, field_of(t, field), t->shape[1]) + first;
            for (long k = 0; k < columns; k++)
                if (back) row[k] = block[k * r + j];
                else block[k * r + j] = row[k];
        }
    }
}

/* x = s x, or x += s y */
CLONES static void times(double *restrict x, const double *restrict s, const double *restrict y, long n)
{
    if (y)
        for (long k = 0; k < n; k++) x[k] += s[k] * y[k];
    else
        for (long k = 0; k < n; k++) x[k] *= s[k];
}

/* The columns here of even or odd fields: there, times the symbols of a response, and back. */
void even_columns(const Transform *t, const Shares *s, const Response *r, long used, int transposed)
{
    const long rows = t->shape[0], wide = COLUMNS * rows, all = t->count * wide;
    double *x = (double *)(void *)t->block, *product = r->product;
    for (long first = 0; first < t->shape[1]; first += COLUMNS) {
        const long rest = t->shape[1] - first, columns = rest < COLUMNS ? rest : COLUMNS;
        for (long i = 0; i < t->count; i++) {
            pick(t, s, i, first, columns, used, x + i * wide, 0);
            along_rows(&t->line[0], x + i * wide, columns, 0, (int)t->odd[i][0], used, 0);
        }
        if (product) {
            memcpy(product, x, all * sizeof *x);
            memset(x, 0, all * sizeof *x);
        }
        for (long i = 0; i < t->count; i++)
            for (long j = 0; j < t->count; j++) {
                const double *symbol = r->symbol[i][j];
                const long to = transposed ? j : i, from = transposed ? i : j;
                if (symbol)
                    times(x + to * wide, symbol + first * rows, product ? product + from * wide : 0,
                          columns * rows);
            }
        for (long i = 0; i < t->count; i++) {
            along_rows(&t->line[0], x + i * wide, columns, 1, (int)t->odd[i][0], used, 0);
            pick(t, s, i, first, columns, used, x + i * wide, 1);
        }
    }
}
