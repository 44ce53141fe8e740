/* One component of a plane's linear system on two grids (solvers/patch_systems.py has its mathematics). */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { PARTS = 16 };   /* of a sum, side by side */

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

/* What stands for patches, of sums over them, in their place. */
static int solve_patches(TwoGrids *g)
{
    const int status = g->add_up && !is_parted(g) ? g->add_up(g->sums, 2 * g->points) : 0;
    if (status) return status;
    return g->transform->single ? on_patches_in_single(g) : on_patches_in_double(g);
}

/* What the two grids make of a field in numbers FIELD, to another one or in place. */
#define ON_TWO_GRIDS(FIELD, NAME, GATHERED, SCATTERED)                          \
    int NAME(TwoGrids *g, const FIELD *field, FIELD *out)                       \
    {                                                                           \
        memset(g->sums, 0, 2 * g->points * sizeof *g->sums);                    \
        if (g->transform->single) GATHERED##_in_single(g, field);               \
        else GATHERED##_in_double(g, field);                                    \
        const int status = solve_patches(g);                                    \
        if (status) return status;                                              \
        if (g->transform->single) SCATTERED##_in_single(g, field, out);         \
        else SCATTERED##_in_double(g, field, out);                              \
        return 0;                                                               \
    }
ON_TWO_GRIDS(double, on_two_grids, gather_doubles, scatter_doubles)
ON_TWO_GRIDS(float, on_two_grids_of_floats, gather_floats, scatter_floats)

/* Adds to some nodes what two grids make of a field there, where what stands for patches is in their sums. */
void add_on_two_grids(const TwoGrids *g, const float *field, long at, long n, double *out)
{
    if (g->transform->single) scatter_on_in_single(g, field, at, n, out);
    else scatter_on_in_double(g, field, at, n, out);
}
