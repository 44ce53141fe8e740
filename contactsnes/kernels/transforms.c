/* Real transforms of fields on a circle, and cosine transforms of even ones made from real FFTs:
   FFTW's own cosine transforms take several times as long.

   Open rows (the field goes on oddly beyond the last point, FFTW's REDFT01 and REDFT10) by Makhoul,
   IEEE Trans. Acoust. Speech Signal Process. 28, 27 (1980); their waves stay in the order of his FFT:
   even numbers upwards, then odd ones downwards. Closed rows (REDFT00) by an FFT of all of their period. */
#include "kernels.h"
#include <string.h>

struct Libraries libraries;

CLONES static void open_forward(const Line *l, double *x)
{
    const long n = l->points;
    double *restrict z = l->half;
    const double *restrict w = l->turn;
    z[0] = x[0];
    z[1] = 0.0;
    for (long k = 1; k <= n / 2; k++) { /* (x_k - i x_(n-k)) exp(i pi k / 2n) */
        const double u = x[k], v = x[n - k], c = w[2 * k], s = w[2 * k + 1];
        z[2 * k] = u * c + v * s;
        z[2 * k + 1] = u * s - v * c;
    }
    libraries.execute(l->to_row);
    memcpy(x, l->row, n * sizeof *x);
}

CLONES static void open_backward(const Line *l, double *x)
{
    const long n = l->points;
    const double *restrict z = l->half, *restrict w = l->turn;
    memcpy(l->row, x, n * sizeof *x);
    libraries.execute(l->to_half);
    x[0] = 2.0 * z[0];
    for (long k = 1; k <= n / 2; k++) { /* 2 Re and -2 Im of exp(-i pi k / 2n) V_k */
        const double c = w[2 * k], s = w[2 * k + 1], re = z[2 * k], im = z[2 * k + 1];
        x[n - k] = 2.0 * (s * re - c * im);
        x[k] = 2.0 * (c * re + s * im);
    }
}

/* by its mirror image: shorter FFTs have been made of half as many points, but lose digits */
CLONES static void closed_row(const Line *l, double *x)
{
    const long m = l->points - 1;
    double *restrict y = l->row;
    const double *restrict z = l->half;
    memcpy(y, x, (m + 1) * sizeof *x);
    for (long k = 1; k < m; k++) y[2 * m - k] = x[k];
    libraries.execute(l->to_half);
    for (long k = 0; k <= m; k++) x[k] = z[2 * k];
}

/* the same of a field that is odd about both ends, at which it vanishes */
CLONES static void closed_odd_row(const Line *l, double *x)
{
    const long m = l->points - 1;
    double *restrict y = l->row;
    const double *restrict z = l->half;
    y[0] = y[m] = 0.0;
    for (long k = 1; k < m; k++) {
        y[k] = x[k];
        y[2 * m - k] = -x[k];
    }
    libraries.execute(l->to_half);
    for (long k = 1; k < m; k++) x[k] = -z[2 * k + 1];
    x[0] = x[m] = 0.0;
}

/* x_(n-j) in place of x_j; x_0, which vanishes, stays */
static void turn_round(double *x, long n)
{
    for (long i = 1, j = n - 1; i < j; i++, j--) {
        const double other = x[i];
        x[i] = x[j];
        x[j] = other;
    }
    x[0] = 0.0;
}

/* An open row of a field that is odd, and goes on evenly beyond the last point: by the cosines of what
   begins there, sin(w j) = (-1)^k cos(w (n - j)) with w = pi (k + 1/2) / n. */
static void open_odd_row(const Line *l, double *x, int back)
{
    const long n = l->points;
    if (!back) {
        turn_round(x, n);
        open_forward(l, x);
    }
    for (long k = (n + 1) / 2; k < n; k++) x[k] = -x[k]; /* waves of odd number */
    if (back) {
        open_backward(l, x);
        turn_round(x, n);
    }
}

static void rows(const Line *l, double *x, long count, int back, long odd)
{
    for (long j = 0; j < count; j++, x += l->points) {
        if (odd && l->closed) closed_odd_row(l, x);
        else if (odd) open_odd_row(l, x, back);
        else if (l->closed) closed_row(l, x);
        else if (back) open_backward(l, x);
        else open_forward(l, x);
    }
}

/* b (columns x wide) = transpose of a (rows x columns), 16 by 16 */
static void transpose(const double *restrict a, long rows, long columns, double *restrict b, long wide)
{
    for (long i = 0; i < rows; i += 16)
        for (long j = 0; j < columns; j += 16) {
            const long last = i + 16 < rows ? i + 16 : rows, end = j + 16 < columns ? j + 16 : columns;
            for (long l = j; l < end; l++)
                for (long k = i; k < last; k++) b[l * wide + k] = a[k * columns + l];
        }
}

static void transpose_back(const double *restrict b, long rows, long columns, double *restrict a,
                           long wide)
{
    for (long i = 0; i < rows; i += 16)
        for (long j = 0; j < columns; j += 16) {
            const long last = i + 16 < rows ? i + 16 : rows, end = j + 16 < columns ? j + 16 : columns;
            for (long k = i; k < last; k++)
                for (long l = j; l < end; l++) a[k * columns + l] = b[l * wide + k];
        }
}

static int counted(const Transform *t)
{
    t->counter[0] += t->cost;
    return t->counter[0] > t->counter[1] ? TOO_MANY : 0;
}

/* real to spectrum; in the plane only the first `used` rows of an even field hold anything */
int forward(Transform *t, long used)
{
    const long r = t->shape[0], c = t->shape[1];
    if (!t->even) libraries.execute(t->forward);
    else
        for (long i = 0; i < t->count; i++) {
            double *x = t->real + i * r * c, *s = t->spectrum + i * r * c;
            rows(&t->line[1], x, r > 1 ? used : 1, 0, t->odd[i][1]);
            if (r == 1) continue;
            transpose(x, used, c, s, r);
            for (long j = 0; j < c && used < r; j++)
                memset(s + j * r + used, 0, (r - used) * sizeof *s);
            rows(&t->line[0], s, c, 0, t->odd[i][0]);
        }
    return counted(t);
}

/* spectrum to real, of an even field in the plane the first `used` rows only */
int backward(Transform *t, long used)
{
    const long r = t->shape[0], c = t->shape[1];
    if (!t->even) libraries.execute(t->backward);
    else
        for (long i = 0; i < t->count; i++) {
            double *x = t->real + i * r * c, *s = t->spectrum + i * r * c;
            if (r > 1) {
                rows(&t->line[0], s, c, 1, t->odd[i][0]);
                transpose_back(s, used, c, x, r);
            }
            rows(&t->line[1], x, r > 1 ? used : 1, 1, t->odd[i][1]);
        }
    return counted(t);
}

double *row_of(const Transform *t, long field, long row)
{
    return t->real + (field * t->shape[0] + row) * t->shape[1];
}

/* zeros in the columns beyond a box, and in the rows beyond it that a transform reads */
void clear_beyond(const Transform *t, const long *shape)
{
    const long c = t->shape[1];
    for (long i = 0; i < t->count; i++) {
        for (long j = 0; j < shape[0] && shape[1] < c; j++)
            memset(row_of(t, i, j) + shape[1], 0, (c - shape[1]) * sizeof(double));
        if (shape[0] < t->shape[0] && !t->even)
            memset(row_of(t, i, shape[0]), 0, (t->shape[0] - shape[0]) * c * sizeof(double));
    }
}

void load_box(const Transform *t, long field, const long *shape, const double *values)
{
    for (long j = 0; j < shape[0]; j++)
        memcpy(row_of(t, field, j), values + j * shape[1], shape[1] * sizeof(double));
}

/* x += s y, or conj(s) y, for complex x and y and a symbol that is real or complex */
CLONES void add_times(double *restrict x, const double *restrict s, const double *restrict y, long n,
                      int is_complex, double sign)
{
    if (!is_complex)
        for (long k = 0; k < n; k++) {
            x[2 * k] += s[k] * y[2 * k];
            x[2 * k + 1] += s[k] * y[2 * k + 1];
        }
    else
        for (long k = 0; k < n; k++) {
            const double a = s[2 * k], b = sign * s[2 * k + 1], u = y[2 * k], v = y[2 * k + 1];
            x[2 * k] += a * u - b * v;
            x[2 * k + 1] += a * v + b * u;
        }
}

/* The blocks, or their transpose, times spectra, so many waves at a time that these stay in the
   processor's nearest memory: `product` has room for them. */
static void couple(Response *r, int transposed)
{
    Transform *t = r->transform;
    const long n = t->waves, m = r->boxes, rows = t->count;
    for (long at = 0; at < n; at += WAVES) {
        const long part = n - at < WAVES ? n - at : WAVES;
        for (long row = 0; row < rows; row++) {
            double *x = t->spectrum + 2 * (row * n + at);
            memcpy(r->product + 2 * row * WAVES, x, 2 * part * sizeof *x);
            memset(x, 0, 2 * part * sizeof *x);
        }
        for (long i = 0; i < r->components; i++)
            for (long j = 0; j < r->components; j++) {
                const int is_complex = (int)r->is_complex[i][j];
                const long wide = is_complex ? 2 : 1;
                const double *s = r->symbol[i][j];
                for (long a = 0; s && a < m; a++)
                    for (long b = 0; b < m; b++) {
                        const long to = transposed ? j * m + b : i * m + a;
                        const long from = transposed ? i * m + a : j * m + b;
                        add_times(t->spectrum + 2 * (to * n + at), s + wide * ((a * m + b) * n + at),
                                  r->product + 2 * from * WAVES, part, is_complex,
                                  transposed ? -1.0 : 1.0);
                    }
            }
    }
}

/* The same of even and odd fields, whose spectra are real. */
CLONES static void couple_real(Response *r, int transposed)
{
    Transform *t = r->transform;
    const long n = t->waves, m = r->components;
    double given[MOST][WAVES];
    for (long at = 0; at < n; at += WAVES) {
        const long part = n - at < WAVES ? n - at : WAVES;
        for (long i = 0; i < m; i++)
            memcpy(given[i], t->spectrum + i * n + at, part * sizeof(double));
        for (long i = 0; i < m; i++) {
            double *restrict x = t->spectrum + i * n + at;
            memset(x, 0, part * sizeof *x);
            for (long j = 0; j < m; j++) {
                const double *restrict s = transposed ? r->symbol[j][i] : r->symbol[i][j];
                const double *restrict y = given[j];
                for (long k = 0; k < part && s; k++) x[k] += s[at + k] * y[k];
            }
        }
    }
}

/* The operator, or its transpose, times what stands in the transform's boxes, in place. */
int convolve(Response *r, int transposed)
{
    Transform *t = r->transform;
    int status;
    clear_beyond(t, r->shape);
    if ((status = forward(t, r->shape[0]))) return status;
    if (t->even) couple_real(r, transposed);
    else if (r->product) couple(r, transposed);
    else {
        const double *restrict s = r->symbol[0][0];
        for (long k = 0; k < t->waves; k++) {
            t->spectrum[2 * k] *= s[k];
            t->spectrum[2 * k + 1] *= s[k];
        }
    }
    return backward(t, r->shape[0]);
}
