/* One component of a plane's linear system on two grids, in numbers REAL: the BODY of `both.h` for `two_grids.c`. */

/* Weights of nodes by the law's tangent there, and their sums over patches. */
static void OF(weigh)(const TwoGrids *g, const double *restrict tangent)
{
    REAL *inverse = (REAL *)g->inverse;
    double *restrict sums = g->sums;
    memset(sums, 0, g->points * sizeof *sums);
    for (long k = 0; k < g->nodes; k++) {
        const double own = 1.0 / (1.0 + g->compliant * tangent[k]);
        inverse[k] = own;
        sums[g->patch[k]] += own;
    }
}

/* Between nodes and patches, of a field in numbers FIELD. Gathered: sums over each patch of the field, and of the field
   times its weights; four nodes after each other are mostly of one. Scattered: inverse (x + by of its patch), in place
   or not. */
#define BETWEEN(FIELD, GATHER, SCATTER)                                                                       \
    static void OF(GATHER)(const TwoGrids *g, const FIELD *restrict x)                                        \
    {                                                                                                         \
        const REAL *restrict q = (const REAL *)g->inverse;                                                    \
        const int *restrict patch = g->patch;                                                                 \
        for (long k = 0; k < g->nodes;) {                                                                     \
            double *here = g->sums + 2 * patch[k];                                                            \
            const int four = k + 4 <= g->nodes && patch[k] == patch[k + 1] && patch[k] == patch[k + 2]        \
                && patch[k] == patch[k + 3];                                                                  \
            const double a = x[k], b = four ? x[k + 1] : 0.0, c = four ? x[k + 2] : 0.0, d = four ? x[k + 3] : 0.0;\
            here[0] += four ? (a + b) + (c + d) : a;                                                          \
            here[1] += four ? (q[k] * a + q[k + 1] * b) + (q[k + 2] * c + q[k + 3] * d) : q[k] * a;           \
            k += four ? 4 : 1;                                                                                \
        }                                                                                                     \
    }                                                                                                         \
    CLONES static void OF(SCATTER)(const TwoGrids *g, const FIELD *x, FIELD *out)                             \
    {                                                                                                         \
        const REAL *restrict inverse = (const REAL *)g->inverse;                                              \
        const int *restrict patch = g->patch;                                                                 \
        const double *restrict by = g->sums;                                                                  \
        for (long k = 0; k < g->nodes; k++) out[k] = inverse[k] * (x[k] + by[patch[k]]);                      \
    }
BETWEEN(double, gather_doubles, scatter_doubles)
BETWEEN(float, gather_floats, scatter_floats)
#undef BETWEEN

/* out += inverse (x + by of its patch) of some nodes */
CLONES static void OF(scatter_on)(const TwoGrids *g, const float *restrict x, long at, long n, double *restrict out)
{
    const REAL *restrict inverse = (const REAL *)g->inverse + at;
    const int *restrict patch = g->patch + at;
    const double *restrict by = g->sums;
    for (long k = 0; k < n; k++) out[k] += inverse[k] * (x[k] + by[patch[k]]);
}

CLONES static void OF(multiplied)(const REAL *restrict a, const REAL *restrict x, REAL *restrict out, long n)
{
    for (long k = 0; k < n; k++) out[k] = a[k] * x[k];
}

/* out = x + factor a y */
CLONES static void OF(added)(const REAL *x, REAL factor, const REAL *restrict a, const REAL *restrict y, REAL *out,
                             long n)
{
    for (long k = 0; k < n; k++) out[k] = x[k] + factor * a[k] * y[k];
}

CLONES static double OF(inner)(const REAL *restrict x, const REAL *restrict y, long n)
{
    REAL sums[PARTS] = {0};
    double sum = 0.0;
    long k = 0;
    for (; k + PARTS <= n; k += PARTS)
        for (int l = 0; l < PARTS; l++) sums[l] += x[k + l] * y[k + l];
    for (; k < n; k++) sum += x[k] * y[k];
    for (int l = 0; l < PARTS; l++) sum += sums[l];
    return sum;
}

/* Inner products of some vectors with another one. */
static int OF(inner_products)(const TwoGrids *g, const REAL *vectors, long count, const REAL *x, double *found)
{
    for (long j = 0; j < count; j++) found[j] = OF(inner)(vectors + j * g->points, x, g->points);
    return is_parted(g) ? g->add_up(found, count) : 0;
}

CLONES static void OF(moved)(REAL *restrict x, REAL factor, const REAL *restrict y, long n)
{
    for (long k = 0; k < n; k++) x[k] += factor * y[k];
}

/* A row times a factor, and what the core's inverse makes of it. */
static int OF(times_core)(const TwoGrids *g, REAL *row, REAL factor, REAL *made)
{
    REAL *on_circle = g->transform->real;
    for (long k = 0; k < g->points; k++) row[k] *= factor;
    OF(multiplied)(g->core, row, on_circle, g->points);
    const int status = filter_patches(g, g->symbol);
    if (!status) OF(added)(row, -1, g->core, on_circle, made, g->points);
    return status;
}

/* The system of patches times a vector. */
static int OF(times_system)(const TwoGrids *g, const REAL *x, REAL *out)
{
    REAL *on_circle = g->transform->real;
    OF(multiplied)(g->stiffness, x, on_circle, g->points);
    const int status = filter_patches(g, g->compliance);
    if (!status) OF(added)(x, 1, g->there, on_circle, out, g->points);
    return status;
}

/* GMRES for the system of patches, whose right side is the first row: its solution in place of that, its
   Hessenberg matrix and the number of iterations. */
static int OF(solved)(TwoGrids *g)
{
    const long n = g->points;
    REAL *rows = g->rows, *made = g->made;
    double cosines[INNER], sines[INNER], right[INNER + 1], triangle[INNER * INNER], parts[INNER];
    double first, size;
    int status = OF(inner_products)(g, rows, 1, rows, &size);
    if (status) return status;
    right[0] = first = size = sqrt(size);
    g->count = 0;
    while (g->count < INNER && size > 0.0) {
        const long place = g->count++;
        REAL *vector = rows + (place + 1) * n;
        if ((status = OF(times_core)(g, rows + place * n, 1.0 / size, made + place * n))) return status;
        if ((status = OF(times_system)(g, made + place * n, vector))) return status;
        double *column = g->matrix + place * (INNER + 1), turned[INNER + 1];
        if ((status = OF(inner_products)(g, rows, place + 1, vector, column))) return status;
        for (long j = 0; j <= place; j++) OF(moved)(vector, -column[j], rows + j * n, n);
        if ((status = OF(inner_products)(g, vector, 1, vector, &size))) return status;
        size = column[place + 1] = sqrt(size);
        memcpy(turned, column, (place + 2) * sizeof *turned);
        for (long j = 0; j < place; j++) {
            const double above = turned[j], below = turned[j + 1];
            turned[j] = cosines[j] * above + sines[j] * below;
            turned[j + 1] = cosines[j] * below - sines[j] * above;
        }
        const double length = hypot(turned[place], turned[place + 1]);
        cosines[place] = length > 0.0 ? turned[place] / length : 0.0;
        sines[place] = length > 0.0 ? turned[place + 1] / length : 1.0;
        turned[place] = length;
        memcpy(triangle + place * INNER, turned, (place + 1) * sizeof *triangle);
        right[place + 1] = -sines[place] * right[place];
        right[place] *= cosines[place];
        if (!(fabs(right[place + 1]) > g->left * first)) break;
    }
    for (long j = g->count - 1; j >= 0; j--) {
        double known = right[j];
        for (long k = j + 1; k < g->count; k++) known -= triangle[k * INNER + j] * parts[k];
        parts[j] = triangle[j * INNER + j] > 0.0 ? known / triangle[j * INNER + j] : 0.0;
    }
    memset(rows, 0, n * sizeof *rows);
    for (long j = 0; j < g->count; j++) OF(moved)(rows, parts[j], made + j * n, n);
    return 0;
}

/* Sums over patches to what stands for each of them: what its nodes have besides x. */
static int OF(on_patches)(TwoGrids *g)
{
    const long n = g->points;
    REAL *rows = g->rows, *on_circle = g->transform->real;
    double *sums = g->sums;
    int status;
    for (long k = 0; k < n; k++) {
        double *here = sums + 2 * k;
        const double mean = here[0] / g->number[k], moved = mean - here[1] / (g->number[k] * g->mean[k]);
        on_circle[k] = ((here[0] - here[1]) / g->compliant + g->within[k] * (moved - mean)) / g->area;
        rows[k] = mean;
        here[0] = moved - mean;
    }
    if ((status = filter_patches(g, g->compliance))) return status;
    for (long k = 0; k < n; k++) rows[k] = ((const REAL *)g->there)[k] * (rows[k] - on_circle[k]);
    if ((status = OF(solved)(g))) return status;
    for (long k = 0; k < n; k++) sums[k] = sums[2 * k] + rows[k] / g->mean[k];
    return 0;
}
