/* A block of the core-zone preconditioner in patches (solvers/core_blocks.py, PatchedBlock): each point of its
   circle stands for some rows and columns of nodes. */
#include "kernels.h"
#include <string.h>

/* sum += weight x, of a row */
CLONES static void add_row(const double *restrict weight, const double *restrict x, double *restrict sum, long n)
{
    for (long k = 0; k < n; k++) sum[k] += weight[k] * x[k];
}

/* x less weight (own weight x + by), in place or not */
CLONES static void subtract_row(const double *weight, double own, const double *by, const double *x, double *out,
                                long n)
{
    for (long k = 0; k < n; k++) out[k] = x[k] - weight[k] * (own * weight[k] * x[k] + by[k]);
}

/* x, where it is not in place */
static void leave(const double *x, double *out, long n)
{
    if (x != out) memcpy(out, x, n * sizeof *x);
}

/* Rows of the core in a row of patches, from the first one to before another. */
static void rows_of(const Block *b, long patch, long *from, long *to)
{
    const long begin = patch * b->apart - b->before[0], end = begin + b->apart;
    *from = begin > 0 ? begin : 0;
    *to = end < b->extent[0] ? end : b->extent[0];
}

/* Sums over the patches of a box's core to the circle. */
static void put_patches(const Zone *z, const Block *b, const Transform *t, const long *patches, const double *x)
{
    const long n = b->extent[1], c = z->form->response->shape[1], apart = b->apart;
    double *sum = z->sums, *row = sum + b->before[1];
    for (long j = 0; j < patches[0]; j++) {
        long from, to;
        rows_of(b, j, &from, &to);
        memset(sum, 0, patches[1] * apart * sizeof *sum);
        for (long l = from; l < to; l++) add_row(b->into + l * n, x + (b->first[0] + l) * c + b->first[1], row, n);
        for (long k = 0; k < patches[1]; k++) {
            double patch = 0.0;
            for (long l = 0; l < apart; l++) patch += sum[k * apart + l];
            sum[k] = patch;
        }
        put_row(t, 0, j, 0, 0, sum, patches[1]);
    }
}

/* What is left of a box by what stands on the circle. */
static void take_patches(const Zone *z, const Block *b, const Transform *t, const long *patches, const double *x,
                         double *out)
{
    const long n = b->extent[1], c = z->form->response->shape[1], apart = b->apart;
    const long left = b->first[1], right = c - left - n, end = (b->first[0] + b->extent[0]) * c;
    double *found = z->sums, *none = found + patches[1], *row = none + patches[1];
    memset(none, 0, patches[1] * sizeof *none);
    leave(x, out, b->first[0] * c);
    for (long j = 0; j < patches[0]; j++) {
        long from, to;
        rows_of(b, j, &from, &to);
        take_row(t, 0, j, 0.0, 1.0, 0, none, found, patches[1]);
        for (long k = 0; k < patches[1]; k++)
            for (long l = 0; l < apart; l++) row[k * apart + l] = found[k];
        for (long l = from; l < to; l++) {
            const long at = (b->first[0] + l) * c, core = at + left;
            leave(x + at, out + at, left);
            subtract_row(b->into + l * n, b->within, row + b->before[1], x + core, out + core, n);
            leave(x + core + n, out + core + n, right);
        }
    }
    leave(x + end, out + end, z->form->nodes - end);
}

/* The block times a field, to another one or in place. */
int apply_patched(const Zone *z, const Block *b, Transform *t, const double *field, double *out)
{
    const long picked = z->form->response->picked;
    long patches[2];
    int status;
    for (int axis = 0; axis < 2; axis++)
        patches[axis] = (b->before[axis] + b->extent[axis] + b->apart - 1) / b->apart;
    if (picked) {
        clear_field(t, 0);
        add_nodes(t, b->at, b->node, b->into, field, b->picked);
    } else
        put_patches(z, b, t, patches, field);
    if ((status = filter(t, patches, b->circle->symbol))) return status;
    if (picked) {
        leave(field, out, z->form->nodes);
        subtract_nodes(t, b->at, b->node, b->into, b->within, out, b->picked);
    } else
        take_patches(z, b, t, patches, field, out);
    return 0;
}
