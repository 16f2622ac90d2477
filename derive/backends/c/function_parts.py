"""Long straight-line functions in parts, static functions that follow each other.

Compilers allocate registers to all values of a function at once, in a time that grows faster than its length, and less
well. Parts take gcc a half to a third of the time, and a tenth less at run time. Most values are needed near their
statements alone; those that later parts need go through an array, as they would be on the stack in one function.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count as numbers

from derive.backends.c.signatures import parameters_by_name, signature
from derive.backends.source_map import SourceLine, plain
from derive.backends.wrapping import comment, prefixed
from derive.ir.analysis import names_read
from derive.ir.expressions import Element, Operation, walk
from derive.ir.kernel import Kernel
from derive.ir.loop_nests import Assign, Node, expressions_of
from derive.ir.statements import Let, Require

LENGTH = 500
"""The operations of a part, of which each statement has one more. Times differ little between 300 and 1000."""
LONG = 1400
"""The length of a function from which on it is divided."""


@dataclass(frozen=True)
class NumberedNodes:
    """The plain statements of a statement: numbers of its section and of it there."""

    section: int
    statement: int
    nodes: tuple[Node, ...]

    @cached_property
    def length(self) -> int:
        """Operations, and one for the statement."""
        parts = (part for node in self.nodes for expr in expressions_of(node) for part in walk(expr))
        return 1 + sum(isinstance(part, Operation) for part in parts)


@dataclass
class FunctionPart:
    """A part of the function of a kernel.

    loaded, stored: the values of earlier parts that it reads, and those of its own that later parts read, with their
    places in the array that keeps them.
    """

    name: str
    body: list[NumberedNodes] = field(default_factory=list)
    loaded: dict[str, int] = field(default_factory=dict)
    stored: dict[str, int] = field(default_factory=dict)

    @property
    def nodes(self) -> list[Node]:
        """All plain statements."""
        return [node for item in self.body for node in item.nodes]

    @property
    def checked(self) -> bool:
        """Whether a requirement may end it."""
        return any(isinstance(node, Require) for node in self.nodes)

    @property
    def defined(self) -> list[str]:
        """The names of its values, in their order."""
        return [node.name for node in self.nodes if isinstance(node, Let)]

    @cached_property
    def used(self) -> set[str]:
        """The names that it reads, and the arrays to which it writes."""
        targets = (node.target for node in self.nodes if isinstance(node, Assign))
        return {*names_read(self.nodes), *(target.array for target in targets if isinstance(target, Element))}


@dataclass(frozen=True)
class DividedFunction:
    """The parts of the function of a kernel.

    arrays: the names of local arrays that parts read. kept: the name of the array of the values that later parts read;
    places: its size.
    """

    kernel: Kernel
    parts: tuple[FunctionPart, ...]
    arrays: tuple[str, ...]
    kept: str
    places: int

    def _passed(self, part: FunctionPart) -> dict[str, str]:
        """The parameters of a part by the names of what is passed: what it reads and writes."""
        used = part.used
        read = [a.name for a in self.kernel.arguments if used & {a.name, *a.elements, *(v.name for v in a.arrays)}]
        written = [o.name for o in self.kernel.outputs if o.name in used]
        every = parameters_by_name(self.kernel)
        every |= {name: f"const double *TISSERAND_RESTRICT {name}" for name in self.arrays}
        passed = {name: every[name] for name in (*read, *written, *(name for name in self.arrays if name in used))}
        if part.loaded or part.stored:
            passed[self.kept] = f"{'' if part.stored else 'const '}double *TISSERAND_RESTRICT {self.kept}"
        return passed

    def function(self, part: FunctionPart, body: Iterable[SourceLine]) -> list[SourceLine]:
        """The lines of the static function of a part."""
        number = self.parts.index(part) + 1
        doc = f"Part {number} of {len(self.parts)} of {self.kernel.name}."
        kind = "int" if part.checked else "void"
        head = signature(f"TISSERAND_SHARED {kind} {part.name}", [*self._passed(part).values()])
        end = ["    return 0;"] if part.checked else []
        return [*plain(*comment([doc]), *head, "{"), *body, *plain(*end, "}", "")]

    def calls(self) -> list[SourceLine]:
        """The lines of the calls of all parts, with the declaration of the array of values that later parts need."""
        passed = {name for part in self.parts for name in self._passed(part)}
        unused = [a.name for a in self.kernel.arguments if a.name not in passed]
        lines = [*(f"    (void) {name};" for name in unused), f"    double {self.kept}[{self.places}];"]
        for part in self.parts:
            arguments = ", ".join(self._passed(part))
            if part.checked:
                lines += ["    {", f"        const int failed = {part.name}("]
                lines += [*prefixed([f"{arguments});"], " " * 12), "        if (failed) return failed;", "    }"]
            else:
                lines += [f"    {part.name}(", *prefixed([f"{arguments});"], " " * 8)]
        return plain(*lines)


def divided_function(
    name: str, kernel: Kernel, body: Sequence[NumberedNodes], arrays: Iterable[str]
) -> DividedFunction | None:
    """The parts of a function in straight-line code; None if it is short, or has local arrays or loops of its own.

    body: its statements. arrays: the names of local arrays that are computed before.
    """
    total = sum(item.length for item in body)
    straight = all(isinstance(node, Let | Require | Assign) for item in body for node in item.nodes)
    if total < LONG or not straight or any(argument.parts for argument in kernel.arguments):
        return None
    count, before = round(total / LENGTH), 0
    bodies: dict[int, list[NumberedNodes]] = {}
    for item in body:
        bodies.setdefault(before * count // total, []).append(item)
        before += item.length
    parts = [FunctionPart(f"{name}_part_{n}", items) for n, items in enumerate(bodies.values(), 1)]
    taken = {*kernel.used, *(name for part in parts for name in part.defined), *(o.name for o in kernel.outputs)}
    taken |= {a.name for a in kernel.arguments}
    kept = next(name for name in (f"kept{'_' * n}" for n in numbers()) if name not in taken)
    return DividedFunction(kernel, tuple(parts), tuple(arrays), kept, _keep(parts))


def _keep(parts: Sequence[FunctionPart]) -> int:
    """Give the values that later parts read their places; a place is free behind the last part that reads its value."""
    read = [part.used for part in parts]
    free: list[int] = []
    freed: list[list[int]] = [[] for _ in parts]
    places = 0
    for n, part in enumerate(parts):
        for name in part.defined:
            readers = [m for m in range(n + 1, len(parts)) if name in read[m]]
            if not readers:
                continue
            if not free:
                free.append(places)
                places += 1
            place = free.pop()
            part.stored[name] = place
            for m in readers:
                parts[m].loaded[name] = place
            freed[readers[-1]].append(place)
        free += freed[n]
    return max(places, 1)
