/* Overdamped motion linearised at a state (dynamics.linearised), and runs of Arnoldi's method that look for
   its modes. */
#include "kernels.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { PIECE = 1024 };

CLONES static double inner(const double *restrict x, const double *restrict y, long n)
{
    double sum = 0.0;
    for (long i = 0; i < n; i++) sum += x[i] * y[i];
    return sum;
}

/* part[k] += inner product of row k and x, n numbers of them; `size` numbers from one row to the next */
CLONES static void add_inner(long count, long size, const double *restrict rows, const double *restrict x,
                             double *restrict part, long n)
{
    long k = 0;
    for (; k + 4 <= count; k += 4) {
        const double *r = rows + k * size;
        double first = 0.0, second = 0.0, third = 0.0, fourth = 0.0;
        for (long i = 0; i < n; i++) {
            first += r[i] * x[i];
            second += r[size + i] * x[i];
            third += r[2 * size + i] * x[i];
            fourth += r[3 * size + i] * x[i];
        }
        part[k] += first, part[k + 1] += second, part[k + 2] += third, part[k + 3] += fourth;
    }
    for (; k < count; k++)
        for (long i = 0; i < n; i++) part[k] += rows[k * size + i] * x[i];
}

/* x += sum over k of sign factors[k] times row k, n numbers of them */
CLONES static void add_rows(long count, long size, double sign, const double *restrict factors,
                            const double *restrict rows, double *restrict x, long n)
{
    long k = 0;
    for (; k + 4 <= count; k += 4) {
        const double *r = rows + k * size;
        const double first = sign * factors[k], second = sign * factors[k + 1], third = sign * factors[k + 2],
                     fourth = sign * factors[k + 3];
        for (long i = 0; i < n; i++)
            x[i] += (first * r[i] + second * r[size + i]) + (third * r[2 * size + i] + fourth * r[3 * size + i]);
    }
    for (; k < count; k++) {
        const double factor = sign * factors[k];
        for (long i = 0; i < n; i++) x[i] += factor * rows[k * size + i];
    }
}

/* part[k] = inner product of row k and x */
static void inner_with_rows(long count, long size, const double *rows, const double *x, double *part)
{
    for (long k = 0; k < count; k++) part[k] = 0.0;
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        add_inner(count, size, rows + from, x + from, part, n);
    }
}

/* x -= sum over k of part[k] times row k */
static void subtract_rows(long count, long size, const double *rows, const double *part, double *x)
{
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        add_rows(count, size, -1.0, part, rows + from, x + from, n);
    }
}

/* Modes of a projection, and what J leaves of them: each vector is the sum of `count` rows of the basis by
   the mode's coefficients, and its defect that of the images, less its value times the vector. */
void ritz(long count, long size, const double *basis, const double *images, long modes,
          const double *coefficients, const double *values, double *vectors, double *defects)
{
    for (long from = 0; from < size; from += PIECE) {
        const long n = size - from < PIECE ? size - from : PIECE;
        for (long mode = 0; mode < modes; mode++) {
            const double *factors = coefficients + mode * count;
            double *vector = vectors + mode * size + from, *defect = defects + mode * size + from;
            memset(vector, 0, n * sizeof *vector);
            add_rows(count, size, 1.0, factors, basis + from, vector, n);
            for (long i = 0; i < n; i++) defect[i] = -values[mode] * vector[i];
            add_rows(count, size, 1.0, factors, images + from, defect, n);
        }
    }
}

/* The products of the last of `count` vectors with their images, and of its image with them. */
static void multiply(long count, long size, long room, const double *basis, const double *images, double *products)
{
    const double *own = basis + (count - 1) * size, *moved = images + (count - 1) * size;
    inner_with_rows(count, size, images, own, products + (count - 1) * room);
    for (long k = 0; k < count; k++) products[k * room + count - 1] = inner(basis + k * size, moved, size);
}

/* Appends a vector, made orthonormal to `count` others, with its image, the products of vectors with images,
   a matrix with rows for `room`, and how large what rounding left of the image may be; whether more than
   `least` of it was new (holding.holding). Vector and image may stand where they are to be. */
int hold(long count, long size, long room, double *basis, double *images, double *products, double *errors,
         const double *vector, const double *image, double least)
{
    double *own = basis + count * size, *moved = images + count * size, *part = products + count * room;
    if (own != vector) {
        memcpy(own, vector, size * sizeof *own);
        memcpy(moved, image, size * sizeof *own);
    }
    double norm = sqrt(inner(own, own, size)), square = norm * norm * DBL_EPSILON * DBL_EPSILON;
    /* twice is enough, once where much is left */
    for (int pass = 0; pass < 2 && count; pass++) {
        const double before = norm;
        inner_with_rows(count, size, basis, own, part);
        subtract_rows(count, size, basis, part, own);
        subtract_rows(count, size, images, part, moved);
        for (long k = 0; k < count; k++) square += part[k] * part[k] * errors[k] * errors[k];
        norm = sqrt(inner(own, own, size));
        if (norm > 0.5 * before) break;
    }
    if (!(norm > least)) return 0;
    for (long i = 0; i < size; i++) {
        own[i] /= norm;
        moved[i] /= norm;
    }
    errors[count] = sqrt(square) / norm;
    multiply(count + 1, size, room, basis, images, products);
    return 1;
}

/* Adds uniform displacements to the components whose mean can move. */
static void shift_means(const Overdamped *o, const double *mean, double *x)
{
    const Form *f = o->form;
    const long n = f->nodes;
    for (long row = 0; row < f->forced_count; row++) {
        double *field = x + f->forced[row] * n;
        const double moved = mean[row] / f->root;
        for (long i = 0; i < n; i++) field[i] += f->scale ? moved * f->scale[i] : moved;
    }
}

/* out = J x */
int overdamped_product(const Overdamped *o, const double *x, double *out)
{
    const Form *f = o->form;
    double *rate = out + f->components * f->nodes, moved[MOST];
    int status = product(o->form, x, out);
    for (long row = 0; row < f->forced_count; row++) {
        rate[row] /= o->row[row];
        moved[row] = o->push[row] * rate[row];
    }
    shift_means(o, moved, out);
    return status;
}

/* out = about J^-1 x, which is overwritten */
int overdamped_precondition(const Overdamped *o, double *x, double *out)
{
    const Form *f = o->form;
    double *rate = x + f->components * f->nodes, moved[MOST];
    for (long row = 0; row < f->forced_count; row++) {
        moved[row] = -o->push[row] * rate[row];
        rate[row] *= o->row[row];
    }
    shift_means(o, moved, x);
    return precondition(o->zone, x, out);
}

/* A run of `count` products on 1 - P^-1 (J - shift) from `begin`, which is overwritten; its vectors are
   appended to `*held` others as `hold` does, for all of which there is room. Images in which rounding may
   have grown beyond `astray` are made anew. */
int arnoldi(const Overdamped *o, double shift, double *begin, long count, long *held, long room, double *basis,
            double *images, double *products, double *errors, double astray)
{
    const Form *f = o->form;
    const long size = f->components * f->nodes + f->forced_count;
    double *rows = basis + *held * size, *moved = images + *held * size, *part = products + *held * room;
    long made = 0;
    for (; made < count; made++) {
        double *own = rows + made * size, *image = moved + made * size;
        for (int pass = 0; pass < 2 && made; pass++) {
            inner_with_rows(made, size, rows, begin, part);
            subtract_rows(made, size, rows, part, begin);
        }
        const double norm = sqrt(inner(begin, begin, size));
        if (norm == 0.0) break;
        for (long i = 0; i < size; i++) own[i] = begin[i] / norm;
        int status = overdamped_product(o, own, image);
        if (status) return status;
        if (made + 1 == count) continue;
        double *right = image + size; /* the next image is not made yet */
        for (long i = 0; i < size; i++) right[i] = image[i] - shift * own[i];
        if ((status = overdamped_precondition(o, right, begin))) return status;
        for (long i = 0; i < size; i++) begin[i] = own[i] - begin[i];
    }
    for (long k = 0; k < made; k++) {
        double *own = basis + *held * size, *image = images + *held * size;
        if (!hold(*held, size, room, basis, images, products, errors, rows + k * size, moved + k * size, 1e-6))
            continue;
        ++*held;
        if (errors[*held - 1] <= astray) continue;
        int status = overdamped_product(o, own, image);
        if (status) return status;
        errors[*held - 1] = DBL_EPSILON;
        multiply(*held, size, room, basis, images, products);
    }
    return 0;
}
