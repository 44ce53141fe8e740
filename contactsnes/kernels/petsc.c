/* What PETSc calls: function, Jacobian, products, preconditioner, pre-check of the step and the monitor
   of Ritz values. The context is a System, of a shell matrix and a shell preconditioner, too. */
#include "kernels.h"
#include <stdlib.h>

typedef int (*Work)(System *, const double *, double *);

static int both(System *s, void *x, void *y, Work work)
{
    const double *from;
    double *to;
    int status = libraries.get_read(x, &from);
    if (status) return status;
    if (!(status = libraries.get(y, &to))) {
        status = work(s, from, to);
        libraries.put(y, &to);
    }
    libraries.put_read(x, &from);
    return status;
}

static int fill(System *s, const double *x, double *y)
{
    return s->arc ? arc_residual(s->form, s->arc, x, y) : residual(s->form, x, y);
}

/* Chooses the precision of a linear solve's products and preconditioner when it begins: single where no
   more is asked of it than that holds. One that takes many iterations goes on in double. */
int choose(System *s, int begins)
{
    double relative, absolute, other, size;
    void *right;
    PetscCount count = 0, most = 0;
    int status;
    if (!s->chooses) {
        s->form->single = 0; /* which other solves of the form may have left */
        return 0;
    }
    if (!begins && (status = libraries.iterations(s->ksp, &count))) return status;
    if (count) {
        if (s->form->single && count >= s->patience) {
            s->form->single = 0;
            s->turned++;
        }
        return 0;
    }
    if ((status = libraries.tolerances(s->ksp, &relative, &absolute, &other, &most))) return status;
    if ((status = libraries.right_side(s->ksp, &right))) return status;
    s->form->single = 0;
    if (!right) return 0; /* no solve */
    if ((status = libraries.norm(right, 1, &size))) return status;
    s->form->single = relative >= s->safe || absolute >= s->safe * size;
    return 0;
}

static int multiply(System *s, const double *x, double *y)
{
    return s->arc ? arc_product(s->form, s->arc, x, y) : product(s->form, x, y);
}

static int multiply_transposed(System *s, const double *x, double *y)
{
    return s->arc ? arc_transposed(s->form, s->arc, x, y) : transposed_product(s->form, x, y);
}

static int solve(System *s, const double *x, double *y)
{
    return precondition(s->zone, x, y);
}

int snes_function(void *snes, void *x, void *y, void *system)
{
    (void)snes;
    return both(system, x, y, fill);
}

/* The tangent at x; assembling tells PETSc that the preconditioner has to be set up again. */
int snes_jacobian(void *snes, void *x, void *matrix, void *other, void *context)
{
    System *s = context;
    const double *unknown;
    int status = libraries.get_read(x, &unknown);
    (void)snes;
    if (status) return status;
    if (s->arc) arc_linearise(s->form, s->arc, unknown);
    else linearise(s->form, unknown);
    libraries.put_read(x, &unknown);
    for (int turn = 0; turn < (matrix == other ? 1 : 2) && !status; turn++)
        if (!(status = libraries.assembly_begin(turn ? other : matrix, 0)))
            status = libraries.assembly_end(turn ? other : matrix, 0);
    return status;
}

int mat_mult(void *matrix, void *x, void *y)
{
    System *s;
    int status = libraries.mat_context(matrix, &s);
    return status || (status = choose(s, 0)) ? status : both(s, x, y, multiply);
}

int mat_mult_transpose(void *matrix, void *x, void *y)
{
    System *s;
    int status = libraries.mat_context(matrix, &s);
    return status || (status = choose(s, 0)) ? status : both(s, x, y, multiply_transposed);
}

int mat_view(void *matrix, void *viewer)
{
    System *s;
    int status = libraries.mat_context(matrix, &s);
    return status ? status : libraries.print(viewer, "%s", s->operator_text);
}

int pc_set_up(void *pc)
{
    System *s;
    int status = libraries.pc_context(pc, &s);
    return status || (status = choose(s, 1)) ? status : set_up(s->zone);
}

int pc_apply(void *pc, void *x, void *y)
{
    System *s;
    int status = libraries.pc_context(pc, &s);
    return status || (status = choose(s, 0)) ? status : both(s, x, y, solve);
}

int pc_view(void *pc, void *viewer)
{
    System *s;
    int status = libraries.pc_context(pc, &s);
    return status ? status : libraries.print(viewer, "%s", s->zone_text);
}

/* PETSc's booleans are of four bytes or, from 3.24 on, of one: of either the first byte is set, the others
   being zero (Python loads the library on little-endian processors only). */
int pre_check(void *search, void *x, void *y, unsigned char *changed, void *system)
{
    System *s = system;
    const double *unknown;
    double *step;
    int status = libraries.get_read(x, &unknown), any = 0;
    (void)search;
    if (status) return status;
    if (!(status = libraries.get(y, &step))) {
        regularised_step(s->form, s->newton_stiffness, unknown, step, &any);
        libraries.put(y, &step);
    }
    libraries.put_read(x, &unknown);
    *changed = (unsigned char)any;
    return status;
}

/* Keeps the smallest real part of the Ritz values of the last two linear solves that tell; of `iteration`, whose
   upper half some builds of PETSc have, it has to be known only whether it is the first. */
int monitor_modes(void *snes, int iteration, double norm, void *system)
{
    System *s = system;
    void *ksp;
    PetscCount count = 0, found = 0;
    int status = libraries.get_ksp(snes, &ksp);
    (void)norm;
    if (iteration == 0) s->told = 0;
    if (status || iteration == 0 || (status = libraries.iterations(ksp, &count)) || count < 1)
        return status;
    double *values = malloc(2 * count * sizeof *values);
    if (!values) return 55; /* PETSC_ERR_MEM */
    status = libraries.eigenvalues(ksp, count, values, values + count, &found);
    if (!status && found >= 3) {
        double least = values[0];
        for (PetscCount k = 1; k < found; k++) least = values[k] < least ? values[k] : least;
        s->smallest[s->told++ % 2] = least;
    }
    free(values);
    return status;
}
