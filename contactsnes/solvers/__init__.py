"""PETSc's nonlinear solvers around the contact problem: Newton's method, preconditioners,
multigrid, dynamic relaxation."""
