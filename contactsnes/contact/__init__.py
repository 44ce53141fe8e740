"""The contact problem on its grid: residuals, states, predictors, energies and observables; without
PETSc."""
