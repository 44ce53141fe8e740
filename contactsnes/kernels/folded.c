/* Products with symbols for even and odd fields over a plane, as `packed.c` for others: two rows, and then two
   columns, are one of complex numbers, to which the transforms of `precision.h`, which are linear, apply as they
   are. Columns are transformed block by block, times the symbol, and back while the block is in the processor's
   cache. In double precision, too: FFTs of complex numbers take half of the time of two real ones.

   Where fields have a mirror in one direction only, they are on both sides of the axis in the other one: they are
   parted there into what is even and what is odd, each transformed as such.

   Symbols are pair after pair of columns, the two side by side. */
#include "kernels.h"
#include <string.h>

enum { SOME = 4, PAIRS = COLUMNS / 2 }; /* complex numbers of a vector; pairs of columns of a block */

/* what shuffles vectors: whole numbers of the size of theirs */
typedef long long Order_in_double __attribute__((vector_size(2 * SOME * sizeof(double))));
typedef int Order_in_single __attribute__((vector_size(2 * SOME * sizeof(float))));

/* even and odd parts of a field where these are told apart */
static long parts_of(const Transform *t)
{
    return t->both[0] || t->both[1] ? 2 : 1;
}

/* whether n numbers are all of a direction that closes on itself, the first of which is its own image */
static int is_whole(const Line *l, long n)
{
    return l->closed && n == 2 * (l->points - 1);
}

#define BODY "folded.h"
#include "both.h"

/* The rows of all fields, of which some are used, transformed; or back. Of slabs they go to what is sent
   while they are in the processor's cache, or come from there. Of rows on both sides of the axis so many `columns`
   are used. */
void folded_rows(const Transform *t, const Shares *s, long used, long columns, int back)
{
    if (t->single) folded_rows_in_single(t, s, used, columns, back);
    else folded_rows_in_double(t, s, used, columns, back);
}

/* The columns of rows that are transformed: there, times symbols, and back. */
void folded_columns(const Transform *t, const Shares *s, const Response *response, const void *symbol,
                    long used, int transposed)
{
    if (t->single) folded_columns_in_single(t, s, response, symbol, used, transposed);
    else folded_columns_in_double(t, s, response, symbol, used, transposed);
}

/* As `packed_multiply`, of boxes with so many rows and columns. */
void folded_multiply(const Transform *t, const Response *response, const void *symbol, const long *used,
                     int transposed)
{
    if (t->single) {
        folded_rows_in_single(t, 0, used[0], used[1], 0);
        folded_columns_in_single(t, 0, response, symbol, used[0], transposed);
        folded_rows_in_single(t, 0, used[0], used[1], 1);
    } else {
        folded_rows_in_double(t, 0, used[0], used[1], 0);
        folded_columns_in_double(t, 0, response, symbol, used[0], transposed);
        folded_rows_in_double(t, 0, used[0], used[1], 1);
    }
}

void folded_invert(const Transform *t, const double *compliance, double stiffness, double gain, void *symbol)
{
    if (t->single) folded_invert_in_single(t, compliance, stiffness, gain, symbol);
    else folded_invert_in_double(t, compliance, stiffness, gain, symbol);
}
