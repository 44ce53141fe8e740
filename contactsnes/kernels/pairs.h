/* Fields over a plane whose rows stand in pairs, the numbers of two side by side, in the precision REAL: the
   BODY of `both.h` for `packed.c`. */

static REAL *OF(field_of)(const Transform *t, long field)
{
    return (REAL *)t->real + field * (t->shape[0] + t->shape[0] % 2) * t->shape[1];
}

/* a row's numbers are every other one from here on */
static REAL *OF(row_of)(const Transform *t, long field, long row)
{
    return OF(field_of)(t, field) + packed_place(t, row, 0);
}

/* zeros beyond a box in the pairs of rows that are transformed */
static void OF(packed_clear_beyond)(const Transform *t, const long *shape)
{
    const long c = t->shape[1];
    for (long i = 0; i < t->count; i++) {
        for (long j = 0; j < shape[0] && shape[1] < c; j += 2)
            memset(OF(row_of)(t, i, j) + 2 * shape[1], 0, 2 * (c - shape[1]) * sizeof(REAL));
        for (long k = 0; k < c && shape[0] % 2; k++) OF(row_of)(t, i, shape[0])[2 * k] = 0.0;
    }
}

CLONES static void OF(packed_put_row)(const Transform *t, long field, long row, long first,
                                      const double *restrict weight, const double *restrict x, long n)
{
    REAL *restrict r = OF(row_of)(t, field, row) + 2 * first;
    if (weight)
        for (long k = 0; k < n; k++) r[2 * k] = weight[k] * x[k];
    else
        for (long k = 0; k < n; k++) r[2 * k] = x[k];
}

CLONES static void OF(packed_take_row)(const Transform *t, long field, long row, double mean, double factor,
                                       const double *scale, const double *own, double *out, long n)
{
    const REAL *restrict r = OF(row_of)(t, field, row);
    for (long k = 0; k < n; k++)
        out[k] = (r[2 * k] - mean) * factor * (scale ? scale[k] : 1.0) + own[k];
}
