/* A block of the core-zone preconditioner in patches (solvers/core_blocks.py, PatchedBlock): each point of its
   circle stands for some rows and columns of nodes. */
#include "kernels.h"
#include <string.h>

/* Rows of the core in a row of patches, from the first one to before another. */
static void rows_of(const Block *b, long patch, long *from, long *to)
{
    const long begin = patch * b->apart - b->before[0], end = begin + b->apart;
    *from = begin > 0 ? begin : 0;
    *to = end < b->extent[0] ? end : b->extent[0];
}

#define BODY "patches.h"
#include "both.h"

/* Sums of weights times x of some nodes by their places, so many. */
void sum_nodes(const int *at, const int *node, const double *weight, const double *x, long n, long places,
               double *sums)
{
    memset(sums, 0, places * sizeof *sums);
    for (long k = 0; k < n; k++) sums[at[k]] += weight[k] * x[node[k]];
}

/* Patches of a core in each direction. */
static void count_patches(const Block *b, long *patches)
{
    for (int axis = 0; axis < 2; axis++)
        patches[axis] = (b->before[axis] + b->extent[axis] + b->apart - 1) / b->apart;
}

/* The block times a field, to another one or in place. */
int apply_patched(const Zone *z, const Block *b, Transform *t, const double *field, double *out)
{
    long patches[2];
    int status;
    count_patches(b, patches);
    if (!z->form->response->picked) return patched_in_double(z, b, t, patches, field, out);
    clear_field(t, 0);
    add_nodes(t, b->at, b->node, b->into, field, b->picked);
    if ((status = filter(t, patches, b->circle->symbol))) return status;
    leave_in_double(field, out, z->form->nodes);
    subtract_nodes(t, b->at, b->node, b->into, b->within, out, b->picked);
    return 0;
}

/* The same of a field in single precision, of all nodes of a box. */
int apply_patched_in_single(const Zone *z, const Block *b, Transform *t, const float *field, float *out)
{
    long patches[2];
    count_patches(b, patches);
    return patched_in_single(z, b, t, patches, field, out);
}
