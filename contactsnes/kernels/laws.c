/* Traction laws of contactsnes, written by `python -m contactsnes.kernels.law_text` from their
   formulas: change those.

   void NAME(n, p, a, b, N, S, Na, Nb, Ta, Tb) at n nodes with the normal gap a and the slip b >= 0,
   both in ranges of the law; p are the law's parameters in the order of its table. It fills
     N   normal traction, phi_n / delta_n; attraction is positive
     S   friction over the slip, T / b, phi_t / delta_t
     Na  dN/da
     Nb  (dN/db) / b
     Ta  dS/da
     Tb  (dS/db) / b
   all of them finite at b = 0: with slips s_i, b^2 = sum of s_i^2, the tractions are N and S s_i,
   and the tangent is dN/da = Na, dN/ds_j = Nb s_j, dt_i/da = Ta s_i and
   dt_i/ds_j = (i == j) S + Tb s_i s_j. Where dS/db is not 0 at b = 0 the last is only limited, and
   its product with s_i s_j is 0.
   void NAME_tractions(n, p, a, b, N, S) fills the first two alone.
   void NAME_normal(n, p, a, N, Na) is the same at b = 0 alone.
   Below the law's deepest gap both continue linearly in a. No array may overlap another one. */
#include <math.h>
/* one version of each function for each width of a processor's vectors */
#if defined __GNUC__ && !defined __clang__ && defined __linux__ && defined __x86_64__
#define CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CLONES
#endif
#if defined __GNUC__ && !defined __clang__ && defined __GLIBC__ && defined __x86_64__ \
    && !defined SCALAR_LAWS
/* those of libmvec, within 4 units of the last place */
#define VECTOR __attribute__((simd("notinbranch")))
extern double exp(double) VECTOR;
#if __GLIBC_PREREQ(2, 35)
extern double tanh(double) VECTOR;
#endif
#undef VECTOR
#endif
/* exp(x), or 0 where it is below 1e-304: what underflows is computed number by number, not in
   vectors. The bound is no constant and 0 is chosen by the result: a compiler that knew which x
   give 0 would leave the bound out. */
double least_exponent = -700.0;
static inline double exp_or_0(double x)
{
    const double y = exp(x < least_exponent ? least_exponent : x);
    return y < 1e-304 ? 0.0 : y;
}

CLONES void law_dugdale(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S, double *restrict Na,
    double *restrict Nb, double *restrict Ta, double *restrict Tb)
{
    (void)p;
    const double c0 = p[3] / p[2];
    const double c1 = -c0;
    const double c2 = exp_or_0(c1);
    const double c3 = 1.0 + c2;
    const double c4 = 1.0 - p[1];
    const double c5 = 1.0 - p[0];
    const double c6 = p[2] * (-30.0);
    const double c7 = 1.0 / p[2];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = c4 * v1;
        const double v3 = p[1] + v2;
        const double v4 = s > 0.7071067811865476 ? s : 0.7071067811865476;
        const double v5 = v4 - 0.7071067811865476;
        const double v6 = v5 * v5;
        const double v7 = -v6;
        const double v8 = exp_or_0(v7);
        const double v9 = c5 * v8;
        const int v10 = s > 0.7071067811865476;
        const double v11 = p[0] + v9;
        const double v12 = v11 * 0.8577638849607068;
        const double v13 = v12 / v4;
        const double v14 = v1 * 2.0;
        const double v15 = v10 ? v13 : v14;
        const double v16 = s > 1e-150 ? s : 1e-150;
        const double v17 = 0.5 / v16;
        const double v18 = 1.0 / v4;
        const double v19 = v13 / v4;
        const double v20 = v1 * (-2.0);
        const double v21 = v5 * v17;
        const double v22 = v8 * v21;
        const double v23 = c5 * v22;
        const double v24 = v18 * v23;
        const double v25 = (-1.7155277699214135) * v24;
        const double v26 = v17 * v19;
        const double v27 = v25 - v26;
        const double v28 = v10 ? v27 : v20;
        const double v29 = x > c6 ? x : c6;
        const double v30 = x - v29;
        const double v31 = v29 - p[3];
        const double v32 = 0.5 * v31;
        const double v33 = v32 / p[2];
        const double v34 = tanh(v33);
        const double v35 = 0.5 * v34;
        const double v36 = 0.5 - v35;
        const double v37 = v29 / p[2];
        const double v38 = -v37;
        const double v39 = exp_or_0(v38);
        const double v40 = 1.0 - v39;
        const double v41 = v36 * v40;
        const double v42 = c3 * v36;
        const int v43 = v29 <= 0.0;
        const double v44 = v43 ? 1.0 : v3;
        const double v45 = v43 ? 1.0 : v42;
        const double v46 = v41 * v44;
        const double v47 = v15 * v45;
        const double v48 = v34 * v34;
        const double v49 = 1.0 - v48;
        const double v50 = c7 * v49;
        const double v51 = c7 * v39;
        const double v52 = v40 * v50;
        const double v53 = (-0.25) * v52;
        const double v54 = v36 * v51;
        const double v55 = v53 + v54;
        const double v56 = c3 * v50;
        const double v57 = (-0.25) * v56;
        const double v58 = v43 ? 0.0 : v57;
        const double v59 = v44 * v55;
        const double v60 = v15 * v58;
        const double v61 = v43 ? 0.0 : v2;
        const double v62 = v41 * v61;
        const double v63 = v28 * v45;
        const double v64 = (-2.0) * v62;
        const double v65 = 2.0 * v63;
        const double v66 = v55 * v61;
        const double v67 = v28 * v58;
        const double v68 = v30 * v59;
        const double v69 = v46 + v68;
        const double v70 = v30 * v60;
        const double v71 = v47 + v70;
        const double v72 = v30 * v66;
        const double v73 = (-2.0) * v72;
        const double v74 = v64 + v73;
        const double v75 = v30 * v67;
        const double v76 = 2.0 * v75;
        const double v77 = v65 + v76;
        N[k] = v69;
        S[k] = v71;
        Na[k] = v59;
        Nb[k] = v74;
        Ta[k] = v60;
        Tb[k] = v77;
    }
}

CLONES void law_dugdale_tractions(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S)
{
    (void)p;
    const double c0 = p[3] / p[2];
    const double c1 = -c0;
    const double c2 = exp_or_0(c1);
    const double c3 = 1.0 + c2;
    const double c4 = 1.0 - p[1];
    const double c5 = 1.0 - p[0];
    const double c6 = p[2] * (-30.0);
    const double c7 = 1.0 / p[2];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = c4 * v1;
        const double v3 = p[1] + v2;
        const double v4 = s > 0.7071067811865476 ? s : 0.7071067811865476;
        const double v5 = v4 - 0.7071067811865476;
        const double v6 = v5 * v5;
        const double v7 = -v6;
        const double v8 = exp_or_0(v7);
        const double v9 = c5 * v8;
        const int v10 = s > 0.7071067811865476;
        const double v11 = p[0] + v9;
        const double v12 = v11 * 0.8577638849607068;
        const double v13 = v12 / v4;
        const double v14 = v1 * 2.0;
        const double v15 = v10 ? v13 : v14;
        const double v16 = x > c6 ? x : c6;
        const double v17 = x - v16;
        const double v18 = v16 - p[3];
        const double v19 = 0.5 * v18;
        const double v20 = v19 / p[2];
        const double v21 = tanh(v20);
        const double v22 = 0.5 * v21;
        const double v23 = 0.5 - v22;
        const double v24 = v16 / p[2];
        const double v25 = -v24;
        const double v26 = exp_or_0(v25);
        const double v27 = 1.0 - v26;
        const double v28 = v23 * v27;
        const double v29 = c3 * v23;
        const int v30 = v16 <= 0.0;
        const double v31 = v30 ? 1.0 : v3;
        const double v32 = v30 ? 1.0 : v29;
        const double v33 = v28 * v31;
        const double v34 = v15 * v32;
        const double v35 = v21 * v21;
        const double v36 = 1.0 - v35;
        const double v37 = c7 * v36;
        const double v38 = c7 * v26;
        const double v39 = v27 * v37;
        const double v40 = (-0.25) * v39;
        const double v41 = v23 * v38;
        const double v42 = v40 + v41;
        const double v43 = c3 * v37;
        const double v44 = (-0.25) * v43;
        const double v45 = v30 ? 0.0 : v44;
        const double v46 = v31 * v42;
        const double v47 = v15 * v45;
        const double v48 = v17 * v46;
        const double v49 = v33 + v48;
        const double v50 = v17 * v47;
        const double v51 = v34 + v50;
        N[k] = v49;
        S[k] = v51;
    }
}

CLONES void law_dugdale_normal(long n,
    const double *restrict p, const double *restrict a, double *restrict N,
    double *restrict Na)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = p[2] * (-30.0);
    const double c2 = 1.0 / p[2];
    const double c3 = p[1] + c0;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double v0 = x > c1 ? x : c1;
        const double v1 = x - v0;
        const double v2 = v0 - p[3];
        const double v3 = 0.5 * v2;
        const double v4 = v3 / p[2];
        const double v5 = tanh(v4);
        const double v6 = 0.5 * v5;
        const double v7 = 0.5 - v6;
        const double v8 = v0 / p[2];
        const double v9 = -v8;
        const double v10 = exp_or_0(v9);
        const double v11 = 1.0 - v10;
        const double v12 = v7 * v11;
        const int v13 = v0 <= 0.0;
        const double v14 = v5 * v5;
        const double v15 = 1.0 - v14;
        const double v16 = c2 * v15;
        const double v17 = c2 * v10;
        const double v18 = v11 * v16;
        const double v19 = (-0.25) * v18;
        const double v20 = v7 * v17;
        const double v21 = v19 + v20;
        const double v22 = v13 ? 1.0 : c3;
        const double v23 = v12 * v22;
        const double v24 = v21 * v22;
        const double v25 = v1 * v24;
        const double v26 = v23 + v25;
        N[k] = v26;
        Na[k] = v24;
    }
}

CLONES void law_mcgarry(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S, double *restrict Na,
    double *restrict Nb, double *restrict Ta, double *restrict Tb)
{
    (void)p;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = x > (-30.0) ? x : (-30.0);
        const double v3 = x - v2;
        const double v4 = -v2;
        const double v5 = exp_or_0(v4);
        const double v6 = v2 * v5;
        const double v7 = v1 * v6;
        const double v8 = v1 * v5;
        const double v9 = 2.0 * v8;
        const double v10 = v5 - v6;
        const double v11 = v1 * v10;
        const double v12 = (-2.0) * v8;
        const double v13 = (-2.0) * v7;
        const double v14 = (-4.0) * v8;
        const double v15 = v3 * v11;
        const double v16 = v7 + v15;
        const double v17 = v3 * v8;
        const double v18 = (-2.0) * v17;
        const double v19 = v9 + v18;
        const double v20 = (-2.0) * v15;
        const double v21 = v13 + v20;
        const double v22 = 4.0 * v17;
        const double v23 = v14 + v22;
        N[k] = v16;
        S[k] = v19;
        Na[k] = v11;
        Nb[k] = v21;
        Ta[k] = v12;
        Tb[k] = v23;
    }
}

CLONES void law_mcgarry_tractions(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S)
{
    (void)p;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = x > (-30.0) ? x : (-30.0);
        const double v3 = x - v2;
        const double v4 = -v2;
        const double v5 = exp_or_0(v4);
        const double v6 = v2 * v5;
        const double v7 = v1 * v6;
        const double v8 = v1 * v5;
        const double v9 = 2.0 * v8;
        const double v10 = v5 - v6;
        const double v11 = v1 * v10;
        const double v12 = v3 * v11;
        const double v13 = v7 + v12;
        const double v14 = v3 * v8;
        const double v15 = (-2.0) * v14;
        const double v16 = v9 + v15;
        N[k] = v13;
        S[k] = v16;
    }
}

CLONES void law_mcgarry_normal(long n,
    const double *restrict p, const double *restrict a, double *restrict N,
    double *restrict Na)
{
    (void)p;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double v0 = x > (-30.0) ? x : (-30.0);
        const double v1 = x - v0;
        const double v2 = -v0;
        const double v3 = exp_or_0(v2);
        const double v4 = v0 * v3;
        const double v5 = v3 - v4;
        const double v6 = v1 * v5;
        const double v7 = v4 + v6;
        N[k] = v7;
        Na[k] = v5;
    }
}

CLONES void law_modified(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S, double *restrict Na,
    double *restrict Nb, double *restrict Ta, double *restrict Tb)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = 1.0 - p[0];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = c0 * v1;
        const double v3 = p[1] + v2;
        const double v4 = s > 0.7071067811865476 ? s : 0.7071067811865476;
        const double v5 = v4 - 0.7071067811865476;
        const double v6 = v5 * v5;
        const double v7 = -v6;
        const double v8 = exp_or_0(v7);
        const double v9 = c1 * v8;
        const int v10 = s > 0.7071067811865476;
        const double v11 = p[0] + v9;
        const double v12 = v11 * 0.8577638849607068;
        const double v13 = v12 / v4;
        const double v14 = v1 * 2.0;
        const double v15 = v10 ? v13 : v14;
        const double v16 = s > 1e-150 ? s : 1e-150;
        const double v17 = 0.5 / v16;
        const double v18 = 1.0 / v4;
        const double v19 = v13 / v4;
        const double v20 = v1 * (-2.0);
        const double v21 = v5 * v17;
        const double v22 = v8 * v21;
        const double v23 = c1 * v22;
        const double v24 = v18 * v23;
        const double v25 = (-1.7155277699214135) * v24;
        const double v26 = v17 * v19;
        const double v27 = v25 - v26;
        const double v28 = v10 ? v27 : v20;
        const double v29 = x > (-30.0) ? x : (-30.0);
        const double v30 = x - v29;
        const double v31 = -v29;
        const double v32 = exp_or_0(v31);
        const double v33 = v29 * v32;
        const int v34 = v29 <= 0.0;
        const double v35 = v34 ? 1.0 : v3;
        const double v36 = v34 ? 1.0 : v32;
        const double v37 = v33 * v35;
        const double v38 = v15 * v36;
        const double v39 = v32 - v33;
        const double v40 = v34 ? 0.0 : v32;
        const double v41 = v35 * v39;
        const double v42 = v15 * v40;
        const double v43 = -v42;
        const double v44 = v34 ? 0.0 : v2;
        const double v45 = v33 * v44;
        const double v46 = v28 * v36;
        const double v47 = (-2.0) * v45;
        const double v48 = 2.0 * v46;
        const double v49 = v39 * v44;
        const double v50 = v28 * v40;
        const double v51 = v30 * v41;
        const double v52 = v37 + v51;
        const double v53 = v30 * v42;
        const double v54 = v38 - v53;
        const double v55 = v30 * v49;
        const double v56 = (-2.0) * v55;
        const double v57 = v47 + v56;
        const double v58 = v30 * v50;
        const double v59 = (-2.0) * v58;
        const double v60 = v48 + v59;
        N[k] = v52;
        S[k] = v54;
        Na[k] = v41;
        Nb[k] = v57;
        Ta[k] = v43;
        Tb[k] = v60;
    }
}

CLONES void law_modified_tractions(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = 1.0 - p[0];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = c0 * v1;
        const double v3 = p[1] + v2;
        const double v4 = s > 0.7071067811865476 ? s : 0.7071067811865476;
        const double v5 = v4 - 0.7071067811865476;
        const double v6 = v5 * v5;
        const double v7 = -v6;
        const double v8 = exp_or_0(v7);
        const double v9 = c1 * v8;
        const int v10 = s > 0.7071067811865476;
        const double v11 = p[0] + v9;
        const double v12 = v11 * 0.8577638849607068;
        const double v13 = v12 / v4;
        const double v14 = v1 * 2.0;
        const double v15 = v10 ? v13 : v14;
        const double v16 = x > (-30.0) ? x : (-30.0);
        const double v17 = x - v16;
        const double v18 = -v16;
        const double v19 = exp_or_0(v18);
        const double v20 = v16 * v19;
        const int v21 = v16 <= 0.0;
        const double v22 = v21 ? 1.0 : v3;
        const double v23 = v21 ? 1.0 : v19;
        const double v24 = v20 * v22;
        const double v25 = v15 * v23;
        const double v26 = v19 - v20;
        const double v27 = v21 ? 0.0 : v19;
        const double v28 = v22 * v26;
        const double v29 = v15 * v27;
        const double v30 = v17 * v28;
        const double v31 = v24 + v30;
        const double v32 = v17 * v29;
        const double v33 = v25 - v32;
        N[k] = v31;
        S[k] = v33;
    }
}

CLONES void law_modified_normal(long n,
    const double *restrict p, const double *restrict a, double *restrict N,
    double *restrict Na)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = p[1] + c0;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double v0 = x > (-30.0) ? x : (-30.0);
        const double v1 = x - v0;
        const double v2 = -v0;
        const double v3 = exp_or_0(v2);
        const double v4 = v0 * v3;
        const int v5 = v0 <= 0.0;
        const double v6 = v3 - v4;
        const double v7 = v5 ? 1.0 : c1;
        const double v8 = v4 * v7;
        const double v9 = v6 * v7;
        const double v10 = v1 * v9;
        const double v11 = v8 + v10;
        N[k] = v11;
        Na[k] = v9;
    }
}

CLONES void law_pressure_friction(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S, double *restrict Na,
    double *restrict Nb, double *restrict Ta, double *restrict Tb)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = p[2] / 0.8577638849607068;
    const double c2 = 1.0 - p[0];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = c0 * v1;
        const double v3 = p[1] + v2;
        const double v4 = s > 0.7071067811865476 ? s : 0.7071067811865476;
        const double v5 = v4 - 0.7071067811865476;
        const double v6 = v5 * v5;
        const double v7 = -v6;
        const double v8 = exp_or_0(v7);
        const double v9 = c2 * v8;
        const int v10 = s > 0.7071067811865476;
        const double v11 = p[0] + v9;
        const double v12 = 0.8577638849607068 * v11;
        const double v13 = v12 / v4;
        const double v14 = v1 * 2.0;
        const double v15 = v10 ? v13 : v14;
        const double v16 = s > 1e-150 ? s : 1e-150;
        const double v17 = 0.5 / v16;
        const double v18 = 1.0 / v4;
        const double v19 = v13 / v4;
        const double v20 = v1 * (-2.0);
        const double v21 = v5 * v17;
        const double v22 = v8 * v21;
        const double v23 = c2 * v22;
        const double v24 = v18 * v23;
        const double v25 = (-1.7155277699214135) * v24;
        const double v26 = v17 * v19;
        const double v27 = v25 - v26;
        const double v28 = v10 ? v27 : v20;
        const double v29 = x > (-30.0) ? x : (-30.0);
        const double v30 = x - v29;
        const double v31 = -v29;
        const double v32 = exp_or_0(v31);
        const double v33 = v29 * v32;
        const int v34 = v29 <= 0.0;
        const double v35 = v34 ? 1.0 : v3;
        const double v36 = c1 * v33;
        const double v37 = 1.0 - v36;
        const double v38 = v34 ? v37 : v32;
        const double v39 = v33 * v35;
        const double v40 = v15 * v38;
        const double v41 = v32 - v33;
        const double v42 = c1 * v41;
        const double v43 = v34 ? v42 : v32;
        const double v44 = v35 * v41;
        const double v45 = v15 * v43;
        const double v46 = -v45;
        const double v47 = v34 ? 0.0 : v2;
        const double v48 = v33 * v47;
        const double v49 = v28 * v38;
        const double v50 = (-2.0) * v48;
        const double v51 = 2.0 * v49;
        const double v52 = v41 * v47;
        const double v53 = v28 * v43;
        const double v54 = v30 * v44;
        const double v55 = v39 + v54;
        const double v56 = v30 * v45;
        const double v57 = v40 - v56;
        const double v58 = v30 * v52;
        const double v59 = (-2.0) * v58;
        const double v60 = v50 + v59;
        const double v61 = v30 * v53;
        const double v62 = (-2.0) * v61;
        const double v63 = v51 + v62;
        N[k] = v55;
        S[k] = v57;
        Na[k] = v44;
        Nb[k] = v60;
        Ta[k] = v46;
        Tb[k] = v63;
    }
}

CLONES void law_pressure_friction_tractions(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = p[2] / 0.8577638849607068;
    const double c2 = 1.0 - p[0];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = c0 * v1;
        const double v3 = p[1] + v2;
        const double v4 = s > 0.7071067811865476 ? s : 0.7071067811865476;
        const double v5 = v4 - 0.7071067811865476;
        const double v6 = v5 * v5;
        const double v7 = -v6;
        const double v8 = exp_or_0(v7);
        const double v9 = c2 * v8;
        const int v10 = s > 0.7071067811865476;
        const double v11 = p[0] + v9;
        const double v12 = 0.8577638849607068 * v11;
        const double v13 = v12 / v4;
        const double v14 = v1 * 2.0;
        const double v15 = v10 ? v13 : v14;
        const double v16 = x > (-30.0) ? x : (-30.0);
        const double v17 = x - v16;
        const double v18 = -v16;
        const double v19 = exp_or_0(v18);
        const double v20 = v16 * v19;
        const int v21 = v16 <= 0.0;
        const double v22 = v21 ? 1.0 : v3;
        const double v23 = c1 * v20;
        const double v24 = 1.0 - v23;
        const double v25 = v21 ? v24 : v19;
        const double v26 = v20 * v22;
        const double v27 = v15 * v25;
        const double v28 = v19 - v20;
        const double v29 = c1 * v28;
        const double v30 = v21 ? v29 : v19;
        const double v31 = v22 * v28;
        const double v32 = v15 * v30;
        const double v33 = v17 * v31;
        const double v34 = v26 + v33;
        const double v35 = v17 * v32;
        const double v36 = v27 - v35;
        N[k] = v34;
        S[k] = v36;
    }
}

CLONES void law_pressure_friction_normal(long n,
    const double *restrict p, const double *restrict a, double *restrict N,
    double *restrict Na)
{
    (void)p;
    const double c0 = 1.0 - p[1];
    const double c1 = p[1] + c0;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double v0 = x > (-30.0) ? x : (-30.0);
        const double v1 = x - v0;
        const double v2 = -v0;
        const double v3 = exp_or_0(v2);
        const double v4 = v0 * v3;
        const int v5 = v0 <= 0.0;
        const double v6 = v3 - v4;
        const double v7 = v5 ? 1.0 : c1;
        const double v8 = v4 * v7;
        const double v9 = v6 * v7;
        const double v10 = v1 * v9;
        const double v11 = v8 + v10;
        N[k] = v11;
        Na[k] = v9;
    }
}

CLONES void law_xu_needleman(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S, double *restrict Na,
    double *restrict Nb, double *restrict Ta, double *restrict Tb)
{
    (void)p;
    const double c0 = 1.0 - p[0];
    const double c1 = p[1] - 1.0;
    const double c2 = c0 / c1;
    const double c3 = p[1] - p[0];
    const double c4 = c3 / c1;
    const double c5 = c4 / p[0];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = 1.0 - v1;
        const double v3 = x > (-30.0) ? x : (-30.0);
        const double v4 = x - v3;
        const double v5 = -v3;
        const double v6 = exp_or_0(v5);
        const double v7 = p[1] - v3;
        const double v8 = c2 * v7;
        const double v9 = v6 * v8;
        const double v10 = v3 * v6;
        const double v11 = v1 * v10;
        const double v12 = v2 * v9;
        const double v13 = v11 + v12;
        const double v14 = c5 * v3;
        const double v15 = 1.0 + v14;
        const double v16 = v6 * v15;
        const double v17 = v1 * v16;
        const double v18 = 2.0 * v17;
        const double v19 = -v9;
        const double v20 = c2 * v6;
        const double v21 = v19 - v20;
        const double v22 = v6 - v10;
        const double v23 = v1 * v22;
        const double v24 = v2 * v21;
        const double v25 = v23 + v24;
        const double v26 = c5 * v6;
        const double v27 = v26 - v16;
        const double v28 = v1 * v27;
        const double v29 = 2.0 * v28;
        const double v30 = v1 * v9;
        const double v31 = v30 - v11;
        const double v32 = 2.0 * v31;
        const double v33 = (-4.0) * v17;
        const double v34 = v1 * v21;
        const double v35 = v34 - v23;
        const double v36 = v4 * v25;
        const double v37 = v13 + v36;
        const double v38 = v4 * v28;
        const double v39 = 2.0 * v38;
        const double v40 = v18 + v39;
        const double v41 = v4 * v35;
        const double v42 = 2.0 * v41;
        const double v43 = v32 + v42;
        const double v44 = (-4.0) * v38;
        const double v45 = v33 + v44;
        N[k] = v37;
        S[k] = v40;
        Na[k] = v25;
        Nb[k] = v43;
        Ta[k] = v29;
        Tb[k] = v45;
    }
}

CLONES void law_xu_needleman_tractions(long n,
    const double *restrict p, const double *restrict a, const double *restrict b,
    double *restrict N, double *restrict S)
{
    (void)p;
    const double c0 = 1.0 - p[0];
    const double c1 = p[1] - 1.0;
    const double c2 = c0 / c1;
    const double c3 = p[1] - p[0];
    const double c4 = c3 / c1;
    const double c5 = c4 / p[0];
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double s = b[k], q = s * s;
        (void)s, (void)q;
        const double v0 = -q;
        const double v1 = exp_or_0(v0);
        const double v2 = 1.0 - v1;
        const double v3 = x > (-30.0) ? x : (-30.0);
        const double v4 = x - v3;
        const double v5 = -v3;
        const double v6 = exp_or_0(v5);
        const double v7 = p[1] - v3;
        const double v8 = c2 * v7;
        const double v9 = v6 * v8;
        const double v10 = v3 * v6;
        const double v11 = v1 * v10;
        const double v12 = v2 * v9;
        const double v13 = v11 + v12;
        const double v14 = c5 * v3;
        const double v15 = 1.0 + v14;
        const double v16 = v6 * v15;
        const double v17 = v1 * v16;
        const double v18 = 2.0 * v17;
        const double v19 = -v9;
        const double v20 = c2 * v6;
        const double v21 = v19 - v20;
        const double v22 = v6 - v10;
        const double v23 = v1 * v22;
        const double v24 = v2 * v21;
        const double v25 = v23 + v24;
        const double v26 = c5 * v6;
        const double v27 = v26 - v16;
        const double v28 = v1 * v27;
        const double v29 = v4 * v25;
        const double v30 = v13 + v29;
        const double v31 = v4 * v28;
        const double v32 = 2.0 * v31;
        const double v33 = v18 + v32;
        N[k] = v30;
        S[k] = v33;
    }
}

CLONES void law_xu_needleman_normal(long n,
    const double *restrict p, const double *restrict a, double *restrict N,
    double *restrict Na)
{
    (void)p;
    for (long k = 0; k < n; k++) {
        const double x = a[k];
        const double v0 = x > (-30.0) ? x : (-30.0);
        const double v1 = x - v0;
        const double v2 = -v0;
        const double v3 = exp_or_0(v2);
        const double v4 = v0 * v3;
        const double v5 = v3 - v4;
        const double v6 = v1 * v5;
        const double v7 = v4 + v6;
        N[k] = v7;
        Na[k] = v5;
    }
}

static const char *const parameters_dugdale[] = {
    "residual_friction", "residual_adhesion", "dugdale_width", "end", 0};
static const char *const parameters_mcgarry[] = {
    0};
static const char *const parameters_modified[] = {
    "residual_friction", "residual_adhesion", 0};
static const char *const parameters_pressure_friction[] = {
    "residual_friction", "residual_adhesion", "pressure_friction", 0};
static const char *const parameters_xu_needleman[] = {
    "xu_needleman_q", "xu_needleman_r", 0};

typedef void (*sheared_law)(long n, const double *p, const double *a, const double *b, double *N,
                            double *S, double *Na, double *Nb, double *Ta, double *Tb);
typedef void (*tractions_of_law)(long n, const double *p, const double *a, const double *b,
                                 double *N, double *S);
typedef void (*normal_law)(long n, const double *p, const double *a, double *N, double *Na);

/* All laws by name; names of parameters end with 0, and so does the table. */
const struct traction_law {
    const char *name;
    sheared_law sheared;
    tractions_of_law tractions;
    normal_law normal;
    const char *const *parameters;
} traction_laws[] = {
    {"dugdale", law_dugdale, law_dugdale_tractions, law_dugdale_normal,
     parameters_dugdale},
    {"mcgarry", law_mcgarry, law_mcgarry_tractions, law_mcgarry_normal,
     parameters_mcgarry},
    {"modified", law_modified, law_modified_tractions, law_modified_normal,
     parameters_modified},
    {"pressure_friction", law_pressure_friction, law_pressure_friction_tractions, law_pressure_friction_normal,
     parameters_pressure_friction},
    {"xu_needleman", law_xu_needleman, law_xu_needleman_tractions, law_xu_needleman_normal,
     parameters_xu_needleman},
    {0, 0, 0, 0, 0}};
