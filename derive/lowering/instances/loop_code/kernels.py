"""The kernels of functions in loops over instances or links: their arguments, what is known, and their sections."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from derive.ir.analysis import reads
from derive.ir.continuation import continued_statements
from derive.ir.expressions import Number
from derive.ir.kernel import Argument, Kernel, Output, Section, View
from derive.ir.patterns import Pattern
from derive.ir.statements import Statement
from derive.ir.unused import without_shadows, without_unused
from derive.lowering.instances.classes.known_motion import KnownMotion
from derive.lowering.model_functions import ModelFunction

ZERO = Number(Fraction(0))


@dataclass(frozen=True)
class Result:
    """The names of the elements of an output; where instances have them their order and their number; or a pattern."""

    elements: tuple[str, ...] = ()
    pattern: Pattern | None = None
    count: int | None = None

    def output(self, name: str, doc: str) -> Output:
        """The output with this name and documentation."""
        count = self.count if self.pattern is None else len(self.pattern.rowidx)
        return Output(name, self.elements, doc, self.pattern, count)


Part = tuple[str, str, str, Iterable[Statement]]
"""A section: name, equation, text and statements."""


def whole(name: str, size: int, doc: str) -> Argument:
    """An argument whose elements have no names of their own."""
    return Argument(name, (), doc, arrays=(View(name, 0, size),))


class KernelData(Protocol):
    """The facts of a mechanism that a kernel needs: its numbers of coordinates and rows, and what is known."""

    known: KnownMotion
    coordinates: int
    rows: tuple[str, ...]


def kernel(
    context: KernelData,
    function: ModelFunction,
    results: Mapping[str, Result],
    *sections: Part,
    inputs: Mapping[str, Argument] | None = None,
) -> Kernel:
    """The kernel of a function from its sections, with what is known computed before."""
    arguments = {
        "t": Argument("t", (), "time", scalar=True),
        "q": whole("q", context.coordinates, "generalised coordinates"),
        "v": whole("v", len(context.rows), "generalised velocities"),
        "u": context.known.context.u.argument,
        "k": Argument("k", (), "constants from setup"),
        **(inputs or {}),
    }
    outputs = tuple(results[name].output(name, doc) for name, doc in function.outputs.items())
    bodies = without_unused([tuple(body) for *_, body in sections], [output.name for output in outputs])
    made = [
        Section(name, equation, text, tuple(continued_statements(body)))
        for (name, equation, text, _), body in zip(sections, without_shadows(bodies), strict=True)
    ]
    used = {name for section in made for statement in section.body for name in reads(statement)}
    names = used & context.known.names
    moving = names & {str(symbol) for symbol in context.known.moving}
    assert not moving or "t" in function.arguments, f"{function.name} knows no time, on which {moving} depend"
    known = Section("known", "(1)", "the ground, prescribed motions and drives", context.known.statements(names))
    return Kernel(
        function.name,
        function.doc,
        tuple(arguments[name] for name in function.arguments),
        outputs,
        tuple(section for section in (known, *made) if section.body),
    )
