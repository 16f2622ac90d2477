"""The structural zeros of the mass matrix and the vanishing terms of bodies in loops: of one body of each kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from derive.ir.model import Zero
from derive.lowering.instances.loop_code.class_code import ClassCode
from derive.lowering.model_tables import symbol_variable


def zeros_of_kinds(classes: Sequence[ClassCode]) -> tuple[Zero, ...]:
    """The entries of M that vanish in the block of a body, with their reasons, for the first body of each kind."""
    return _of_kinds(classes, _zeros)


def vanished_of_kinds(classes: Sequence[ClassCode]) -> tuple[Zero, ...]:
    """The terms of (15) that vanish in the equations of a body, with their reasons, for the first body of each kind."""
    return _of_kinds(classes, _vanished)


def _of_kinds(classes: Sequence[ClassCode], listed: Callable[[ClassCode], tuple[Zero, ...]]) -> tuple[Zero, ...]:
    """The zeros of the first body of those with the same kind and coordinates, and a line on the others."""
    kinds: dict[object, list[ClassCode]] = {}
    for code in classes:
        instance = code.of.first.instance
        kinds.setdefault((instance.kind, tuple(code.context.equations.mass_zeros)), []).append(code)
    result: list[Zero] = []
    for of in kinds.values():
        first, others = of[0].of.first.instance.name, sum(len(code.of.members) for code in of) - 1
        zeros = listed(of[0])
        result += zeros
        if zeros and others:
            what = "those of another body" if others == 1 else f"those of {others} other bodies"
            result.append(Zero(what, f"as those of {first}"))
    return tuple(result)


def _zeros(code: ClassCode) -> tuple[Zero, ...]:
    equations, names = code.context.equations, _names(code)
    rows = [names[row.name] for row in equations.rows]
    return tuple(Zero(f"M[{rows[i]}, {rows[j]}]", str(why)) for i, j, why in equations.mass_zeros)


def _vanished(code: ClassCode) -> tuple[Zero, ...]:
    names = _names(code)
    return tuple(
        Zero(f"{v.term.name} term of row {names[v.term.row]}", str(v.reason)) for v in code.context.equations.vanished
    )


def _names(code: ClassCode) -> Mapping[str, str]:
    """The names for people of the rows of a body, by their names in code."""
    equations = code.context.equations
    shown = {str(c.q): symbol_variable(c.q, "", "").shown for c in equations.coordinates}
    return {row.name: shown.get(row.name) or row.name for row in equations.rows}
