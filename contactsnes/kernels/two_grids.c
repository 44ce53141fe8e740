/* One component of a plane's linear system on two grids (solvers/patch_systems.py has its mathematics). */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { PARTS = 16 };   /* of a sum, side by side */
enum { SOME = 1024 };  /* nodes whose fields stay in the cache */

/* Symbols times what stands on the circle of patches, in place. */
static int filter_patches(const TwoGrids *g, const void *symbol)
{
    return filter(g->transform, g->transform->shape, symbol);
}

/* Whether processes have some of the patches each, not all. */
static int is_parted(const TwoGrids *g)
{
    return g->transform->multiply != 0;
}

#define BODY "two_grids.h"
#include "both.h"

/* How many nodes a patch has. */
void patch_nodes(long nodes, const int *patch, long points, double *number)
{
    memset(number, 0, points * sizeof *number);
    for (long k = 0; k < nodes; k++) number[patch[k]] += 1.0;
}

/* Weights of nodes by a tangent, and their sums over patches: nothing is solved with it yet. */
void weigh_nodes(TwoGrids *g, const double *tangent)
{
    g->count = 0;
    if (g->transform->single) weigh_in_single(g, tangent);
    else weigh_in_double(g, tangent);
}

/* Some nodes of a field, in doubles. */
static const double *some_of(const void *field, int floats, long at, long n, double *part)
{
    if (!floats) return (const double *)field + at;
    widen((const float *)field + at, part, n);
    return part;
}

/* What the two grids make of a field, to another one or in place. */
static int apply(TwoGrids *g, const void *field, void *out, int floats)
{
    const int single = (int)g->transform->single;
    double part[SOME];
    memset(g->sums, 0, 2 * g->points * sizeof *g->sums);
    for (long at = 0; at < g->nodes; at += SOME) {
        const long n = g->nodes - at < SOME ? g->nodes - at : SOME;
        (single ? gather_in_single : gather_in_double)(g, some_of(field, floats, at, n, part), at, n);
    }
    int status = 0;
    if (g->add_up && !is_parted(g)) status = g->add_up(g->sums, 2 * g->points);
    if (!status) status = single ? on_patches_in_single(g) : on_patches_in_double(g);
    if (status) return status;
    for (long at = 0; at < g->nodes; at += SOME) {
        const long n = g->nodes - at < SOME ? g->nodes - at : SOME;
        double *here = floats ? part : (double *)out + at;
        (single ? scatter_in_single : scatter_in_double)(g, some_of(field, floats, at, n, part), at, n, here);
        if (floats) narrow(here, (float *)out + at, n);
    }
    return 0;
}

/* Adds to some nodes what two grids make of a field there, at most SOME, where what stands for patches is in
   their sums. */
void add_on_two_grids(const TwoGrids *g, const float *field, long at, long n, double *out)
{
    double x[SOME], here[SOME];
    widen(field, x, n);
    (g->transform->single ? scatter_in_single : scatter_in_double)(g, x, at, n, here);
    for (long k = 0; k < n; k++) out[k] += here[k];
}

int on_two_grids(TwoGrids *g, const double *field, double *out)
{
    return apply(g, field, out, 0);
}

int on_two_grids_of_floats(TwoGrids *g, const float *field, float *out)
{
    return apply(g, field, out, 1);
}
