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
