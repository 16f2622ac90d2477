"""Sections that several functions have in common: one static function of each, which these call.

The elimination of the joints is the same in the accelerations and in projections. Compilers take as long for a text
each time it occurs, and a call for all joints is no measurable part of their time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from derive.backends.c.loop_text import vector_starts
from derive.backends.c.nests import CNests
from derive.backends.c.optional_parts import optional_part
from derive.backends.c.signatures import signature
from derive.backends.description import section_text
from derive.backends.source_map import SourceLine, plain
from derive.backends.wrapping import comment, prefixed
from derive.ir.expressions import Element, Ends, Expr, LaneSum, ScalarRef, walk
from derive.ir.kernel import ConstantArray, Kernel, Section
from derive.ir.lanes import section_in_lanes
from derive.ir.loop_nests import (
    Accumulator,
    Alias,
    Assign,
    BlockProduct,
    For,
    Integer,
    Local,
    Node,
    Sines,
    every,
    expressions_of,
)
from derive.ir.model import Model
from derive.ir.statements import Let, Require, Statement
from derive.ir.tiles import in_tiles, numbers_of_instances, tiles_read

LONG = 100
"""The plain statements of a section that is worth a call."""


@dataclass(frozen=True)
class SharedSection:
    """A section of several kernels, in a static function of this name.

    arrays: those that it accesses and does not declare, and whether it writes them; tables: the constant arrays that
    lie in tiles.
    """

    name: str
    section: Section
    arrays: tuple[tuple[str, bool], ...]
    checked: bool
    tables: Mapping[str, ConstantArray]

    def function(self) -> list[SourceLine]:
        """The lines of the static function."""
        types = ("double *" if written else "const double *" for _, written in self.arrays)
        parameters = [f"{kind}TISSERAND_RESTRICT {array}" for kind, (array, _) in zip(types, self.arrays, strict=True)]
        body = [
            (n, tuple(in_tiles(node, self.tables) for node in nodes))
            for n, nodes in section_in_lanes(self.section.body)
        ]
        starts = vector_starts(node for _, nodes in body for node in nodes)
        nests = CNests(starts=starts, counter="ptrdiff_t", filled=tiles_read(self.tables))
        lines = [line for _, nodes in body for line in nests.lines(nodes)]
        kind = "int" if self.checked else "void"
        return [
            *plain(*comment([section_text(self.section)])),
            *plain(*signature(f"TISSERAND_SHARED {kind} {self.name}", parameters), "{"),
            *lines,
            *plain(*(["    return 0;"] if self.checked else []), "}"),
        ]

    def call(self) -> list[SourceLine]:
        """The lines of a call."""
        passed = prefixed([f"{', '.join(array for array, _ in self.arrays)});"], " " * 12)
        if not self.checked:
            return plain(f"    {self.name}(", *passed)
        return plain(
            "    {", f"        const int failed = {self.name}(", *passed, "        if (failed) return failed;", "    }"
        )


SharedSections = Mapping[tuple[Statement, ...], SharedSection]
"""The sections that have a function, by their statements."""


def shared_sections(model: Model, texts: Iterable[Kernel]) -> SharedSections:
    """The long sections that several kernels have, by their statements, if these are loops over instances.

    texts: the kernels that are printed. Those that compilations may leave out share none.
    """
    if model.lowering != "instances":
        return {}
    kernels = [kernel for kernel in texts if optional_part(kernel.name) is None]
    counts = Counter(section.body for kernel in kernels for section in kernel.sections)
    several = {s.body: s for kernel in kernels for s in kernel.sections if counts[s.body] > 1}
    made = (_shared(f"{model.name}_{s.name}_of_several", s, kernels) for s in several.values())
    return {shared.section.body: shared for shared in {of.name: of for of in made if of}.values()}


def _shared(name: str, section: Section, kernels: Iterable[Kernel]) -> SharedSection | None:
    """The function of a section, if it is long, and gives and takes nothing but elements of arrays of numbers."""
    body = [node for _, nodes in section_in_lanes(section.body) for node in nodes]
    nodes = [*every(body)]
    own, arrays = {*_defined(nodes)}, _arrays(nodes)
    around = [other for kernel in kernels if section in kernel.sections for other in kernel.sections]
    elsewhere = {array for other in around if other != section for array in _arrays(_nodes(other))}
    if (
        len(nodes) < LONG
        or not all(isinstance(node, Local | Sines | For) for node in body)
        or any(isinstance(node, Alias | BlockProduct) for node in nodes)
        or not own.issuperset(_scalars(nodes))
        or any(node.array in elsewhere for node in body if isinstance(node, Local))
    ):
        return None
    inside = own | {array.name for kernel in kernels for array in kernel.constants}
    outer = tuple((array, written) for array, written in arrays.items() if array not in inside)
    tables = numbers_of_instances(array for kernel in kernels for array in kernel.constants)
    return SharedSection(name, section, outer, any(isinstance(node, Require) for node in nodes), tables)


def _nodes(section: Section) -> Iterator[Node]:
    return every(node for _, nodes in section_in_lanes(section.body) for node in nodes)


def _arrays(nodes: Iterable[Node]) -> dict[str, bool]:
    """The arrays whose elements plain statements access, and whether they write them."""
    result: dict[str, bool] = {}
    for node in nodes:
        for part in _parts(node):
            if isinstance(part, Element | Ends | LaneSum):
                result.setdefault(part.array, False)
        if isinstance(node, Assign) and isinstance(node.target, Element | Ends):
            result[node.target.array] = True
        elif isinstance(node, Sines):
            result |= dict.fromkeys((node.sine, node.cosine), True)
    return result


def _scalars(nodes: Iterable[Node]) -> Iterator[str]:
    """The names of numbers and integers that plain statements read."""
    for node in nodes:
        indices = [node.start, node.stop] if isinstance(node, For) else []
        for part in (*_parts(node), *([node.target] if isinstance(node, Assign) else [])):
            if isinstance(part, ScalarRef):
                yield part.name
            elif isinstance(part, Element) and part.index is not None:
                indices.append(part.index)
            elif isinstance(part, Ends):
                indices += [part.first, part.second]
        yield from (term.variable for index in indices for term in index.terms)


def _parts(node: Node) -> Iterator[Expr]:
    return (part for expr in expressions_of(node) for part in walk(expr))


def _defined(nodes: Iterable[Node]) -> Iterator[str]:
    """The names of numbers, arrays and variables of loops that plain statements define."""
    for node in nodes:
        match node:
            case Let() | Integer() | Accumulator():
                yield node.name
            case Local():
                yield node.array
            case For():
                yield node.variable
