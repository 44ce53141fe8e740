/* Kernels of the displacement form: law, transforms, residual, products with the Jacobian, its
   preconditioner, and the callbacks that PETSc calls for them.

   Plain C without a header but the compiler's own: what is used of FFTW and PETSc comes as pointers
   to functions (`libraries`), so that one build serves every version of both. All memory belongs to
   Python, which fills these structures (contactsnes/kernels/structures.py), but for what a zone
   needs from one set-up to the next. Arrays are (components, nodes), row by row, box after box. */
#ifndef CONTACTSNES_KERNELS_H
#define CONTACTSNES_KERNELS_H

/* one version of a function for each width of a processor's vectors */
#if defined __GNUC__ && !defined __clang__ && defined __linux__ && defined __x86_64__
#define CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CLONES
#endif

enum { NONE = -1, MOST = 3, FIELDS = 2 * MOST, PATCHES = 3 }; /* components; even and odd parts; sizes of patches */
enum { TOO_MANY = 83 };                     /* status of a count of transforms beyond its limit */
enum { WAVES = 2048 }; /* of a spectrum that blocks are multiplied with at a time */
enum { INNER = 30 }; /* iterations of a system of patches */
enum { COLUMNS = 8 }; /* of spectra that are transformed at a time: a line of the cache in a row */

typedef void (*Sheared)(long, const double *, const double *, const double *, double *, double *,
                        double *, double *, double *, double *);
typedef void (*Tractions)(long, const double *, const double *, const double *, double *, double *);
typedef void (*Normal)(long, const double *, const double *, double *, double *);

typedef struct { /* a traction law: `laws.c` says what its functions fill */
    Sheared sheared;
    Tractions tractions;
    Normal normal;
    const double *parameters;
    double peak, barrier, repulsion; /* largest attraction without slip, and repulsion apart; overlap of a factor e */
} Law;

typedef struct { /* a cosine transform of a row from the axis outwards */
    long points, closed;
    void *row, *half;       /* both sides of the real FFT it is made from */
    const void *turn;       /* open: exp(i pi k / 2 points) */
    void *to_row, *to_half; /* plans; closed needs the last alone */
} Line;

typedef struct { /* of `count` fields on a circle of shape[0] x shape[1] points (1 x m on a line) */
    long even, count, shape[2], waves; /* waves: numbers of a field's spectrum, complex if not even */
    long single;                       /* whether what it holds are floats, not doubles */
    void *real, *spectrum;             /* the same memory for an even line; in the plane transposed; packed: a block */
    long odd[FIELDS][2];               /* if even: of sines in place of cosines, by field and direction */
    long both[2];                      /* directions in which fields are on both sides of the axis, and even and odd
                                          parts, one after the other, are what is transformed: at most one */
    Line line[2];
    void *forward, *backward;
    long packed;          /* in the plane, rows in pairs: as `packed.c` has it, which alone knows these: */
    void *columns, *columns_back; /* plans; those of rows are `forward` and `backward` */
    void *block;
    double cost, *counter; /* of one transform; transforms so far, their limit, and those in single precision */
    /* Of slabs, whose rows processes exchange: Python's, which counts it; null in one process. What stands here,
       zero beyond what is used, times the symbols of a Response, or other real ones, in place. */
    int (*multiply)(const void *response, const void *symbol, int transposed);
} Transform;

/* numbers of a row of a field in pairs of rows, and of a field */
static inline long width_of(const Transform *t)
{
    return t->shape[1] << t->both[1];
}

static inline long room_of(const Transform *t)
{
    return ((t->shape[0] + t->shape[0] % 2) << t->both[0]) * width_of(t);
}

typedef struct { /* a circulant operator times fields on boxes of shape[0] x shape[1] nodes */
    Transform *transform;
    long components, boxes, shape[2];
    const void *symbol[MOST][MOST]; /* of the transform's precision; null where a block is zero */
    long is_complex[MOST][MOST];
    long crosses[MOST][MOST]; /* blocks that make odd parts of even ones, and the other way round */
    void *product;   /* count x WAVES, complex unless even, or a block of columns; null where blocks are
                        multiplied in place */
    long picked;     /* if `on_circle` is not null, some nodes of one box: their number, */
    const int *on_circle, *in_box; /* and their numbers on the circle and in the box */
    const int *pairs; /* of slabs, whether a pair of rows here has any of them; null: of all */
} Response;

typedef struct { /* rows here, of which processes get columns; those of this process stay where they are, or (packed.c)
                    go to what has come, of all rows */
    long parts, own, rows, place; /* processes; this one; its rows, and the first of them among all */
    long size;                    /* bytes of a number */
    const long *first;            /* of each process its first column, and how many there are */
    char *here, *packed, *came;   /* rows; blocks for others; rows of others, as far as they have come */
    long fields[3];               /* bytes from a field to the next one in each of these */
    long sides, wide;             /* parts of a field, even and odd, that stand in a row one after the other, each of
                                     which counts as a field where it is sent, or has come; numbers of a row here */
} Shares;

typedef struct { /* of `count` half spectra some columns, rows x columns waves each (slabs.c) */
    long count, rows, columns, single;
    void *spectrum, *block; /* block: a few columns of each field and of a symbol, column after column */
    void *there, *back;     /* plans of the fields' block */
} Columns;

typedef struct { /* DisplacementForm, or EvenForm: an unknown is scale times that of the half form */
    long components, nodes, forced_count, forced[MOST], evaluations, products, known;
    long single; /* whether products and their preconditioner are in single precision */
    double root, size;
    double total[MOST], answered; /* tractions of the last residual over the cell; the count of transforms then:
                                     as long as it stands, the response is in the transform */
    const double *scale, *unscale, *weight; /* null where all are one */
    const double *initial_gap;
    double *tangent;
    double *ahead, *last; /* tangent at the last residual's unknown, which is `last`, if `known` */
    const double *rigid, *far, *row_scale, *target, *drag; /* by component */
    Law *law;
    Response *response, *quick; /* quick: in single precision, on the same memory; or null */
    long held;                  /* how many of its scalars are here: of processes the last one has all */
    int (*add_up)(double *numbers, long count); /* sums of all processes, in place; null: one has all nodes */
} Form;

typedef struct { /* of the force form; spectra have `wide` doubles a wave: of even fields they are real */
    long components, nodes, waves, wide;
    double *displacement, *velocity, *force, *acceleration; /* spectra */
    double *gap, *work; /* work: of a component's spectrum, null where the body couples none */
    const double *initial_gap, *node_weight, *weight; /* of nodes, null where all are one; of waves */
    const double *mass, *mobility;
    const double *stiffness[MOST][MOST], *compliance[MOST][MOST]; /* null where a block is zero */
    long is_complex[MOST][MOST];
    double mean_stiffness[MOST], target[MOST], mobile[MOST]; /* by component */
    double size, range, harmless, reference, lightest, stiffening;
    double closest, within; /* normal gap of a node; nodes within the law's range */
    Law *law;
    Transform *transform;
} Motion;

typedef struct { /* ArcLength around a form */
    double *start, *direction, *load, *target, *far, *row_scale; /* by component; of the form */
    const double *factor, *tangent;
    const float *anchor;
    double length, rate, *load_column; /* its number for all nodes of a component, and those of force rows */
} Arc;

typedef struct { /* a circle that a core fits on: the component's compliance there, work for 1 + C D */
    long raw[2], apart;           /* apart: spacings from one of its points to the next */
    Transform *transform, *quick; /* quick: in single precision, on the same memory; or null */
    const double *compliance;
    void *symbol;  /* of the precision that its block says */
    double no_lag; /* kernel of the circle at lag 0 */
} Circle;

typedef struct { /* core block of a component */
    long on, first[2], extent[2], made; /* made: precision of its circle's symbol, or NONE */
    long apart, before[2]; /* nodes of a patch in each direction, and of the first one before the core; 0: none */
    double within;         /* G for what patches do not tell apart */
    const Circle *circle;
    double *into, *back, *mean, *column, *inverse;
    long picked; /* of a response with picked nodes: those of the core, and their patches on its circle */
    int *node, *at;
} Block;

typedef struct { /* a blur of masks over boxes: three running means of 2 reach + 1 nodes along each axis */
    long shape[2], reach[2], wraps[2];
    double *sums; /* room for 2 x 8 lines of doubles, the longest of the box */
} Blur;

/* one component on two grids, of nodes and of patches of nodes; numbers of either in the transform's precision,
   doubles aside */
typedef struct {
    Transform *transform;
    long nodes, points;
    const int *patch;
    const void *inverse;                                        /* of nodes */
    const void *stiffness, *core, *there, *compliance, *symbol; /* of patches, and of waves */
    const double *mean, *within, *number;
    double area, left, compliant; /* c of waves within patches */
    double *sums;                 /* room for two numbers a patch */
    void *rows, *made;
    double *matrix; /* of its last solve, column by column */
    long count;
    int (*add_up)(double *numbers, long count); /* numbers of all processes; null: one has all nodes */
} TwoGrids;

typedef struct Zone Zone;
struct Zone { /* CoreZone, of a form or of a form under arc length */
    Form *form;
    Arc *arc;
    double threshold, pad, floor;
    long reach[2], wraps[2], applications, set_ups;
    const Circle *circles[MOST];
    long circle_count[MOST];
    int (*missing)(long component, long first, long second, long apart); /* Python's: makes a circle */
    int (*elsewhere)(const float *vector, float *out); /* Python's: applies a zone in place of this; or null */
    long sizes[PATCHES];             /* nodes of patches in each direction, the largest first, the last one 1: */
    double left[PATCHES];            /* C D up to which they are taken */
    long patched, start[2];          /* whether cores are in patches; first node of the box in the cell */
    double shortest[MOST][PATCHES];  /* compliance of the shortest waves that patches tell apart; 0: there are none */
    const double *between[MOST]; /* of several boxes: kernel at their offsets, (boxes, boxes) */
    double kernel_at_zero[MOST];
    Block block[MOST];
    TwoGrids *grids[MOST]; /* in place of blocks; null: of none */
    long mean_count, means[MOST];
    double *columns, *mask, *blur, *sums, *column, slope, inverse[MOST * MOST];
};

typedef struct { /* J of overdamped motion, from a form whose rows are of components whose mean can move */
    Form *form;
    Zone *zone;
    double row[MOST], push[MOST]; /* what its rows are over the means' rates; displacements over these */
} Overdamped;

typedef struct {
    Form *form;
    Arc *arc;
    Zone *zone;
    void *ksp;
    long chooses, patience, turned; /* chooses: whether its solves may be in single precision */
    double safe;                    /* relative tolerance asked of a solve down to which they are */
    double newton_stiffness;
    double smallest[2]; /* Ritz values of the last two linear solves that told */
    long told;
    const char *operator_text, *zone_text;
} System;

typedef struct { /* nodes of a contact: law (null: Python's own), rest gaps, for how many each stands (null:
                    itself); gap of contact, slip of the law's peak, Maugis parameters, energies of components over
                    that of the normal one; of half a line (`halved`) signs of components, whether it is closed, and
                    the traction that counts as none */
    const Law *law;
    long nodes;
    const double *initial_gap, *weight;
    double contact, peak, normal, sharp, parts[MOST];
    long halved, closed;
    int sign[MOST];
    double least;
} Site;

enum { PLACES = 16 }; /* of a rule on the way of a step, at most */

typedef struct { /* what steps are judged by, as contactsnes/contact/acceptance.py has it; a rule on their ways */
    double strays, share, longest, reach, held, open, doubtful, trifle;
    long count;
    double places[PLACES], shares[PLACES];
} Limits;

/* PETSc's integers are of four bytes or, as it may be built, of eight. Asked for as eight that were zero, those
   that are not negative are read rightly as either (Python loads the library on little-endian processors only). */
typedef long long PetscCount;

struct Libraries {
    void (*execute)(void *), (*execute_single)(void *), (*execute_rows)(void *, void *, void *);
    void (*execute_rows_single)(void *, void *, void *);
    void (*to_half)(void *, void *, void *), (*to_half_single)(void *, void *, void *);
    void (*to_row)(void *, void *, void *), (*to_row_single)(void *, void *, void *);
    int (*alignment)(void *), (*alignment_single)(void *);
    int (*get_read)(void *, const double **), (*put_read)(void *, const double **);
    int (*get)(void *, double **), (*put)(void *, double **);
    int (*mat_context)(void *, void *), (*pc_context)(void *, void *);
    int (*assembly_begin)(void *, int), (*assembly_end)(void *, int);
    int (*get_ksp)(void *, void **), (*iterations)(void *, PetscCount *);
    int (*eigenvalues)(void *, PetscCount, double *, double *, PetscCount *);
    int (*print)(void *, const char *, ...);
    int (*tolerances)(void *, double *, double *, double *, PetscCount *);
    int (*right_side)(void *, void **), (*norm)(void *, int, double *);
};

extern struct Libraries libraries;

void along_rows(const Line *l, void *x, long count, int back, int odd, long used, int single);
void turn_field(void *a, long rows, long columns, void *b, int back, int single);
int forward(Transform *t, long used);
int backward(Transform *t, long used);
void clear_beyond(const Transform *t, const long *shape);
void put_row(const Transform *t, long field, long row, long first, const double *weight, const double *x,
             long n);
void clear_field(const Transform *t, long field);
void put_nodes(const Transform *t, long field, const int *at, const double *x, long n);
void take_row(const Transform *t, long field, long row, double mean, double factor, const double *scale,
              const double *own, double *out, long n);
void take_nodes(const Transform *t, long field, const int *at, double mean, double factor,
                const double *own, double *out, long n);
void blend_row(const Transform *t, long field, long row, const double *into, const double *back,
               const double *x, double *out, long n);
void put_box(const Transform *t, long field, const long *extent, const double *weight, const double *x,
             long apart);
void blend_box(const Transform *t, long field, const long *extent, const double *into, const double *back,
               double *x, long apart);
void add_nodes(const Transform *t, const int *at, const int *node, const double *weight, const double *x, long n);
void subtract_nodes(const Transform *t, const int *at, const int *node, const double *weight, double own, double *x,
                    long n);
int filter(Transform *t, const long *shape, const void *symbol);
long place_of(const Transform *t, long row, long column);
void invert(const Transform *t, const double *compliance, double stiffness, double gain, void *symbol);
void complement(const Transform *t, double whole, double share, void *symbol);
int apply_patched(const Zone *z, const Block *b, Transform *t, const double *field, double *out);
int apply_patched_in_single(const Zone *z, const Block *b, Transform *t, const float *field, float *out);
int convolve(const Response *r, int transposed);
void times_in_double(double *x, const double *s, long n);
void times_in_single(float *x, const float *s, long n);
void add_times_in_double(double *x, const double *s, const double *y, long n, int is_complex, double sign);
void add_times_in_single(float *x, const float *s, const float *y, long n, int is_complex, float sign);
long packed_place(const Transform *t, long row, long column);
void packed_clear_beyond(const Transform *t, const long *shape);
void packed_put_row(const Transform *t, long field, long row, long first, const double *weight,
                    const double *x, long n);
void packed_take_row(const Transform *t, long field, long row, double mean, double factor,
                     const double *scale, const double *own, double *out, long n);
void packed_blend_row(const Transform *t, long field, long row, const double *into, const double *back,
                      const double *x, double *out, long n);
void packed_multiply(const Transform *t, const Response *response, const void *symbol, long used,
                     int transposed);
void folded_multiply(const Transform *t, const Response *response, const void *symbol, const long *used,
                     int transposed);
void folded_rows(const Transform *t, const Shares *s, long used, long columns, int back);
void folded_columns(const Transform *t, const Shares *s, const Response *response, const void *symbol,
                    long used, int transposed);
void share_rows(const Shares *s, long field, long row, long count, void *x, int back);
void *row_that_came(const Shares *s, long field, long row);
void folded_invert(const Transform *t, const double *compliance, double stiffness, double gain,
                   void *symbol);
void shared_rows(const Transform *t, const Shares *s, const Response *response, int back);
void shared_columns(const Transform *t, const Shares *s, const Response *response, const void *symbol,
                    int transposed);
void packed_invert(const Transform *t, const double *compliance, double stiffness, double gain,
                   float *symbol);
void evaluate(const Law *law, long components, long nodes, const double *gap, double *traction,
              double *tangent);
void add_times(double *x, const double *s, const double *y, long n, int is_complex, double sign);
void along_columns(const Columns *c, int there, int back, const Response *r, int transposed);
int choose(System *s, int begins);
double largest_of(double known, const double *x, long n);
const double *rule_of(long count, const double *rules);
void lagrange(long count, const double *place, double at, double *value, double *slope);
void widen(const float *x, double *out, long n);
void narrow(const double *x, float *out, long n);
int product_in_single(Form *f, const float *vector, float *out);
int precondition_in_single(Zone *z, const float *vector, float *out);
int add_up(const Form *f, double *numbers, long count);
void assemble(const Form *f, const Response *r, const double *mean, double factor, const double *own,
              double *out);
int begin_residual(Form *f, const double *unknown, const double *tail, double *numbers);
int residual(Form *f, const double *unknown, double *out);
void linearise(Form *f, const double *unknown);
int product(Form *f, const double *vector, double *out);
int transposed_product(Form *f, const double *vector, double *out);
int arc_residual(Form *f, const Arc *arc, const double *unknown, double *out);
void load_column(const Form *f, const Arc *arc, double *out);
void arc_linearise(Form *f, const Arc *arc, const double *unknown);
int arc_product(Form *f, const Arc *arc, const double *vector, double *out);
int arc_transposed(Form *f, const Arc *arc, const double *vector, double *out);
void smooth_mask(const Blur *b, const unsigned char *mask, int mirrors, long first_row, long count,
                 float *sums, double *out);
void add_on_two_grids(const TwoGrids *g, const float *field, long at, long n, double *out);
int on_two_grids(TwoGrids *g, const double *field, double *out);
int on_two_grids_of_floats(TwoGrids *g, const float *field, float *out);
int set_up(Zone *z);
int precondition(Zone *z, const double *vector, double *out);
void gaps_of_regularised(const Law *law, long nodes, const double *target, double stiffness, double *out);
void regularised_step(const Form *f, double stiffness, const double *unknown, double *step,
                      int *changed);
void works(const Law *law, long components, long nodes, const double *gap, const double *change,
           const double *parts, long count, const double *places, const double *shares, double trifle,
           double *found);
void pseudo_inverse(double *matrix, long n, double floor, double *work);
#endif
