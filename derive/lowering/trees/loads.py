"""The generalised forces of a tree in loops over its loads, its springs and its dampers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Element, Operator, ScalarRef
from derive.ir.indices import constant
from derive.ir.statements import Statement, StoreElement, Work
from derive.lowering.trees.exact_numbers import exact
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.motion import TreeMotion
from derive.lowering.trees.row_loads import RowLoad, RowLoads, RowSpring
from derive.mechanics.symbols import local
from derive.mechanics.terms import Intermediate
from derive.spec.model.instances import identifier

APPLIED = "applied"
"""The local array of the generalised forces of rows."""


def definitions(loads: RowLoads, inputs: Sequence[sp.Symbol]) -> list[Intermediate]:
    """The definitions of values that are neither numbers nor inputs."""
    return [
        Intermediate(_symbol(of), of.value, of.name, "(10)", f"value of {of.name}")
        for of in loads.loads
        if not of.value.is_Rational and of.value not in inputs
    ]


def _symbol(of: RowLoad) -> sp.Symbol:
    return local(identifier("value", of.name))


def applied(motion: TreeMotion, loads: RowLoads, inputs: Sequence[sp.Symbol], rows: int) -> list[Statement]:
    """The statements that add all loads up, row by row."""
    if not loads.any:
        return []
    result: list[Statement] = [Work(APPLIED, rows, cleared=True)]
    given = [of for of in loads.loads if of.value in inputs]
    numbers = [of for of in loads.loads if of.value.is_Rational]
    others = [of for of in loads.loads if of not in given and of not in numbers]
    if given:
        loop = _loop(motion, "inputs", [of.row for of in given])
        u = loop.place("input", [list(inputs).index(of.value) for of in given])
        sign = loop.column([Fraction(of.sign) for of in given])
        _add(loop, [of.row for of in given], sign * loop.element("u", u.at(0)))
        result.append(loop.made())
    if numbers:
        loop = _loop(motion, "constant_loads", [of.row for of in numbers])
        _add(loop, [of.row for of in numbers], loop.column([of.sign * exact(of.value) for of in numbers]))
        result.append(loop.made())
    for of in others:
        operator = Operator.ADD if of.sign > 0 else Operator.SUB
        result.append(StoreElement(Element(APPLIED, constant(of.row)), ScalarRef(str(_symbol(of))), operator))
    if loads.springs:
        loop, extension, springs = _springs(motion, loads, "springs")
        damping = loop.column([of.damping for of in springs])
        k, sign = loop.column([of.stiffness for of in springs]), loop.column([Fraction(of.sign) for of in springs])
        v = loop.element(motion.v[0], loop.place("row", [of.row for of in springs]).at(motion.v[1]))
        _add(loop, [of.row for of in springs], -(sign * (k * extension) + damping * v))
        result.append(loop.made())
    return result


def stored(motion: TreeMotion, loads: RowLoads) -> list[Statement]:
    """The statements that add the energy of the springs."""
    if not any(of.stiffness for of in loads.springs):
        return []
    loop, extension, springs = _springs(motion, loads, "stored")
    k = loop.column([of.stiffness for of in springs])
    loop.store("energy", constant(1), k * extension * extension / 2, Operator.ADD)
    return [loop.made()]


def _springs(motion: TreeMotion, loads: RowLoads, name: str) -> tuple[LinkLoop, ca.SX, Sequence[RowSpring]]:
    springs = loads.springs
    loop = _loop(motion, name, [of.row for of in springs])
    q = loop.element(motion.q[0], loop.place("spring", [of.coordinate for of in springs]).at(motion.q[1]))
    sign, rest = (loop.column([Fraction(getattr(of, key)) for of in springs]) for key in ("sign", "rest"))
    return loop, sign * q - rest, springs


def _loop(motion: TreeMotion, name: str, rows: Sequence[int]) -> LinkLoop:
    return LinkLoop(motion.arrays, name, rows)


def _add(loop: LinkLoop, rows: Sequence[int], value: ca.SX) -> None:
    loop.store(APPLIED, loop.place("row", rows).at(0), value, Operator.ADD)
