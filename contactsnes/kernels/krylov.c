/* Krylov vectors in single precision, rows of floats: sums are in double, a piece of the vector at a time
   for all rows, while it is in the cache. */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { PIECE = 1024, SAMPLES = 9 };
enum { BETWEEN = 4 };              /* nodes that may be told with others though they are not changed */
static const double TRIFLE = 6e-8;  /* rounding of floats */

/* found[k] = inner product of row k and a vector of doubles, and last that of the vector with itself. */
CLONES void inner_products(long count, long size, const float *const *rows, const double *vector,
                           double *found)
{
    for (long k = 0; k <= count; k++) found[k] = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        const double *restrict v = vector + from;
        for (long k = 0; k < count; k++) {
            const float *restrict row = rows[k] + from;
            double sum = 0.0;
            for (long i = 0; i < n; i++) sum += (double)row[i] * v[i];
            found[k] += sum;
        }
        double square = 0.0;
        for (long i = 0; i < n; i++) square += v[i] * v[i];
        found[count] += square;
    }
}

/* vector += sum over k of factors[k] times row k; its inner product with itself then. */
CLONES double add_rows(long count, long size, const float *const *rows, const double *factors,
                       double *vector)
{
    double found = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        double *restrict v = vector + from;
        for (long k = 0; k < count; k++) {
            const float *restrict row = rows[k] + from;
            const double factor = factors[k];
            for (long i = 0; i < n; i++) v[i] += factor * (double)row[i];
        }
        double square = 0.0;
        for (long i = 0; i < n; i++) square += v[i] * v[i];
        found += square;
    }
    return found;
}

/* The shift that most of some samples have in common. */
static double common(long n, const double *before, const double *after)
{
    double off[SAMPLES], allowed[SAMPLES], found = 0.0;
    long most = -1;
    for (long j = 0; j < SAMPLES; j++) {
        const long at = n * (2 * j + 1) / (2 * SAMPLES);
        off[j] = after[at] - before[at];
        allowed[j] = TRIFLE * (fabs(before[at]) + fabs(after[at]));
    }
    for (long j = 0; j < SAMPLES; j++) {
        long agree = 0;
        for (long i = 0; i < SAMPLES; i++) agree += fabs(off[i] - off[j]) <= allowed[i];
        if (agree > most) found = off[j];
        if (agree > most) most = agree;
    }
    return found;
}

CLONES static void mark(long n, const double *restrict before, const double *restrict after, double shift,
                        unsigned char *restrict changed)
{
    for (long i = 0; i < n; i++) {
        const double off = fabs(after[i] - before[i] - shift);
        changed[i] = !(off <= TRIFLE * (fabs(before[i]) + fabs(after[i])));
    }
}

/* Where a vector differs from another by more than a shift for each piece: runs of nodes (first, count) that
   end with a piece, and what stands there, as far as there is room for `most_runs` and `most`; told: runs and
   values there are. */
void changes(long size, const double *before, const double *after, double *shift, int *runs, long most_runs,
             float *values, long most, int *told)
{
    unsigned char changed[PIECE];
    long count = 0, held = 0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        const double *b = before + from, *a = after + from;
        const double own = shift[from / PIECE] = common(n, b, a);
        mark(n, b, a, own, changed);
        for (long at = 0; at < n;) {
            const unsigned char *found = memchr(changed + at, 1, n - at);
            if (!found) break;
            const long first = found - changed;
            long end = first + 1;
            for (long i = end; i < n && i < end + BETWEEN; i++)
                if (changed[i]) end = i + 1;
            if (count < most_runs && held + end - first <= most) {
                runs[2 * count] = from + first;
                runs[2 * count + 1] = end - first;
                for (long i = first; i < end; i++) values[held + i - first] = a[i];
            }
            count++;
            held += end - first;
            at = end;
        }
    }
    told[0] = count;
    told[1] = held;
}

CLONES static void add_shifted(long n, const float *restrict row, double shift, double factor, double *restrict v)
{
    for (long i = 0; i < n; i++) v[i] += factor * ((double)row[i] + shift);
}

CLONES static void add_instead(long n, const float *restrict row, double shift, const float *restrict value,
                               double factor, double *restrict v)
{
    for (long i = 0; i < n; i++) v[i] += factor * ((double)value[i] - ((double)row[i] + shift));
}

CLONES static double square_of(long n, const double *restrict v)
{
    double square = 0.0;
    for (long i = 0; i < n; i++) square += v[i] * v[i];
    return square;
}

/* vector += sum over k of factors[k] times what row k was changed to (`changes`, with their number of runs);
   its inner product with itself then. */
double add_changed(long count, long size, const float *const *rows, const double *const *shifts,
                   const int *const *runs, const int *run_counts, const float *const *values,
                   const double *factors, double *vector, int *work)
{
    double found = 0.0;
    memset(work, 0, 2 * count * sizeof *work);
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        double *v = vector + from;
        for (long k = 0; k < count; k++) {
            const double shift = shifts[k][from / PIECE];
            int *run = work + 2 * k, *held = run + 1;
            add_shifted(n, rows[k] + from, shift, factors[k], v);
            for (; *run < run_counts[k] && runs[k][2 * *run] < from + n; ++*run) {
                const long first = runs[k][2 * *run], length = runs[k][2 * *run + 1];
                add_instead(length, rows[k] + first, shift, values[k] + *held, factors[k], vector + first);
                *held += length;
            }
        }
        found += square_of(n, v);
    }
    return found;
}
