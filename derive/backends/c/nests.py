"""Plain statements as C: declarations, requirements, and loops, some of which run in vectors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count, groupby
from typing import assert_never

from derive.backends.c.loop_text import (
    Lines,
    address_text,
    block_name,
    declarations,
    indented,
    last_block,
    loop_head,
    row_distance,
)
from derive.backends.c.values_in_lanes import ValuesInLanes
from derive.backends.expression_text import index_text
from derive.backends.source_map import defining, plain
from derive.backends.wrapping import join, statement
from derive.ir.expressions import Element
from derive.ir.indices import LANE, LANES
from derive.ir.loop_nests import (
    Accumulator,
    Alias,
    Assign,
    BlockProduct,
    For,
    If,
    Integer,
    Local,
    LoopKind,
    Node,
    PartOf,
    Sines,
    every,
)
from derive.ir.statements import Let, Require, Requirement, ReturnCode

IN_LANES = (LoopKind.LANES, LoopKind.FEW)
CHECKS = {Requirement.POSITIVE: "TISSERAND_CHECK", Requirement.FINITE: "TISSERAND_CHECK_FINITE"}
CHECKS_OF_ENDS = {Requirement.POSITIVE: "TISSERAND_CHECK_ENDS"}  # results are those of bodies, not of joints


def names_in_order(name: str) -> Iterator[str]:
    """Yield a name, and then the same name with numbers from 2 on."""
    yield name
    yield from (f"{name}_{number}" for number in count(2))


@dataclass
class CNests(ValuesInLanes):
    """The plain statements of one function.

    helpers: the first part of the names of the functions that it calls; has_codes: whether the states of a batch have
    codes from the beginning, which the first loop over states with requirements gives them otherwise; first_code: that
    of the first requirements, behind which there are none but those with other ones; starts: the elements from which on
    vectors are stored in local arrays, see `vector_starts`; counter: the type of integers and of the variables of loops
    in order. Where these place elements, ptrdiff_t spares an extension of each index.
    """

    helpers: str = ""
    has_codes: bool = False
    first_code: ReturnCode | None = None
    starts: Mapping[str, int] = field(default_factory=dict)
    counter: str = "int"
    _known: set[str] = field(default_factory=set)
    """The arrays that are declared."""
    _checks: dict[ReturnCode, str] | None = None
    """The names of what a loop with lanes inside finds out about its requirements, by their codes."""
    _in_step: bool = False
    """Whether loops are inside of a loop over the steps from both ends of a path."""
    _is_coded: bool = False
    """Whether the states of a batch have got codes."""
    _finite: Iterator[str] = field(default_factory=lambda: names_in_order("finite"))
    """The names of values that are checked to be finite in a loop over the states."""
    _names: Iterator[int] = field(default_factory=lambda: count(1))
    """The numbers of these names."""

    def lines(self, nodes: Iterable[Node]) -> Lines:
        """The lines of plain statements, as they are written in a function."""
        lines: Lines = []
        for declare, group in groupby(nodes, lambda node: isinstance(node, Local)):
            if declare:
                lines += self._declared(node for node in group if isinstance(node, Local))
            else:
                lines += [line for node in group for line in self._lines(node)]
        return lines

    def _lines(self, node: Node) -> Lines:
        match node:
            case Let():
                kind = f"const {self._vector}" if self._is_vector(node.name, node.expr) else "const double"
                return defining(statement("    ", f"{kind} {node.name} = ", self.text(node.expr), ";"), node.name)
            case Assign():
                return self._assign(node)
            case Require():
                return plain(*self._require(node))
            case Local():
                return self._declared([node])
            case Alias():
                kind = "double" if node.array in self.outputs else "const double"
                tile = [f"    TISSERAND_TILE({node.name});"] if node.name in self.filled else []
                return plain(f"    {kind} *{node.name} = {address_text(node.array, node.index)};", *tile)
            case Integer():
                value = f"{node.array}[{index_text(node.index)}]{f' * {node.times}' if node.times else ''}"
                return plain(f"    const {self.counter} {node.name} = {value};")
            case Accumulator():
                return self._accumulator(node)
            case For():
                return self._loop(node)
            case If():
                then, otherwise = (indented(self.lines(body)) for body in (node.then, node.otherwise))
                head = f"    if ({node.variable} < {node.bound}) {{"
                middle = plain("    } else {") if otherwise else []
                return [*plain(head), *then, *middle, *otherwise, *plain("    }")]
            case PartOf():
                return [replace(line, statement=node.statement) for line in self.lines(node.body)]
            case BlockProduct():
                matrix = f"{address_text(node.matrix, node.first)}, {node.stride}, {node.sign}.0"
                vector, target = (address_text(e.array, e.index) for e in (node.vector, node.target))
                return plain(f"    {self.helpers}_rows(count, {matrix}, {vector}, {target});")
            case Sines():
                return self._sines(node)
            case _:
                assert_never(node)

    def _sines(self, node: Sines) -> Lines:
        if node.stride and node.count == 1:
            angle = address_text(node.angle.array, node.angle.index)
            return plain(f"    tisserand_sines_of_one({angle}, {node.sine}, {node.cosine});")
        if node.stride:
            self.filled |= {node.sine, node.cosine}
            angles = f"{node.count}, {address_text(node.angle.array, node.angle.index)}, {node.stride}"
            return plain(f"    tisserand_spaced_sines({angles}, {node.sine}, {node.cosine});")
        rows = [f"[{index_text(index)}]" for index in node.rows] if node.rows else ["", ""]
        results = f"{node.sine}{rows[0]}, {node.cosine}{rows[1]}"
        if self.has_codes and node.count is None:
            return plain(f"    {self.helpers}_sines({self._row(node.angle)}, {results});")
        number = "count" if node.count is None else str(node.count)
        number = f"TISSERAND_FILLED({number})" if node.count and node.count % LANES else number
        return plain(f"    tisserand_sines({number}, {self._row(node.angle)}, {results});")

    def _row(self, element: Element) -> str:
        """The values of all states of a batch, from the first one on."""
        if element.array not in self.arrays:
            return element.array
        rows = row_distance(element.index)
        return f"{element.array} + {rows}" if rows else element.array

    # ---- declarations and requirements ----

    def _declared(self, nodes: Iterable[Local]) -> Lines:
        """Local arrays, unless an earlier section has declared them; those of a batch are declared at its beginning."""
        new = [node for node in nodes if not self.arrays and node.array not in self._known]
        self._known |= {node.array for node in new}
        self._lanes |= {node.array for node in new if node.totals}
        self.filled |= {node.array for node in new if node.in_lanes}
        aligned = [node.array for node in new if node.array in self.starts and not node.cleared]
        lines = declarations(
            f"{n.array}[{n.size}]{' = {0.0}' if n.cleared else ''}" for n in new if n.array not in aligned
        )
        lines += [
            f"    TISSERAND_ALIGNED({n.array}, {n.size + LANES}, {-self.starts[n.array] % LANES});"
            for n in new
            if n.array in aligned
        ]
        return plain(*lines)

    def _require(self, node: Require) -> list[str]:
        value = self.text(node.expr)
        holds = join("!(", value, " > 0.0)") if node.kind is Requirement.POSITIVE else join("!isfinite(", value, ")")
        if self._vectors is not None and self._differs(node.expr):
            assert self._checks is not None
            check = CHECKS[node.kind] if self._lane == LANE else CHECKS_OF_ENDS[node.kind]
            return statement("    ", f"{check}({self._checks[node.code]}, ", value, f"); /* {node.text} */")
        return statement("    ", "if (", holds, f") return {int(node.code)}; /* {node.text} */")

    def _states(self, node: For) -> Lines:
        """The body of a loop over states. Both codes are computed before one is chosen, so that no branch is needed.

        The first requirement that fails gives the code, so it comes last; and what failed before keeps its own. Where
        states have codes from the beginning, requirements stay where their values are known.
        """
        checks = [item for item in node.body if isinstance(item, Require)]
        self._finite = names_in_order("finite")
        if checks and self.has_codes:
            groups = ((self._checked(item) if isinstance(item, Require) else None, item) for item in node.body)
            lines = [line for code, item in groups for line in (self._lines(item) if code is None else plain(*code))]
            return [*plain("    double code = codes[b];"), *lines, *plain("    codes[b] = code;")]
        lines = self.lines(item for item in node.body if not isinstance(item, Require))
        if not checks:
            return lines
        *first, last = checks
        if last.kind is Requirement.FINITE:  # a difference of what is not finite is a NaN, which stands for the code
            name = next(self._finite)
            lines += plain(*statement("    ", f"const double {name} = ", self.text(last.expr), ";"))
            lines += plain(f"    double code = {name} - {name}; /* {last.text} */")
            if first:  # gcc would compute it behind a branch where a choice drops it; such loops are no vectors
                lines += plain("    failures |= tisserand_code_bits(code);")
        else:
            lines += plain("    double code = 0.0;", *self._checked(last))
        lines += plain(*(text for check in reversed(first) for text in self._checked(check)))
        lines += plain(*(["    if (codes[b] != 0.0) code = codes[b];"] if self._is_coded else []))
        lines += plain("    codes[b] = code;", "    failures |= tisserand_code_bits(code);")
        self._is_coded = True
        return lines

    def _checked(self, node: Require) -> list[str]:
        """The lines that keep the code of a state or choose that of a requirement."""
        keeps = self.has_codes and node.code is not self.first_code
        kept = "code > 0.0 ? code : " if keeps else ""  # two choices are faster than one with two conditions
        value, end = self.text(node.expr), f" ? code : {kept}{int(node.code)}.0; /* {node.text} */"
        match node.kind:
            case Requirement.POSITIVE:
                return statement("    ", "code = ", join(value, " > 0.0"), end)
            case Requirement.FINITE:  # a difference of what is not finite is a NaN
                name = next(self._finite)
                lines = statement("    ", f"const double {name} = ", value, ";")
                return [*lines, f"    code = {name} - {name} == 0.0{end}"]
            case _:
                assert_never(node.kind)

    # ---- loops ----

    def _checked_once(self, node: For) -> Lines:
        """A loop with lanes inside whose requirements are tested behind it, since a branch in each block takes time."""
        sines = (item for item in every([node]) if isinstance(item, Sines))
        self.filled |= {array for item in sines for array in (item.angle.array, item.sine, item.cosine)}
        lanes = (item for item in every([node]) if isinstance(item, For) and item.kind in IN_LANES)
        codes = dict.fromkeys(item.code for loop in lanes for item in loop.body if isinstance(item, Require))
        self._checks = {code: f"holds_{next(self._names)}" for code in codes}
        lines = plain(*(f"    tisserand_holds {name} = TISSERAND_HOLDS;" for name in self._checks.values()))
        lines += self._loop(node)
        for code, name in self._checks.items():
            lines += plain(f"    if (!TISSERAND_EVERY({name})) return {int(code)}; /* {code.meaning} */")
        self._checks = None
        return lines

    def _loop(self, node: For) -> Lines:
        if self._checks is None:
            return self._checked_once(node)
        match node.kind:
            case LoopKind.ENDS:
                body = self._in_lanes(node)
                head = f"for (int {node.variable} = 0; {node.variable} < 2; {node.variable} += TISSERAND_ENDS) {{"
            case LoopKind.LANES | LoopKind.FEW:
                self._few = node.stop.offset if node.kind is LoopKind.FEW else 0
                body = self._in_lanes(node)
                head = f"for (int l = 0; l < {node.stop.offset}; l += TISSERAND_WIDTH) {{"
            case LoopKind.STATES:
                body, head = self._states(node), "TISSERAND_STATES for (int b = 0; b < count; b++) {"
            case LoopKind.ORDERED | LoopKind.INDEPENDENT:
                in_ends = self._vectors is not None and self._lane != LANE  # steps written out run no faster
                short, before = self._in_step or not in_ends, self._in_step
                self._in_step = in_ends
                body, head = self._body(node.body), loop_head(node, self.counter, short)
                self._in_step = before
                last = last_block(node)
                if last is not None:
                    block = block_name(node.variable)
                    name = f"    const {self.counter} {node.variable}"
                    body = [*plain(f"{name} = {block} < {last} ? {block} : {last};"), *body]
            case _:
                assert_never(node.kind)
        return [*plain(f"    {head}"), *indented(body), *plain("    }")]

    def _body(self, nodes: Sequence[Node]) -> Lines:
        """The body of a loop; from both ends of a path, its requirements have one test, which is behind the last one.

        Behind the whole loop, another vector would be carried along, and long loops were slower.
        """
        checks = {n: item for n, item in enumerate(nodes) if isinstance(item, Require)}
        if not checks or self._vectors is None or self._lane == LANE:
            return self.lines(nodes)
        codes = dict.fromkeys(check.code for check in checks.values())
        before, self._checks = self._checks, {code: f"holds_{next(self._names)}" for code in codes}
        names, behind = self._checks, max(checks) + 1
        lines = plain(*(f"    tisserand_ends_holds {name} = TISSERAND_ENDS_HOLDS;" for name in names.values()))
        lines += self.lines(nodes[:behind])
        for code, name in names.items():
            lines += plain(f"    if (!TISSERAND_BOTH({name})) return {int(code)}; /* {code.meaning} */")
        self._checks = before
        return [*lines, *self.lines(nodes[behind:])]

    def _in_lanes(self, node: For) -> Lines:
        self._vectors, self._lane = set(), node.variable
        lines = self._body(node.body)
        self._vectors, self._lane, self._few = None, LANE, 0
        return lines
