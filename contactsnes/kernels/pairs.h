/* Fields over a plane whose rows stand in pairs, the numbers of two side by side, and their products, in the
   precision REAL: the BODY of `both.h` for `packed.c`. */

static REAL *OF(field_of)(const Transform *t, long field)
{
    return (REAL *)t->real + field * room_of(t);
}

/* a row's numbers are every other one from here on */
static REAL *OF(row_of)(const Transform *t, long field, long row)
{
    return OF(field_of)(t, field) + packed_place(t, row, 0);
}

/* zeros beyond a box in the pairs of rows that are transformed */
static void OF(packed_clear_beyond)(const Transform *t, const long *shape)
{
    const long c = width_of(t);
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

CLONES static void OF(packed_blend_row)(const Transform *t, long field, long row, const double *restrict into,
                                        const double *restrict back, const double *x, double *out, long n)
{
    const REAL *restrict r = OF(row_of)(t, field, row);
    for (long k = 0; k < n; k++) out[k] = x[k] + back[k] * (r[2 * k] - into[k] * x[k]);
}

/* waves of some columns of a field's rows, a column after the other, zero beyond the rows used: a line of the
   cache of each column at a time, as columns may all have their places in one set of the cache */
CLONES static void OF(gather)(const Transform *t, long field, long first, long columns, long used)
{
    const long r = t->shape[0], c = t->shape[1];
    REAL *restrict to = (REAL *)t->block + field * COLUMNS * 2 * r;
    const long pairs = (used + 1) / 2;
    for (long begin = 0; begin < pairs; begin += LINE)
        for (long k = 0; k < columns; k++) {
            const long here = 2 * (first + k), there = here ? 2 * c - here : 0;
            const long end = begin + LINE < pairs ? begin + LINE : pairs;
            const REAL *restrict z = OF(field_of)(t, field) + begin * 2 * c;
            REAL *restrict o = to + 2 * (k * r + 2 * begin);
            for (long p = begin; p < end; p++, z += 2 * c, o += 4) {
                const REAL a = z[here], b = z[here + 1], d = z[there], e = z[there + 1];
                o[0] = (REAL)0.5 * (a + d);
                o[1] = (REAL)0.5 * (b - e);
                o[2] = (REAL)0.5 * (b + e);
                o[3] = (REAL)0.5 * (d - a);
            }
        }
    const long filled = used + used % 2;
    for (long k = 0; k < columns; k++)
        memset(to + 2 * (k * r + filled), 0, 2 * (r - filled) * sizeof *to);
    memset(to + 2 * columns * r, 0, 2 * (COLUMNS - columns) * r * sizeof *to);
}

CLONES static void OF(scatter)(const Transform *t, const REAL *found, long field, long first, long columns, long used)
{
    const long r = t->shape[0], c = t->shape[1];
    const REAL *restrict from = found + field * COLUMNS * 2 * r;
    for (long p = 0; p < (used + 1) / 2; p++) {
        REAL *restrict z = OF(field_of)(t, field) + p * 2 * c;
        for (long k = 0; k < columns; k++) {
            const long here = 2 * (first + k), there = 2 * c - here;
            const REAL *restrict o = from + 2 * (k * r + 2 * p);
            if (here == 0 || here == c) { /* rows are real: so are these waves of theirs */
                z[here] = o[0];
                z[here + 1] = o[2];
                continue;
            }
            z[here] = o[0] - o[3];
            z[here + 1] = o[1] + o[2];
            z[there] = o[0] + o[3];
            z[there + 1] = o[2] - o[1];
        }
    }
}

/* Waves of a pair of rows that stand as Z, from some on, as those of each of the two; and back. */
CLONES static void OF(part_rows)(const REAL *restrict z, long c, long first, long columns, REAL *restrict a,
                                 REAL *restrict b)
{
    const REAL *restrict here = z + 2 * first, *restrict there = z + 2 * (c - first);
    long k = 0;
    if (!first && columns) {
        a[0] = here[0];
        b[0] = here[1];
        a[1] = b[1] = 0.0;
        k = 1;
    }
    for (; k < columns; k++) {
        const REAL x = here[2 * k], y = here[2 * k + 1], u = there[-2 * k], v = there[-2 * k + 1];
        a[2 * k] = (REAL)0.5 * (x + u);
        a[2 * k + 1] = (REAL)0.5 * (y - v);
        b[2 * k] = (REAL)0.5 * (y + v);
        b[2 * k + 1] = (REAL)0.5 * (u - x);
    }
}

CLONES static void OF(join_rows)(const REAL *restrict a, const REAL *restrict b, long c, long first, long columns,
                                 REAL *restrict z)
{
    REAL *restrict here = z + 2 * first, *restrict there = z + 2 * (c - first);
    /* rows are real: so are these waves of theirs */
    const long last = 2 * (first + columns - 1) == c ? columns - 1 : columns;
    long k = 0;
    if (!first && columns) {
        here[0] = a[0];
        here[1] = b[0];
        k = 1;
    }
    for (; k < last; k++) {
        here[2 * k] = a[2 * k] - b[2 * k + 1];
        here[2 * k + 1] = a[2 * k + 1] + b[2 * k];
        there[-2 * k] = a[2 * k] + b[2 * k + 1];
        there[-2 * k + 1] = b[2 * k] - a[2 * k + 1];
    }
    if (last < columns && last >= k) {
        here[2 * last] = a[2 * last];
        here[2 * last + 1] = b[2 * last];
    }
}

/* Some columns of all rows of slabs, a column after the other: tiles of a few lines of the cache. */
CLONES static void OF(gather_came)(const Transform *t, const Shares *s, long field, long first, long columns)
{
    const long r = t->shape[0], wide = 2 * (s->first[s->own + 1] - s->first[s->own]);
    const REAL *restrict from = (const REAL *)(s->came + field * s->fields[2]) + 2 * first;
    REAL *restrict to = (REAL *)t->block + field * COLUMNS * 2 * r;
    for (long begin = 0; begin < r; begin += 2 * LINE) {
        const long end = begin + 2 * LINE < r ? begin + 2 * LINE : r;
        for (long k = 0; k < columns; k++)
            for (long j = begin; j < end; j++) {
                to[2 * (k * r + j)] = from[j * wide + 2 * k];
                to[2 * (k * r + j) + 1] = from[j * wide + 2 * k + 1];
            }
    }
    memset(to + 2 * columns * r, 0, 2 * (COLUMNS - columns) * r * sizeof *to);
}

CLONES static void OF(scatter_came)(const Transform *t, const Shares *s, const REAL *found, long field, long first,
                                    long columns)
{
    const long r = t->shape[0], wide = 2 * (s->first[s->own + 1] - s->first[s->own]);
    const REAL *restrict from = found + field * COLUMNS * 2 * r;
    REAL *restrict to = (REAL *)(s->came + field * s->fields[2]) + 2 * first;
    for (long j = 0; j < r; j++)
        for (long k = 0; k < columns; k++) {
            to[j * wide + 2 * k] = from[2 * (k * r + j)];
            to[j * wide + 2 * k + 1] = from[2 * (k * r + j) + 1];
        }
}

/* the blocks, or their transpose, times the waves of some columns, which go where the columns came from */
static void OF(couple)(const Transform *t, const Response *r, long first, long columns, int transposed)
{
    const long rows = t->shape[0], n = columns * rows, m = r->boxes, wide = 2 * COLUMNS * rows;
    REAL *x = t->block, *waves = t->spectrum;
    memset(x, 0, t->count * wide * sizeof *x);
    for (long i = 0; i < r->components; i++)
        for (long j = 0; j < r->components; j++) {
            const long numbers = r->is_complex[i][j] ? 2 : 1;
            const REAL *s = r->symbol[i][j];
            if (!s) continue;
            for (long a = 0; a < m; a++)
                for (long b = 0; b < m; b++) {
                    const REAL *own = s + ((a * m + b) * t->waves + first * rows) * numbers;
                    const long to = transposed ? j * m + b : i * m + a;
                    const long from = transposed ? i * m + a : j * m + b;
                    OF(add_times)(x + to * wide, own, waves + from * wide, n, r->is_complex[i][j],
                                  transposed ? -1 : 1);
                }
        }
}

/* Some columns of all fields, of slabs as they have come, transformed, times symbols, and back. Out of place: in
   place FFTW would copy them besides. */
static void OF(columns_of)(const Transform *t, const Shares *s, const Response *response, const REAL *symbol,
                           long first, long columns, long used, int transposed)
{
    const long r = t->shape[0];
    REAL *waves = t->spectrum, *found = t->block;
    for (long i = 0; i < t->count; i++)
        if (s) OF(gather_came)(t, s, i, first, columns);
        else OF(gather)(t, i, first, columns, used);
    EXECUTE_ROWS(t->columns, t->block, waves);
    if (response && response->product) {
        OF(couple)(t, response, first, columns, transposed);
        waves = t->block;
        found = t->spectrum;
    } else
        for (long i = 0; i < t->count; i++) {
            const REAL *own = response ? response->symbol[i][i] : symbol + i * t->waves;
            OF(times)(waves + i * 2 * COLUMNS * r, own + first * r, columns * r);
        }
    EXECUTE_ROWS(t->columns_back, waves, found);
    for (long i = 0; i < t->count; i++)
        if (s) OF(scatter_came)(t, s, found, i, first, columns);
        else OF(scatter)(t, found, i, first, columns, used);
}

/* The rows of all fields that are used, transformed, or back, by way of a row of other memory. */
static void OF(along)(const Transform *t, void *plan, long used)
{
    const long c = t->shape[1];
    for (long i = 0; i < t->count; i++)
        for (long p = 0; p < (used + 1) / 2; p++) {
            REAL *z = OF(field_of)(t, i) + p * 2 * c;
            EXECUTE_ROWS(plan, z, t->spectrum);
            memcpy(z, t->spectrum, 2 * c * sizeof *z);
        }
}

static void OF(packed_multiply)(const Transform *t, const Response *response, const void *symbol, long used,
                                int transposed)
{
    const long waves = t->shape[1] / 2 + 1;
    OF(along)(t, t->forward, used);
    for (long first = 0; first < waves; first += COLUMNS) {
        const long columns = waves - first < COLUMNS ? waves - first : COLUMNS;
        OF(columns_of)(t, 0, response, symbol, first, columns, used, transposed);
    }
    OF(along)(t, t->backward, used);
}

/* Where the waves of a row go that a process gets, or come from: its own to those that have come. */
static REAL *OF(waves_for)(const Shares *s, long field, long part, long row, long before)
{
    const long wide = (s->first[part + 1] - s->first[part]) * s->size;
    char *begin = part == s->own ? s->came + field * s->fields[2] + s->place * wide
                                 : s->packed + field * s->fields[1] + before;
    return (REAL *)(begin + row * wide);
}

/* The rows of slabs, transformed, to what is sent while they are in the processor's cache; or back. The second
   of a last pair of one row is room beyond what rows are transformed to. Pairs without a node of the response are
   zero, and only of a residual, in double precision, anything is asked for there. */
static void OF(shared_rows)(const Transform *t, const Shares *s, const Response *response, int back)
{
    const long c = t->shape[1], rows = t->shape[0];
    const int *pairs = response && !(back && sizeof(REAL) == sizeof(double)) ? response->pairs : 0;
    REAL *waves = t->spectrum, *none = waves + 2 * c;
    for (long i = 0; i < t->count; i++)
        for (long j = 0; j < rows; j += 2) {
            const int empty = pairs && !pairs[j / 2];
            REAL *z = OF(field_of)(t, i) + j * c;
            long before = 0;
            if (empty && back) continue;
            for (long k = 0; k < c && !back && j + 1 == rows; k++) z[2 * k + 1] = 0.0;
            if (empty) memset(waves, 0, 2 * c * sizeof *waves);
            else if (!back) EXECUTE_ROWS(t->forward, z, waves);
            if (back && j + 1 == rows) memset(none, 0, 2 * c * sizeof *none);
            for (long part = 0; part < s->parts; part++) {
                const long first = s->first[part], columns = s->first[part + 1] - first;
                REAL *a = OF(waves_for)(s, i, part, j, before);
                REAL *b = j + 1 < rows ? OF(waves_for)(s, i, part, j + 1, before) : none;
                if (back) OF(join_rows)(a, b, c, first, columns, z);
                else OF(part_rows)(waves, c, first, columns, a, b);
                before += part == s->own ? 0 : rows * columns * s->size;
            }
            if (!back) continue;
            EXECUTE_ROWS(t->backward, z, waves);
            memcpy(z, waves, 2 * c * sizeof *z);
        }
}

/* The columns of slabs that are here: there, times symbols, and back. */
static void OF(shared_columns)(const Transform *t, const Shares *s, const Response *response, const void *symbol,
                               int transposed)
{
    const long here = s->first[s->own + 1] - s->first[s->own];
    for (long first = 0; first < here; first += COLUMNS) {
        const long columns = here - first < COLUMNS ? here - first : COLUMNS;
        OF(columns_of)(t, s, response, symbol, first, columns, 0, transposed);
    }
}
