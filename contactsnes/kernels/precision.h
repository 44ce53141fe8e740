/* Transforms of fields on a circle, what goes to them and comes back, and products with symbols, in the
   precision REAL: the BODY of `both.h` for `transforms.c`. What is not on a circle is of doubles always.

   Real transforms of fields on a circle, and cosine transforms of even ones made from real FFTs:
   FFTW's own cosine transforms take several times as long.

   Open rows (the field goes on oddly beyond the last point, FFTW's REDFT01 and REDFT10) by Makhoul,
   IEEE Trans. Acoust. Speech Signal Process. 28, 27 (1980); their waves stay in the order of his FFT:
   even numbers upwards, then odd ones downwards. Closed rows (REDFT00) by an FFT of all of their period. */

/* A row where it stands, if FFTW finds it aligned as the one that was planned, or that one. */
static REAL *OF(aligned)(const Line *l, REAL *x)
{
    return ALIGNMENT_OF(x) == ALIGNMENT_OF(l->row) ? x : l->row;
}

/* of a row whose first numbers are `used` alone: the others count as zero */
CLONES static void OF(open_forward)(const Line *l, REAL *x, long used)
{
    const long n = l->points, half = n / 2, alone = n - used < half ? n - used : half;
    const long first = alone < used - 1 ? alone : used - 1;
    REAL *restrict z = l->half;
    const REAL *restrict w = l->turn;
    z[0] = x[0];
    z[1] = 0.0;
    for (long k = 1; k <= first; k++) { /* (x_k - i x_(n-k)) exp(i pi k / 2n), the second of which is zero */
        z[2 * k] = x[k] * w[2 * k];
        z[2 * k + 1] = x[k] * w[2 * k + 1];
    }
    for (long k = first + 1; k <= alone; k++) z[2 * k] = z[2 * k + 1] = 0.0;
    for (long k = alone + 1; k <= half; k++) {
        const REAL u = x[k], v = x[n - k], c = w[2 * k], s = w[2 * k + 1];
        z[2 * k] = u * c + v * s;
        z[2 * k + 1] = u * s - v * c;
    }
    REAL *row = OF(aligned)(l, x);
    TO_ROW(l->to_row, z, row);
    if (row != x) memcpy(x, row, n * sizeof *x);
}

/* to a row of whose numbers the first are `used` alone: the others are left as they are */
CLONES static void OF(open_backward)(const Line *l, REAL *x, long used)
{
    const long n = l->points, half = (n + 1) / 2, alone = n - used < half - 1 ? n - used : half - 1;
    const long first = alone < used - 1 ? alone : used - 1;
    const REAL *restrict z = l->half, *restrict w = l->turn;
    REAL *row = OF(aligned)(l, x);
    if (row != x) memcpy(row, x, n * sizeof *x);
    TO_HALF(l->to_half, row, l->half);
    REAL *restrict upwards = x, *restrict downwards = x; /* which do not meet before the middle */
    upwards[0] = 2 * z[0];
    for (long k = 1; k <= first; k++) /* 2 Re of exp(-i pi k / 2n) V_k */
        upwards[k] = 2 * (w[2 * k] * z[2 * k] + w[2 * k + 1] * z[2 * k + 1]);
    for (long k = alone + 1; k < half; k++) { /* and -2 Im */
        const REAL c = w[2 * k], s = w[2 * k + 1], re = z[2 * k], im = z[2 * k + 1];
        upwards[k] = 2 * (c * re + s * im);
        downwards[n - k] = 2 * (s * re - c * im);
    }
    if (n % 2 == 0 && n / 2 < used) upwards[n / 2] = 2 * (w[n] * z[n] + w[n + 1] * z[n + 1]);
}

/* by its mirror image: shorter FFTs have been made of half as many points, but lose digits */
CLONES static void OF(closed_row)(const Line *l, REAL *x)
{
    const long m = l->points - 1;
    REAL *restrict y = l->row;
    const REAL *restrict z = l->half;
    memcpy(y, x, (m + 1) * sizeof *x);
    for (long k = 1; k < m; k++) y[2 * m - k] = x[k];
    EXECUTE(l->to_half);
    for (long k = 0; k <= m; k++) x[k] = z[2 * k];
}

/* the same of a field that is odd about both ends, at which it vanishes */
CLONES static void OF(closed_odd_row)(const Line *l, REAL *x)
{
    const long m = l->points - 1;
    REAL *restrict y = l->row;
    const REAL *restrict z = l->half;
    y[0] = y[m] = 0.0;
    for (long k = 1; k < m; k++) {
        y[k] = x[k];
        y[2 * m - k] = -x[k];
    }
    EXECUTE(l->to_half);
    for (long k = 1; k < m; k++) x[k] = -z[2 * k + 1];
    x[0] = x[m] = 0.0;
}

/* x_(n-j) in place of x_j; x_0, which vanishes, stays */
static void OF(turn_round)(REAL *x, long n)
{
    for (long i = 1, j = n - 1; i < j; i++, j--) {
        const REAL other = x[i];
        x[i] = x[j];
        x[j] = other;
    }
    x[0] = 0.0;
}

/* An open row of a field that is odd, and goes on evenly beyond the last point: by the cosines of what
   begins there, sin(w j) = (-1)^k cos(w (n - j)) with w = pi (k + 1/2) / n. */
static void OF(open_odd_row)(const Line *l, REAL *x, int back)
{
    const long n = l->points;
    if (!back) {
        OF(turn_round)(x, n);
        OF(open_forward)(l, x, n);
    }
    for (long k = (n + 1) / 2; k < n; k++) x[k] = -x[k]; /* waves of odd number */
    if (back) {
        OF(open_backward)(l, x, n);
        OF(turn_round)(x, n);
    }
}

/* of each row the first `used` hold anything, or are asked for */
static void OF(rows)(const Line *l, REAL *x, long count, int back, long odd, long used)
{
    for (long j = 0; j < count; j++, x += l->points) {
        if (!back && (odd || l->closed)) memset(x + used, 0, (l->points - used) * sizeof *x);
        if (odd && l->closed) OF(closed_odd_row)(l, x);
        else if (odd) OF(open_odd_row)(l, x, back);
        else if (l->closed) OF(closed_row)(l, x);
        else if (back) OF(open_backward)(l, x, used);
        else OF(open_forward)(l, x, used);
    }
}

/* b (columns x wide) = transpose of a (rows x columns), 16 by 16 */
static void OF(transpose)(const REAL *restrict a, long rows, long columns, REAL *restrict b, long wide)
{
    for (long i = 0; i < rows; i += 16)
        for (long j = 0; j < columns; j += 16) {
            const long last = i + 16 < rows ? i + 16 : rows, end = j + 16 < columns ? j + 16 : columns;
            for (long l = j; l < end; l++)
                for (long k = i; k < last; k++) b[l * wide + k] = a[k * columns + l];
        }
}

static void OF(transpose_back)(const REAL *restrict b, long rows, long columns, REAL *restrict a,
                           long wide)
{
    for (long i = 0; i < rows; i += 16)
        for (long j = 0; j < columns; j += 16) {
            const long last = i + 16 < rows ? i + 16 : rows, end = j + 16 < columns ? j + 16 : columns;
            for (long k = i; k < last; k++)
                for (long l = j; l < end; l++) a[k * columns + l] = b[l * wide + k];
        }
}

/* real to spectrum; of an even field only the first `used` rows, and columns, hold anything */
static void OF(forward)(const Transform *t, long used, long columns)
{
    const long r = t->shape[0], c = t->shape[1];
    if (!t->even) EXECUTE(t->forward);
    else
        for (long i = 0; i < t->count; i++) {
            REAL *x = (REAL *)t->real + i * r * c, *s = (REAL *)t->spectrum + i * r * c;
            OF(rows)(&t->line[1], x, r > 1 ? used : 1, 0, t->odd[i][1], columns);
            if (r == 1) continue;
            OF(transpose)(x, used, c, s, r);
            OF(rows)(&t->line[0], s, c, 0, t->odd[i][0], used);
        }
}

/* spectrum to real, of an even field the first `used` rows, and columns, only */
static void OF(backward)(const Transform *t, long used, long columns)
{
    const long r = t->shape[0], c = t->shape[1];
    if (!t->even) EXECUTE(t->backward);
    else
        for (long i = 0; i < t->count; i++) {
            REAL *x = (REAL *)t->real + i * r * c, *s = (REAL *)t->spectrum + i * r * c;
            if (r > 1) {
                OF(rows)(&t->line[0], s, c, 1, t->odd[i][0], used);
                OF(transpose_back)(s, used, c, x, r);
            }
            OF(rows)(&t->line[1], x, r > 1 ? used : 1, 1, t->odd[i][1], columns);
        }
}

static REAL *OF(row_of)(const Transform *t, long field, long row)
{
    return (REAL *)t->real + (field * t->shape[0] + row) * t->shape[1];
}

static void OF(clear_beyond)(const Transform *t, const long *shape)
{
    const long c = t->shape[1];
    for (long i = 0; i < t->count; i++) {
        for (long j = 0; j < shape[0] && shape[1] < c; j++)
            memset(OF(row_of)(t, i, j) + shape[1], 0, (c - shape[1]) * sizeof(REAL));
        if (shape[0] < t->shape[0] && !t->even)
            memset(OF(row_of)(t, i, shape[0]), 0, (t->shape[0] - shape[0]) * c * sizeof(REAL));
    }
}

CLONES static void OF(put_row)(const Transform *t, long field, long row, long first,
                               const double *restrict weight, const double *restrict x, long n)
{
    REAL *restrict r = OF(row_of)(t, field, row) + first;
    if (weight)
        for (long k = 0; k < n; k++) r[k] = weight[k] * x[k];
    else
        for (long k = 0; k < n; k++) r[k] = x[k];
}

static void OF(put_nodes)(const Transform *t, long field, const int *at, const double *x, long n)
{
    REAL *r = OF(row_of)(t, field, 0);
    for (long k = 0; k < n; k++) r[at[k]] = x[k];
}

CLONES static void OF(take_row)(const Transform *t, long field, long row, double mean, double factor,
                                const double *scale, const double *own, double *out, long n)
{
    const REAL *restrict r = OF(row_of)(t, field, row);
    if (scale)
        for (long k = 0; k < n; k++) out[k] = (r[k] - mean) * factor * scale[k] + own[k];
    else
        for (long k = 0; k < n; k++) out[k] = (r[k] - mean) * factor + own[k];
}

static void OF(take_nodes)(const Transform *t, long field, const int *at, double mean, double factor,
                           const double *own, double *out, long n)
{
    const REAL *restrict r = OF(row_of)(t, field, 0);
    for (long k = 0; k < n; k++) out[k] = (r[at[k]] - mean) * factor + own[k];
}

CLONES static void OF(blend_row)(const Transform *t, long field, long row, const double *restrict into,
                                 const double *restrict back, const double *x, double *out, long n)
{
    const REAL *restrict r = OF(row_of)(t, field, row);
    for (long k = 0; k < n; k++) out[k] = x[k] + back[k] * (r[k] - into[k] * x[k]);
}

static void OF(add_nodes)(const Transform *t, const int *at, const int *node, const double *weight,
                          const double *x, long n)
{
    REAL *r = t->real;
    for (long k = 0; k < n; k++) r[at[k]] += weight[k] * x[node[k]];
}

static void OF(subtract_nodes)(const Transform *t, const int *at, const int *node, const double *weight,
                               double own, double *x, long n)
{
    const REAL *r = t->real;
    for (long k = 0; k < n; k++) x[node[k]] -= weight[k] * (own * weight[k] * x[node[k]] + r[at[k]]);
}

CLONES static void OF(complement)(long n, double whole, double share, void *symbol)
{
    REAL *restrict s = symbol;
    for (long k = 0; k < n; k++) s[k] = (whole - s[k]) * share;
}

/* complex x times a real symbol, in place */
CLONES void OF(times)(REAL *restrict x, const REAL *restrict s, long n)
{
    for (long k = 0; k < n; k++) {
        x[2 * k] *= s[k];
        x[2 * k + 1] *= s[k];
    }
}

/* the spectrum of a field times a real symbol, in place */
CLONES static void OF(filter)(const Transform *t, long field, const void *symbol)
{
    const long n = t->waves;
    REAL *restrict x = (REAL *)t->spectrum + (t->even ? n : 2 * n) * field;
    const REAL *restrict s = symbol;
    for (long k = 0; k < n && t->even; k++) x[k] *= s[k];
    if (!t->even) OF(times)(x, s, n);
}

/* the symbol 1 / gain / (1 + C D) of compliances C, D the stiffness */
CLONES static void OF(invert)(long n, const double *restrict compliance, double stiffness, double gain,
                              void *symbol)
{
    REAL *restrict s = symbol;
    for (long k = 0; k < n; k++) s[k] = 1.0 / gain / (compliance[k] * stiffness + 1.0);
}

/* x += s y, or conj(s) y, for complex x and y and a symbol that is real or complex */
CLONES void OF(add_times)(REAL *restrict x, const REAL *restrict s, const REAL *restrict y, long n,
                          int is_complex, REAL sign)
{
    if (!is_complex)
        for (long k = 0; k < n; k++) {
            x[2 * k] += s[k] * y[2 * k];
            x[2 * k + 1] += s[k] * y[2 * k + 1];
        }
    else
        for (long k = 0; k < n; k++) {
            const REAL a = s[2 * k], b = sign * s[2 * k + 1], u = y[2 * k], v = y[2 * k + 1];
            x[2 * k] += a * u - b * v;
            x[2 * k + 1] += a * v + b * u;
        }
}

/* WAVES waves at a time, which stay in the cache. */
static void OF(couple)(const Response *r, int transposed)
{
    Transform *t = r->transform;
    const long waves = t->waves, m = r->boxes;
    REAL *x = t->spectrum, *product = r->product;
    for (long from = 0; from < waves; from += WAVES) {
        const long n = waves - from < WAVES ? waves - from : WAVES;
        for (long f = 0; f < t->count; f++) {
            REAL *own = x + 2 * (f * waves + from);
            memcpy(product + 2 * f * WAVES, own, 2 * n * sizeof *x);
            memset(own, 0, 2 * n * sizeof *x);
        }
        for (long i = 0; i < r->components; i++)
            for (long j = 0; j < r->components; j++) {
                const REAL *s = r->symbol[i][j];
                const long numbers = r->is_complex[i][j] ? 2 : 1;
                if (!s) continue;
                for (long a = 0; a < m; a++)
                    for (long b = 0; b < m; b++) {
                        const long to = transposed ? j * m + b : i * m + a;
                        const long source = transposed ? i * m + a : j * m + b;
                        OF(add_times)(x + 2 * (to * waves + from),
                                      s + ((a * m + b) * waves + from) * numbers,
                                      product + 2 * source * WAVES, n, r->is_complex[i][j],
                                      transposed ? -1 : 1);
                    }
            }
    }
}

/* The blocks, or their transpose, times spectra of even and odd fields, whose numbers are real. */
CLONES static void OF(couple_real)(const Response *r, int transposed)
{
    Transform *t = r->transform;
    const long waves = t->waves;
    REAL *product = r->product;
    for (long from = 0; from < waves; from += WAVES) {
        const long n = waves - from < WAVES ? waves - from : WAVES;
        for (long f = 0; f < t->count; f++) {
            REAL *own = (REAL *)t->spectrum + f * waves + from;
            memcpy(product + f * WAVES, own, n * sizeof(REAL));
            memset(own, 0, n * sizeof(REAL));
        }
        for (long i = 0; i < r->components; i++)
            for (long j = 0; j < r->components; j++) {
                if (!r->symbol[i][j]) continue;
                const REAL *restrict s = (const REAL *)r->symbol[i][j] + from;
                const REAL *restrict y = product + (transposed ? i : j) * WAVES;
                REAL *restrict own = (REAL *)t->spectrum + (transposed ? j : i) * waves + from;
                for (long k = 0; k < n; k++) own[k] += s[k] * y[k];
            }
    }
}

static void OF(multiply)(const Response *r, int transposed)
{
    if (r->product && r->transform->even) OF(couple_real)(r, transposed);
    else if (r->product) OF(couple)(r, transposed);
    else
        for (long i = 0; i < r->components; i++) OF(filter)(r->transform, i, r->symbol[i][i]);
}
