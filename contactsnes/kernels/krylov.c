/* Krylov vectors in single precision, rows of floats: sums are in double, a piece of the vector at a time
   for all rows, while it is in the cache. */
#include "kernels.h"

enum { PIECE = 1024 };

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
