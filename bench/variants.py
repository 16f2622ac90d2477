"""M and h as C, made in several ways: by Tisserand, by hand, by CasADi and by SymPy.

CasADi and SymPy get the same equations in two forms. Written out: definitions and shape integrals expanded into
coordinates, rates and parameters, as one has them after deriving with SymPy. Prepared: shape integrals computed
beforehand as inputs k and the definitions (d1, D2, J, ...) kept, so that only the printing differs from ours.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import sympy as sp
from harness import Variant
from problem import PARAMETERS, Problem
from sympy.utilities.codegen import C99CodeGen, codegen

HAND = Path(__file__).with_name("handwritten.c")
STATE = "double t, const double *q, const double *v, const double *k, double *M, double *h"
EMPTY = Variant(
    name="an empty function",
    files={"empty.c": f"int empty({STATE}) {{ return 0; }}\n"},
    function="empty",
    declare=f"int empty({STATE});",
    once="",
    call="empty(0.0, q, v, 0, M, h)",
)


def ours(problem: Problem) -> Variant:
    """The generated NAME_mass_force."""
    name = problem.model.name
    files = {file.path.rsplit("/", 1)[1]: file.text for file in problem.files if file.path.endswith((".c", ".h"))}
    return Variant(
        name="Tisserand",
        files=files,
        function=f"{name}_mass_force",
        declare=f'#include "{name}.h"\nstatic double k[{len(problem.model.constants)}];',
        once=f"{name}_setup(p, k);",
        call=f"{name}_mass_force(0.0, q, v, k, M, h)",
    )


def hand(name: str, function: str, frame: str, once: str = "") -> Variant:
    """A function of the yardstick, for two shapes."""
    return Variant(
        name=name,
        files={"handwritten.c": HAND.read_text()},
        function=function,
        declare=f"void {function}(const double *, const double *, const double *, double *, double *);\n"
        f"void hand_{frame}_setup(const double *, double *);\nstatic double k[9];\n{once}",
        once=f"hand_{frame}_setup(p, k);",
        call=f"{function}(q, v, k, M, h)",
    )


def by_hand(frame: str) -> list[Variant]:
    """The yardstick with care, tuned, and (mean frame) with the constant entries of M and h left out."""
    found = [hand("by hand", f"hand_{frame}", frame), hand("by hand, tuned to gcc 12", f"hand_{frame}_tuned", frame)]
    if frame == "mean":
        whole = "void hand_mean(const double *, const double *, const double *, double *, double *);"
        kept = hand("by hand, constant entries written once", "hand_mean_once", frame, whole)
        once = f"{kept.once}\n    hand_mean(states[0], states[0] + NV, k, M, h);"
        found.append(replace(kept, once=once))
    return found


def entries(problem: Problem) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """The stored values of M and all of h, in the symbols of the derivation."""
    eq = problem.equations
    return [eq.mass[i, j] for i, j in problem.model.pattern("mass", "M").entries], list(eq.force)


def state_symbols(problem: Problem) -> tuple[list[sp.Symbol], list[sp.Symbol]]:
    """q and v."""
    return [c.q for c in problem.equations.coordinates], [row.v for row in problem.equations.rows]


def constants(problem: Problem) -> dict[sp.Symbol, float]:
    """The shape integrals that do not vanish, as numbers."""
    values = {p.symbol: sp.Float(PARAMETERS[str(p.symbol)], 17) for p in problem.equations.parameters}
    return {c.symbol: float(c.value.subs(values)) for c in problem.equations.coefficients if c.value != 0}


def zeros(problem: Problem) -> dict[sp.Symbol, int]:
    """The shape integrals that vanish."""
    return {c.symbol: 0 for c in problem.equations.coefficients if c.value == 0}


def array(name: str, numbers: Any) -> str:
    """A constant array in the main program."""
    return f"static const double {name}[] = {{{', '.join(map(repr, numbers))}}};"


def casadi_c(inputs: list[ca.SX], mass: list[ca.SX], force: list[ca.SX]) -> str:
    """What CasADi prints for a function of the inputs."""
    function = ca.Function("casadi_mass_force", inputs, [ca.vertcat(*mass), ca.vertcat(*force)], {"cse": True})
    generator = ca.CodeGenerator("casadi.c", {"with_header": False})
    generator.add(function)
    return generator.dump()


def casadi_call(name: str, text: str, numbers: Any) -> Variant:
    """CasADi's C with its own calling convention, the tables of pointers made once but for q and v."""
    return Variant(
        name=name,
        files={"casadi.c": text},
        function="casadi_mass_force",
        declare="int casadi_mass_force(const double **, double **, long long *, double *, int);\n"
        + array("k", numbers),
        once="const double *given[3] = {0, 0, k};\n    double *result[2] = {M, h};",
        call="given[0] = q, given[1] = v, casadi_mass_force(given, result, 0, 0, 0)",
    )


def casadi_written_out(problem: Problem) -> Variant:
    """CasADi from expanded expressions, parameters at run time."""
    q, v = state_symbols(problem)
    p = [parameter.symbol for parameter in problem.equations.parameters]
    symbols = [ca.SX.sym(name, len(s)) for name, s in (("q", q), ("v", v), ("p", p))]
    mass, force = ([problem.equations.substituted(e) for e in group] for group in entries(problem))
    both = to_casadi([*q, *v, *p], mass + force)(*(x for column in symbols for x in ca.vertsplit(column)))
    text = casadi_c(symbols, both[: len(mass)], both[len(mass) :])
    return casadi_call("CasADi, written out", text, problem.inputs.p)


def casadi_prepared(problem: Problem) -> Variant:
    """CasADi with shape integrals computed beforehand and definitions kept."""
    q, v = state_symbols(problem)
    known = constants(problem)
    symbols = [ca.SX.sym(name, len(s)) for name, s in (("q", q), ("v", v), ("k", known))]
    columns = [x for column in symbols for x in ca.vertsplit(column)]
    values: dict[sp.Symbol, Any] = dict(zip([*q, *v, *known], columns, strict=True)) | zeros(problem)
    for definition in problem.equations.definitions:
        values[definition.symbol] = to_casadi(list(values), [definition.expr])(*values.values())[0]
    mass, force = (to_casadi(list(values), group)(*values.values()) for group in entries(problem))
    return casadi_call("CasADi, prepared", casadi_c(symbols, mass, force), known.values())


def to_casadi(symbols: list[sp.Symbol], exprs: list[sp.Expr]) -> Any:
    """SymPy expressions as a function of CasADi scalars."""
    return sp.lambdify(symbols, exprs, modules=[{"sin": ca.sin, "cos": ca.cos}])


def sympy_call(name: str, problem: Problem, inputs: list[sp.Symbol], groups: Any, numbers: Any, cse: bool) -> Variant:
    """SymPy's codegen with arrays as arguments."""
    nv, nk = problem.inputs.nv, len(inputs)
    q, v, k = (sp.MatrixSymbol(n, size, 1) for n, size in (("q", nv), ("v", nv), ("k", nk)))
    renamed = {s: a[i, 0] for a, s_of_a in zip((q, v, k), (*state_symbols(problem), inputs), strict=True)
               for i, s in enumerate(s_of_a)}  # fmt: skip
    outputs = [sp.MatrixSymbol(n, len(group), 1) for n, group in zip("Mh", groups, strict=True)]
    rows = [sp.Eq(o, sp.Matrix([e.subs(renamed) for e in group])) for o, group in zip(outputs, groups, strict=True)]
    (_, text), _ = codegen(
        ("sympy_mass_force", rows), code_gen=C99CodeGen(cse=cse), prefix="sympy", header=False, empty=False,
        argument_sequence=(q, v, k, *outputs),
    )  # fmt: skip
    signature = "void sympy_mass_force(double *q, double *v, double *k, double *M, double *h);\n"
    return Variant(
        name=name,
        files={"sympy.c": text, "sympy.h": signature},
        function="sympy_mass_force",
        declare='#include "sympy.h"\n' + array("k", numbers),
        once="",
        call="sympy_mass_force((double *) q, (double *) v, (double *) k, M, h)",
    )


def sympy_written_out(problem: Problem, cse: bool) -> Variant:
    """SymPy from expanded expressions, parameters at run time."""
    groups = [[problem.equations.substituted(e) for e in group] for group in entries(problem)]
    p = [parameter.symbol for parameter in problem.equations.parameters]
    name = "SymPy, written out" + ", cse" * cse
    return sympy_call(name, problem, p, groups, problem.inputs.p, cse)


def sympy_prepared(problem: Problem) -> Variant:
    """SymPy with shape integrals computed beforehand; cse finds the definitions again."""
    known = constants(problem)
    groups = [[_substituted(problem, e) for e in group] for group in entries(problem)]
    return sympy_call("SymPy, prepared, cse", problem, list(known), groups, known.values(), cse=True)


def _substituted(problem: Problem, expr: sp.Expr) -> sp.Expr:
    for definition in reversed(problem.equations.definitions):
        expr = expr.subs(definition.symbol, definition.expr)
    return expr.subs(zeros(problem))


def all_variants(problem: Problem) -> list[Variant]:
    """Every way for this beam; by hand there are those with two shapes."""
    return [
        ours(problem),
        *(by_hand(problem.spec.frame.kind) if len(problem.equations.coordinates) == 5 else []),
        casadi_prepared(problem),
        casadi_written_out(problem),
        sympy_prepared(problem),
        sympy_written_out(problem, cse=True),
        sympy_written_out(problem, cse=False),
    ]
