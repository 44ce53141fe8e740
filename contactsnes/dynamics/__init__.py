"""Motion: how a jump goes on, and whether a point is stable."""
