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

/* Some rows of a field, or of a part of one, to the blocks of others that get their columns; or back. */
void share_rows(const Shares *s, long field, long row, long count, void *x, int back)
{
    const long wide = s->wide * s->size;
    char *block = s->packed + field * s->fields[1];
    for (long part = 0; part < s->parts; part++) {
        const long first = s->first[part] * s->size, n = s->first[part + 1] * s->size - first;
        char *own = (char *)x + first;
        if (part == s->own) continue;
        for (long j = 0; j < count; j++)
            if (back) memcpy(own + j * wide, block + (row + j) * n, n);
            else memcpy(block + (row + j) * n, own + j * wide, n);
        block += s->rows * n;
    }
}

/* The columns here of a row, which is another's, or this process's own. */
void *row_that_came(const Shares *s, long field, long row)
{
    const long mine = row - s->place, first = s->first[s->own], wide = s->first[s->own + 1] - first;
    const long before = mine * s->wide + field % s->sides * s->first[s->parts] + first;
    if (mine >= 0 && mine < s->rows) return s->here + field / s->sides * s->fields[0] + before * s->size;
    return s->came + field * s->fields[2] + (mine < 0 ? row : row - s->rows) * wide * s->size;
}
