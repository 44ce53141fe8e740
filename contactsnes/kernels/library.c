/* What tells Python which build this is: its sources, and the sizes of its structures in the order of
   structures.STRUCTURES. */
#include "kernels.h"

#ifndef KERNELS_CHECKSUM
#define KERNELS_CHECKSUM "unknown"
#endif

const char *kernels_checksum = KERNELS_CHECKSUM;
const long kernels_sizes[] = {
    sizeof(Law), sizeof(Line), sizeof(Transform), sizeof(Response), sizeof(Shares), sizeof(Columns),
    sizeof(Form), sizeof(Motion), sizeof(Arc), sizeof(Circle), sizeof(Block), sizeof(Blur),
    sizeof(Zone), sizeof(TwoGrids), sizeof(Overdamped), sizeof(System), sizeof(Site),
    sizeof(Limits), sizeof(struct Libraries)};
