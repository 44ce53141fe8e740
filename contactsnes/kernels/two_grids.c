/* One component of a plane's linear system on two grids (solvers/patch_systems.py has its mathematics). */
#include "kernels.h"
#include <math.h>
#include <string.h>

enum { PARTS = 16 }; /* of a sum, side by side */

#define BODY "two_grids.h"
#include "both.h"

/* How many nodes a patch has. */
void patch_nodes(long nodes, const int *patch, long points, double *number)
{
    memset(number, 0, points * sizeof *number);
    for (long k = 0; k < nodes; k++) number[patch[k]] += 1.0;
}

/* Weights of nodes by a tangent, and their sums over patches. */
void weigh_nodes(TwoGrids *g, const double *tangent)
{
    if (g->transform->single) weigh_in_single(g, tangent);
    else weigh_in_double(g, tangent);
}

/* What the two grids make of a field, in place. */
int on_two_grids(TwoGrids *g, double *field)
{
    return g->transform->single ? on_two_grids_in_single(g, field) : on_two_grids_in_double(g, field);
}
