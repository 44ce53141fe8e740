"""Compiled kernels: law, transforms, residual, products, preconditioner and PETSc's callbacks in
plain C, which do what the NumPy forms do where the library was built."""
