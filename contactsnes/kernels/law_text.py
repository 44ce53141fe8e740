"""C of formulas of laws: one loop over the nodes, without a call but those of mathematics, so that
compilers make vectors of it.

`python -m contactsnes.kernels.law_text` writes that of the package's laws, laws.c."""

import re
from pathlib import Path

from ..interface.formula import Formula
from ..interface.laws import LAWS

FILE = Path(__file__).with_name("laws.c")

HEAD = """\
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
"""

CLONES = """\
/* one version of each function for each width of a processor's vectors */
#if defined __GNUC__ && !defined __clang__ && defined __linux__ && defined __x86_64__
#define CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CLONES
#endif
"""

VECTORS = """\
#if defined __GNUC__ && !defined __clang__ && defined __GLIBC__ && defined __x86_64__ \\
    && !defined SCALAR_LAWS
/* those of libmvec, within 4 units of the last place */
#define VECTOR __attribute__((simd("notinbranch")))
{}
#undef VECTOR
#endif
"""

EXP = """\
/* exp(x), or 0 where it is below 1e-304: what underflows is computed number by number, not in
   vectors. The bound is no constant and 0 is chosen by the result: a compiler that knew which x
   give 0 would leave the bound out. */
double least_exponent = -700.0;
static inline double exp_or_0(double x)
{
    const double y = exp(x < least_exponent ? least_exponent : x);
    return y < 1e-304 ? 0.0 : y;
}
"""

OLD = ("exp", "log", "pow", "sin", "cos")
"""Functions that libmvec has had from its beginning; others came with glibc 2.35."""

TABLE = """\
typedef void (*sheared_law)(long n, const double *p, const double *a, const double *b, double *N,
                            double *S, double *Na, double *Nb, double *Ta, double *Tb);
typedef void (*tractions_of_law)(long n, const double *p, const double *a, const double *b,
                                 double *N, double *S);
typedef void (*normal_law)(long n, const double *p, const double *a, double *N, double *Na);

/* All laws by name; names of parameters end with 0, and so does the table. */
const struct traction_law {{
    const char *name;
    sheared_law sheared;
    tractions_of_law tractions;
    normal_law normal;
    const char *const *parameters;
}} traction_laws[] = {{
{}
    {{0, 0, 0, 0, 0}}}};
"""

INFIX = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "less": "<",
         "less_equal": "<=", "greater": ">", "greater_equal": ">=", "equal": "==",
         "not_equal": "!=", "logical_and": "&", "logical_or": "|"}

CALLED = {"power": "pow", "absolute": "fabs", "arctan": "atan", "exp": "exp_or_0",
          **{name: name for name in ("sqrt", "expm1", "log", "log1p", "sin", "cos", "sinh",
                                     "cosh", "tanh", "erf", "erfc")}}

OUTPUTS = {"": ("N", "S", "Na", "Nb", "Ta", "Tb"), "_tractions": ("N", "S"), "_normal": ("N", "Na")}
"""What the names of a law's functions end with -> what these fill."""


def _expression(node, names):
    """C of one operation on named values."""
    of = [names[argument.index] for argument in node.arguments]
    if node.operation in INFIX:
        return f" {INFIX[node.operation]} ".join(of)
    if node.operation in CALLED:
        return f"{CALLED[node.operation]}({', '.join(of)})"
    if node.operation == "where":
        return f"{of[0]} ? {of[1]} : {of[2]}"
    if node.operation in ("minimum", "maximum"):
        sign = "<" if node.operation == "minimum" else ">"
        return f"{of[0]} {sign} {of[1]} ? {of[0]} : {of[1]}"
    return {"negative": "-", "logical_not": "!"}[node.operation] + of[0]


def _number(node):
    """A number in C."""
    if node.boolean:
        return str(int(node.value))
    text = {"inf": "INFINITY", "-inf": "-INFINITY", "nan": "NAN"}.get(repr(node.value),
                                                                    repr(node.value))
    return f"({text})" if text.startswith("-") else text


def _lines(formula, roots):
    """(lines before the loop, lines in it, names of the roots)."""
    nodes = formula.graph.reachable(roots)
    names = {formula.gap.index: "x", formula.squared.index: "q", formula.slip.index: "s"}
    names.update({node.index: f"p[{i}]" for i, node in enumerate(formula.symbols)})
    varying = {formula.gap.index, formula.squared.index, formula.slip.index}
    before, inside = [], []
    for node in nodes:
        if node.operation == "number":
            names[node.index] = _number(node)
        if node.index in names:
            continue
        moves = any(argument.index in varying for argument in node.arguments)
        lines, letter = (inside, "v") if moves else (before, "c")
        if moves:
            varying.add(node.index)
        names[node.index] = f"{letter}{len(lines)}"
        kind = "int" if node.boolean else "double"
        lines.append(f"const {kind} {names[node.index]} = {_expression(node, names)};")
    return before, inside, [names[root.index] for root in roots]


def _function(formula, name, kind):
    """A function of C, of a kind of `OUTPUTS`."""
    outputs, sheared = OUTPUTS[kind], kind != "_normal"
    before, inside, values = _lines(formula, formula.results(sheared, True)[:len(outputs)])
    inputs = ("p", "a", "b") if sheared else ("p", "a")
    arrays = [*(f"const double *restrict {array}" for array in inputs),
              *(f"double *restrict {array}" for array in outputs)]
    start = ["const double x = a[k];"]
    start += ["const double s = b[k], q = s * s;", "(void)s, (void)q;"] if sheared else []
    body = [*start, *inside, *(f"{out}[k] = {value};" for out, value in zip(outputs, values))]
    return "\n".join([f"CLONES void {name}{kind}(long n,", f"    {_wrapped(arrays)})", "{",
                      *(f"    {line}" for line in ("(void)p;", *before)),
                      "    for (long k = 0; k < n; k++) {",
                      *(f"        {line}" for line in body), "    }", "}", ""])


def _wrapped(arguments):
    """Arguments of a function, three a line."""
    rows = [", ".join(arguments[i:i + 3]) for i in range(0, len(arguments), 3)]
    return ",\n    ".join(rows)


def functions(formula, name):
    """C of the functions of a Formula: NAME, NAME_tractions and NAME_normal."""
    return "\n".join(_function(formula, name, kind) for kind in OUTPUTS)


def head(text):
    """What comes before functions: the comment, and the vector functions that they call."""
    called = [name.removesuffix("_or_0") for name in CALLED.values()
              if re.search(rf"\b{name}\(", text)]
    told = {old: [f"extern double {name}({'double, double' if name == 'pow' else 'double'}) VECTOR;"
                  for name in called if name not in ("sqrt", "fabs") and (name in OLD) == old]
            for old in (True, False)}
    newer = ["#if __GLIBC_PREREQ(2, 35)", *told[False], "#endif"] if told[False] else []
    lines = "\n".join([*told[True], *newer])
    return (HEAD + CLONES + (VECTORS.format(lines) if lines else "")
            + (EXP if "exp" in called else ""))


def package():
    """C of the package's laws, and a table of them."""
    made = {name: Formula(cls()) for name, cls in LAWS.items()}
    text = "\n".join(functions(formula, f"law_{name}") for name, formula in made.items())
    names, rows = [], []
    for name, formula in made.items():
        listed = "".join(f'"{parameter}", ' for parameter in formula.parameters)
        names.append(f"static const char *const parameters_{name}[] = {{\n    {listed}0}};")
        of_law = ", ".join(f"law_{name}{kind}" for kind in OUTPUTS)
        rows.append(f'    {{"{name}", {of_law},\n     parameters_{name}}},')
    table = "\n".join(names) + "\n\n" + TABLE.format("\n".join(rows))
    return f"{head(text)}\n{text}\n{table}"


def main():
    """Write laws.c."""
    FILE.write_text(package(), encoding="utf-8")


if __name__ == "__main__":
    main()
