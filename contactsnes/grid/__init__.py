"""The periodic cell: windows and boxes of its nodes, even fields, transforms, reductions, transfer
between grids, contours."""
