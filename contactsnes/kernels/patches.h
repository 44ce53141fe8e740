/* Fields of numbers REAL to the patches of a core and back: the BODY of `both.h` for `patches.c`. What patches
   hold is of doubles. */

/* sum += weight x, of a row */
CLONES static void OF(add_row)(const double *restrict weight, const REAL *restrict x, double *restrict sum, long n)
{
    for (long k = 0; k < n; k++) sum[k] += weight[k] * x[k];
}

/* x less weight (own weight x + by), in place or not */
CLONES static void OF(subtract_row)(const double *restrict weight, double own, const double *restrict by,
                                    const REAL *x, REAL *out, long n)
{
    for (long k = 0; k < n; k++) out[k] = x[k] - weight[k] * (own * weight[k] * x[k] + by[k]);
}

/* x, where it is not in place */
static void OF(leave)(const REAL *x, REAL *out, long n)
{
    if (x != out) memcpy(out, x, n * sizeof *x);
}

/* Sums over the patches of a box's core to the circle. */
static void OF(put_patches)(const Zone *z, const Block *b, const Transform *t, const long *patches, const REAL *x)
{
    const long n = b->extent[1], c = z->form->response->shape[1], apart = b->apart;
    double *sum = z->sums, *row = sum + b->before[1];
    for (long j = 0; j < patches[0]; j++) {
        long from, to;
        rows_of(b, j, &from, &to);
        memset(sum, 0, patches[1] * apart * sizeof *sum);
        for (long l = from; l < to; l++) OF(add_row)(b->into + l * n, x + (b->first[0] + l) * c + b->first[1], row, n);
        for (long k = 0; k < patches[1]; k++) {
            double patch = 0.0;
            for (long l = 0; l < apart; l++) patch += sum[k * apart + l];
            sum[k] = patch;
        }
        put_row(t, 0, j, 0, 0, sum, patches[1]);
    }
}

/* What is left of a box by what stands on the circle. */
static void OF(take_patches)(const Zone *z, const Block *b, const Transform *t, const long *patches,
                             const REAL *x, REAL *out)
{
    const long n = b->extent[1], c = z->form->response->shape[1], apart = b->apart;
    const long left = b->first[1], right = c - left - n, end = (b->first[0] + b->extent[0]) * c;
    double *found = z->sums, *none = found + patches[1], *row = none + patches[1];
    memset(none, 0, patches[1] * sizeof *none);
    OF(leave)(x, out, b->first[0] * c);
    for (long j = 0; j < patches[0]; j++) {
        long from, to;
        rows_of(b, j, &from, &to);
        take_row(t, 0, j, 0.0, 1.0, 0, none, found, patches[1]);
        for (long k = 0; k < patches[1]; k++)
            for (long l = 0; l < apart; l++) row[k * apart + l] = found[k];
        for (long l = from; l < to; l++) {
            const long at = (b->first[0] + l) * c, core = at + left;
            OF(leave)(x + at, out + at, left);
            OF(subtract_row)(b->into + l * n, b->within, row + b->before[1], x + core, out + core, n);
            OF(leave)(x + core + n, out + core + n, right);
        }
    }
    OF(leave)(x + end, out + end, z->form->nodes - end);
}

/* Patches of the block times a field, to another one or in place. */
static int OF(patched)(const Zone *z, const Block *b, Transform *t, const long *patches, const REAL *field, REAL *out)
{
    OF(put_patches)(z, b, t, patches, field);
    const int status = filter(t, patches, b->circle->symbol);
    if (!status) OF(take_patches)(z, b, t, patches, field, out);
    return status;
}
