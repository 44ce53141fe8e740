/* The code of `folded.c` in the precision REAL: the BODY of `both.h` for it. */

typedef REAL OF(Vector) __attribute__((vector_size(2 * SOME * sizeof(REAL)), aligned(sizeof(REAL))));

static const OF(Order) OF(REVERSED) = {6, 7, 4, 5, 2, 3, 0, 1}, OF(SWAPPED) = {1, 0, 3, 2, 5, 4, 7, 6};

static REAL *OF(field_of)(const Transform *t, long field)
{
    return (REAL *)t->real + field * room_of(t);
}

/* a pair of rows, or of its odd parts: of slabs, those of this process lie elsewhere */
static REAL *OF(pair_of)(const Transform *t, const Shares *s, long field, long part, long pair)
{
    if (s) return row_that_came(s, (field << t->both[1]) + part, pair);
    return OF(field_of)(t, field) + 2 * (pair * width_of(t) + part * t->shape[1]);
}

/* to w, for k from 1 on, what stands at n - k, times a sign */
CLONES static void OF(mirror)(const REAL *restrict x, REAL *restrict w, long n, REAL sign)
{
    long k = 1;
    for (; k + SOME <= n; k += SOME) {
        const OF(Vector) there = *(const OF(Vector) *)(x + 2 * (n - k - SOME + 1));
        *(OF(Vector) *)(w + 2 * k) = sign * __builtin_shuffle(there, OF(REVERSED));
    }
    for (; k < n; k++) {
        w[2 * k] = sign * x[2 * (n - k)];
        w[2 * k + 1] = sign * x[2 * (n - k) + 1];
    }
}

/* w = (x_k - i x_(n-k)) exp(i pi k / 2n) */
CLONES static void OF(turn)(const Line *l, const REAL *restrict x, REAL *restrict w)
{
    const long n = l->points;
    const REAL *restrict along = l->turn, *restrict across = along + 2 * n;
    const OF(Vector) sign = {1, -1, 1, -1, 1, -1, 1, -1};
    long k = 1;
    w[0] = x[0];
    w[1] = x[1];
    for (; k + SOME <= n; k += SOME) {
        const OF(Vector) there = __builtin_shuffle(*(const OF(Vector) *)(x + 2 * (n - k - SOME + 1)), OF(REVERSED));
        const OF(Vector) u = *(const OF(Vector) *)(x + 2 * k) + sign * __builtin_shuffle(there, OF(SWAPPED));
        *(OF(Vector) *)(w + 2 * k) = u * *(const OF(Vector) *)(along + 2 * k)
            + __builtin_shuffle(u, OF(SWAPPED)) * *(const OF(Vector) *)(across + 2 * k);
    }
    for (; k < n; k++) {
        const REAL u = x[2 * k] + x[2 * (n - k) + 1], v = x[2 * k + 1] - x[2 * (n - k)];
        w[2 * k] = u * along[2 * k] + v * across[2 * k];
        w[2 * k + 1] = v * along[2 * k + 1] + u * across[2 * k + 1];
    }
}

/* x = w_k exp(-i pi k / 2n) + w_(n-k) exp(i pi k / 2n) */
CLONES static void OF(turn_back)(const Line *l, const REAL *restrict w, REAL *restrict x)
{
    const long n = l->points;
    const REAL *restrict along = l->turn, *restrict across = along + 2 * n;
    long k = 1;
    x[0] = 2 * w[0];
    x[1] = 2 * w[1];
    for (; k + SOME <= n; k += SOME) {
        const OF(Vector) there = __builtin_shuffle(*(const OF(Vector) *)(w + 2 * (n - k - SOME + 1)), OF(REVERSED));
        const OF(Vector) here = *(const OF(Vector) *)(w + 2 * k);
        *(OF(Vector) *)(x + 2 * k) = (here + there) * *(const OF(Vector) *)(along + 2 * k)
            + __builtin_shuffle(there - here, OF(SWAPPED)) * *(const OF(Vector) *)(across + 2 * k);
    }
    for (; k < n; k++) {
        const REAL u = w[2 * k], v = w[2 * k + 1], a = w[2 * (n - k)], b = w[2 * (n - k) + 1];
        x[2 * k] = (u + a) * along[2 * k] + (b - v) * across[2 * k];
        x[2 * k + 1] = (v + b) * along[2 * k + 1] + (a - u) * across[2 * k + 1];
    }
}

/* changes the signs of waves of odd number */
static void OF(alternate)(const Line *l, REAL *x)
{
    for (long k = 2 * ((l->points + 1) / 2); k < 2 * l->points; k++) x[k] = -x[k];
}

/* what a line's FFT takes, from x, which does not survive */
static void OF(enter)(const Line *l, REAL *restrict x, REAL *restrict w, int back, long odd)
{
    const long n = l->points, m = n - 1;
    if (l->closed) {
        if (odd) x[0] = x[1] = x[2 * m] = x[2 * m + 1] = 0.0;
        memcpy(w, x, 2 * n * sizeof *w);
        OF(mirror)(x, w + 2 * m, m, odd ? -1 : 1);
        return;
    }
    if (odd && back) OF(alternate)(l, x);
    if (back) {
        memcpy(w, x, 2 * n * sizeof *w);
        return;
    }
    if (odd) {
        x[0] = x[1] = 0.0;
        OF(mirror)(x, w, n, 1);
        memcpy(x + 2, w + 2, 2 * (n - 1) * sizeof *x);
    }
    OF(turn)(l, x, w);
}

/* what comes from it */
CLONES static void OF(leave)(const Line *l, REAL *restrict w, REAL *restrict x, int back, long odd)
{
    const long n = l->points;
    if (l->closed && odd) {
        for (long k = 0; k < n; k++) { /* i w */
            x[2 * k] = -w[2 * k + 1];
            x[2 * k + 1] = w[2 * k];
        }
        x[0] = x[1] = x[2 * n - 2] = x[2 * n - 1] = 0.0;
    } else if (l->closed || !back) {
        memcpy(x, w, 2 * n * sizeof *x);
        if (odd) OF(alternate)(l, x);
    } else {
        OF(turn_back)(l, w, x);
        if (odd) {
            OF(mirror)(x, w, n, 1);
            memcpy(x + 2, w + 2, 2 * (n - 1) * sizeof *x);
            x[0] = x[1] = 0.0;
        }
    }
}

/* Some lines, `apart` complex numbers from each other, transformed in place. */
static void OF(lines)(const Line *l, REAL *x, long apart, long count, int back, long odd)
{
    const long wide = 2 * (l->closed ? 2 * (l->points - 1) : l->points + l->points % 2);
    REAL *w = l->row, *found = l->half; /* in place FFTW would copy them besides */
    for (long done = 0; done < count; done += PAIRS) {
        const long some = count - done < PAIRS ? count - done : PAIRS;
        REAL *first = x + done * 2 * apart;
        for (long i = 0; i < some; i++) OF(enter)(l, first + i * 2 * apart, w + i * wide, back, odd);
        EXECUTE(l->closed || back ? l->to_half : l->to_row);
        for (long i = 0; i < some; i++) OF(leave)(l, found + i * wide, first + i * 2 * apart, back, odd);
    }
}

/* Of a field whose middle is the middle of n numbers, what stands on either side of it, e and o, as its even and
   its odd part; and back. */
CLONES static void OF(part)(REAL *restrict e, REAL *restrict o, long n)
{
    for (long k = 0; k < n; k++) {
        const REAL there = (REAL)0.5 * (e[k] + o[k]), here = (REAL)0.5 * (e[k] - o[k]);
        e[k] = there;
        o[k] = here;
    }
}

CLONES static void OF(join)(REAL *restrict e, REAL *restrict o, long n)
{
    for (long k = 0; k < n; k++) {
        const REAL there = e[k] + o[k], here = e[k] - o[k];
        e[k] = there;
        o[k] = here;
    }
}

/* A row of n complex numbers on both sides of the axis: its even part in place, and its odd part after it. */
static void OF(part_row)(const Line *l, REAL *row, long n)
{
    const long c = l->points, middle = n / 2;
    REAL *w = l->row, *e = row, *o = row + 2 * c;
    memcpy(w, row, 2 * n * sizeof *w);
    memcpy(e, w + 2 * middle, 2 * (n - middle) * sizeof *w);
    memset(e + 2 * (n - middle), 0, 2 * (c - n + middle) * sizeof *w);
    memcpy(o, e, 2 * sizeof *w);
    memset(o + 2, 0, 2 * (c - 1) * sizeof *w);
    OF(mirror)(w, o, middle, 1);
    if (middle) memcpy(o + 2 * middle, w, 2 * sizeof *w);
    if (middle && is_whole(l, n)) memcpy(e + 2 * middle, w, 2 * sizeof *w);
    OF(part)(e, o, 2 * c);
}

static void OF(join_row)(const Line *l, REAL *row, long n)
{
    const long c = l->points, middle = n / 2;
    REAL *w = l->row, *e = row, *o = row + 2 * c;
    OF(join)(e, o, 2 * c);
    memcpy(w + 2 * middle, e, 2 * (n - middle) * sizeof *w);
    OF(mirror)(o, w, middle, 1); /* from 1 on, what stands at `middle` less that */
    if (middle) memcpy(w, o + 2 * middle, 2 * sizeof *w);
    memcpy(row, w, 2 * n * sizeof *w);
}

/* Even and odd parts of some columns, in two blocks of pairs of them, from rows on both sides of the axis: first
   what stands on its one side, and on its other one. */
CLONES static void OF(gather_both)(const Transform *t, const Shares *s, long field, long first, long columns,
                               long used)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), pairs = (columns + 1) / 2, middle = used / 2;
    REAL *e = (REAL *)t->block + 2 * field * PAIRS * apart, *o = e + PAIRS * apart;
    for (long q = 0; q < pairs; q++) {
        memset(e + q * apart, 0, apart * sizeof *e);
        memset(o + q * apart, 0, apart * sizeof *o);
    }
    for (long j = 0; j < used; j++) {
        const REAL *restrict z = OF(pair_of)(t, s, field, 0, j / 2) + 2 * first + j % 2;
        REAL *restrict to = j < middle ? o + 2 * (middle - j) : e + 2 * (j - middle);
        for (long q = 0; q < pairs; q++) {
            to[q * apart] = z[4 * q];
            to[q * apart + 1] = 2 * q + 1 < columns ? z[4 * q + 2] : 0.0;
        }
    }
    for (long q = 0; q < pairs; q++) {
        memcpy(o + q * apart, e + q * apart, 2 * sizeof *e);
        if (middle && is_whole(&t->line[0], used))
            memcpy(e + q * apart + 2 * middle, o + q * apart + 2 * middle, 2 * sizeof *e);
        OF(part)(e + q * apart, o + q * apart, 2 * r);
    }
}

CLONES static void OF(scatter_both)(const Transform *t, const Shares *s, long field, long first, long columns,
                                long used)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), pairs = (columns + 1) / 2, middle = used / 2;
    REAL *e = (REAL *)t->block + 2 * field * PAIRS * apart, *o = e + PAIRS * apart;
    for (long q = 0; q < pairs; q++) OF(join)(e + q * apart, o + q * apart, 2 * r);
    for (long j = 0; j < used; j++) {
        REAL *restrict z = OF(pair_of)(t, s, field, 0, j / 2) + 2 * first + j % 2;
        const REAL *restrict from = j < middle ? o + 2 * (middle - j) : e + 2 * (j - middle);
        for (long q = 0; q < pairs; q++) {
            z[4 * q] = from[q * apart];
            if (2 * q + 1 < columns) z[4 * q + 2] = from[q * apart + 1];
        }
    }
}

/* Some columns of a field's rows, pair after pair, zero beyond the rows used, to a block; `part` 1: of the columns
   of odd parts of rows. */
CLONES static void OF(gather)(const Transform *t, const Shares *s, long field, long part, long first, long columns,
                          long used)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), pairs = (columns + 1) / 2;
    const long filled = used + used % 2;
    REAL *restrict to = (REAL *)t->block + ((field << t->both[1]) + part) * PAIRS * apart;
    for (long p = 0; p < filled / 2; p++) {
        const REAL *restrict z = OF(pair_of)(t, s, field, part, p) + 2 * first;
        for (long q = 0; q < pairs; q++) {
            const int two = 2 * q + 1 < columns;
            REAL *restrict o = to + q * apart + 4 * p;
            o[0] = z[4 * q];
            o[1] = two ? z[4 * q + 2] : 0.0;
            o[2] = z[4 * q + 1];
            o[3] = two ? z[4 * q + 3] : 0.0;
        }
    }
    for (long q = 0; q < pairs; q++) memset(to + q * apart + 2 * used, 0, (apart - 2 * used) * sizeof *to);
}

CLONES static void OF(scatter)(const Transform *t, const Shares *s, long field, long part, long first, long columns,
                           long used)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), pairs = (columns + 1) / 2;
    const REAL *restrict from = (REAL *)t->block + ((field << t->both[1]) + part) * PAIRS * apart;
    for (long p = 0; p < (used + 1) / 2; p++) {
        REAL *restrict z = OF(pair_of)(t, s, field, part, p) + 2 * first;
        for (long q = 0; q < pairs; q++) {
            const REAL *restrict o = from + q * apart + 4 * p;
            z[4 * q] = o[0];
            z[4 * q + 1] = o[2];
            if (2 * q + 1 == columns) break;
            z[4 * q + 2] = o[1];
            z[4 * q + 3] = o[3];
        }
    }
}

/* x = s x, sign s y, or x + sign s y, for a pair of columns */
CLONES static void OF(scale_pair)(REAL *restrict x, const REAL *restrict s, long n)
{
    for (long k = 0; k < n; k++) x[k] *= s[k];
}

CLONES static void OF(put_pair)(REAL *restrict x, const REAL *restrict s, const REAL *restrict y, REAL sign, long n)
{
    for (long k = 0; k < n; k++) x[k] = sign * s[k] * y[k];
}

CLONES static void OF(add_pair)(REAL *restrict x, const REAL *restrict s, const REAL *restrict y, REAL sign, long n)
{
    for (long k = 0; k < n; k++) x[k] += sign * s[k] * y[k];
}

/* The blocks of a response, or their transpose, times the columns of a block. A kernel that is odd makes sines of
   cosines, and of sines cosines with the sign reversed. */
static void OF(couple_pairs)(const Transform *t, const Response *response, long first, long pairs,
                             int transposed)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), wide = PAIRS * apart, parts = parts_of(t);
    REAL *x = t->block, *y = response->product;
    int begun[FIELDS] = {0};
    memcpy(y, x, t->count * parts * wide * sizeof *x);
    for (long block = 0; block < t->count * t->count * parts; block++) {
        const long part = block % parts, i = block / parts / t->count, j = block / parts % t->count;
        const int crosses = (int)response->crosses[i][j];
        const REAL *s = response->symbol[i][j];
        const REAL sign = crosses && part != transposed ? -1 : 1; /* `part` is the source's */
        const long to = (transposed ? j : i) * parts + (crosses ? 1 - part : part);
        const long from = (transposed ? i : j) * parts + part;
        for (long q = 0; q < pairs && s; q++)
            (begun[to] ? OF(add_pair) : OF(put_pair))(x + to * wide + q * apart, s + first * r + q * 2 * r,
                                                      y + from * wide + q * apart, sign, 2 * r);
        begun[to] |= s != 0;
    }
    for (long i = 0; i < t->count * parts; i++)
        if (!begun[i]) memset(x + i * wide, 0, wide * sizeof *x);
}

/* the symbols of a response, or each field's own, times the columns of a block */
static void OF(multiply)(const Transform *t, const Response *response, const REAL *symbol, long first,
                         long pairs, int transposed)
{
    const long r = t->shape[0], apart = 2 * (r + r % 2), parts = parts_of(t);
    if (response && response->product) {
        OF(couple_pairs)(t, response, first, pairs, transposed);
        return;
    }
    for (long i = 0; i < t->count * parts; i++) {
        const long field = i / parts;
        const REAL *s = response ? response->symbol[field][field] : symbol + field * t->waves;
        for (long q = 0; q < pairs; q++)
            OF(scale_pair)((REAL *)t->block + (i * PAIRS + q) * apart, s + first * r + q * 2 * r, 2 * r);
    }
}

/* The rows of all fields, of which some are used, transformed; or back. Of slabs they go to what is sent
   while they are in the processor's cache, or come from there. Of rows on both sides of the axis so many `columns`
   are used. */
static void OF(folded_rows)(const Transform *t, const Shares *s, long used, long columns, int back)
{
    const long c = t->shape[1], width = width_of(t), pairs = (used + 1) / 2, parts = 1 + t->both[1];
    for (long i = 0; i < t->count; i++)
        for (long p = 0; p < pairs; p += PAIRS) {
            const long some = pairs - p < PAIRS ? pairs - p : PAIRS;
            REAL *x = OF(field_of)(t, i) + 2 * p * width;
            for (long part = 0; part < parts && s && back; part++)
                share_rows(s, i * parts + part, p, some, x + 2 * part * c, back);
            for (long k = 0; k < some && parts > 1 && !back; k++)
                OF(part_row)(&t->line[1], x + 2 * k * width, columns);
            for (long part = 0; part < parts; part++)
                OF(lines)(&t->line[1], x + 2 * part * c, width, some, back, t->odd[i * parts_of(t) + part][1]);
            for (long k = 0; k < some && parts > 1 && back; k++)
                OF(join_row)(&t->line[1], x + 2 * k * width, columns);
            for (long part = 0; part < parts && s && !back; part++)
                share_rows(s, i * parts + part, p, some, x + 2 * part * c, back);
        }
}

/* The columns of rows that are transformed: there, times symbols, and back. */
static void OF(folded_columns)(const Transform *t, const Shares *s, const Response *response, const REAL *symbol,
                    long used, int transposed)
{
    const long r = t->shape[0], c = t->shape[1], apart = r + r % 2, wide = PAIRS * 2 * apart, parts = parts_of(t);
    for (long first = 0; first < c; first += COLUMNS) {
        const long columns = c - first < COLUMNS ? c - first : COLUMNS, pairs = (columns + 1) / 2;
        for (long i = 0; i < t->count; i++)
            if (t->both[0]) OF(gather_both)(t, s, i, first, columns, used);
            else
                for (long part = 0; part < parts; part++) OF(gather)(t, s, i, part, first, columns, used);
        for (long i = 0; i < t->count * parts; i++)
            OF(lines)(&t->line[0], (REAL *)t->block + i * wide, apart, pairs, 0, t->odd[i][0]);
        OF(multiply)(t, response, symbol, first, pairs, transposed);
        for (long i = 0; i < t->count * parts; i++)
            OF(lines)(&t->line[0], (REAL *)t->block + i * wide, apart, pairs, 1, t->odd[i][0]);
        for (long i = 0; i < t->count; i++)
            if (t->both[0]) OF(scatter_both)(t, s, i, first, columns, used);
            else
                for (long part = 0; part < parts; part++) OF(scatter)(t, s, i, part, first, columns, used);
    }
}

/* the symbol 1 / gain / (1 + C D), pair after pair, from compliances column after column */
CLONES static void OF(folded_invert)(const Transform *t, const double *restrict compliance, double stiffness,
                                     double gain, REAL *restrict symbol)
{
    const long r = t->shape[0], c = t->shape[1];
    for (long k = 0; k < c; k++) {
        REAL *restrict s = symbol + (k / 2) * 2 * r + k % 2;
        for (long j = 0; j < r; j++) s[2 * j] = 1.0 / gain / (compliance[k * r + j] * stiffness + 1.0);
        for (long j = 0; j < r && k == c - 1 && c % 2; j++) s[2 * j + 1] = 0.0;
    }
}
