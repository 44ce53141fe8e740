/* Columns of spectra that are shared out, in the precision REAL: the BODY of `both.h` for `slabs.c`. */

/* some columns of an array of rows, one after another: each place holds one number or two */
CLONES static void OF(gather)(const REAL *restrict from, long rows, long wide, long columns, long numbers,
                              REAL *restrict to)
{
    for (long first = 0; first < rows; first += TILE) {
        const long last = first + TILE < rows ? first + TILE : rows;
        for (long k = 0; k < columns; k++)
            if (numbers == 1)
                for (long j = first; j < last; j++) to[k * rows + j] = from[j * wide + k];
            else
                for (long j = first; j < last; j++) {
                    to[2 * (k * rows + j)] = from[2 * (j * wide + k)];
                    to[2 * (k * rows + j) + 1] = from[2 * (j * wide + k) + 1];
                }
    }
}

CLONES static void OF(scatter)(const REAL *restrict from, long rows, long wide, long columns,
                               REAL *restrict to)
{
    for (long first = 0; first < rows; first += TILE) {
        const long last = first + TILE < rows ? first + TILE : rows;
        for (long j = first; j < last; j++)
            for (long k = 0; k < columns; k++) {
                to[2 * (j * wide + k)] = from[2 * (k * rows + j)];
                to[2 * (j * wide + k) + 1] = from[2 * (k * rows + j) + 1];
            }
    }
}

/* the blocks of a response, or their transpose, times the waves of some columns */
static void OF(respond)(const Columns *c, const Response *r, long first, long columns, int transposed)
{
    const long wide = 2 * COLUMNS * c->rows, n = columns * c->rows;
    REAL *x = c->block, *symbol = x + c->count * wide, *product = r->product;
    if (product) {
        memcpy(product, x, c->count * wide * sizeof *x);
        memset(x, 0, c->count * wide * sizeof *x);
    }
    for (long i = 0; i < r->components; i++)
        for (long j = 0; j < r->components; j++) {
            const long numbers = r->is_complex[i][j] ? 2 : 1;
            if (!r->symbol[i][j]) continue;
            OF(gather)((const REAL *)r->symbol[i][j] + first * numbers, c->rows, c->columns, columns,
                       numbers, symbol);
            if (product)
                OF(add_times)(x + (transposed ? j : i) * wide, symbol,
                              product + (transposed ? i : j) * wide, n, r->is_complex[i][j],
                              transposed ? -1 : 1);
            else OF(times)(x + i * wide, symbol, n);
        }
}

static void OF(along_columns)(const Columns *c, int there, int back, const Response *r, int transposed)
{
    const long rows = c->rows, wide = 2 * COLUMNS * rows;
    REAL *block = c->block;
    for (long first = 0; first < c->columns; first += COLUMNS) {
        const long columns = c->columns - first < COLUMNS ? c->columns - first : COLUMNS;
        REAL *at = (REAL *)c->spectrum + 2 * first;
        for (long i = 0; i < c->count; i++) {
            OF(gather)(at + 2 * i * rows * c->columns, rows, c->columns, columns, 2, block + i * wide);
            memset(block + i * wide + 2 * columns * rows, 0, 2 * (COLUMNS - columns) * rows * sizeof *block);
        }
        if (there) EXECUTE(c->there);
        if (r) OF(respond)(c, r, first, columns, transposed);
        if (back) EXECUTE(c->back);
        for (long i = 0; i < c->count; i++)
            OF(scatter)(block + i * wide, rows, c->columns, columns, at + 2 * i * rows * c->columns);
    }
}
