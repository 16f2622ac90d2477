"""Plain statements as C: declarations, assignments, and loops, some of which run in vectors.

A loop over lanes takes as many at a time as a register of the target has. gcc and clang get vectors explicitly, since
they do not make any of such loops by themselves at all levels; for other compilers a vector is a number. Lanes do not
mix, so that the bits are the same in every way.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
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
from derive.backends.expression_text import C, Named, element, index_text, text
from derive.backends.source_map import defining, plain, storing
from derive.backends.wrapping import BreakableText, join, statement
from derive.ir.expressions import Element, Ends, Expr, Operation, Operator, ScalarRef, walk
from derive.ir.indices import LANE, LANES, ElementIndex, IndexTerm
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
OPERATORS = {None: "=", Operator.ADD: "+=", Operator.SUB: "-=", Operator.MUL: "*=", Operator.NEG: "="}


def names_in_order(name: str) -> Iterator[str]:
    """Yield a name, and then the same name with numbers from 2 on."""
    yield name
    yield from (f"{name}_{number}" for number in count(2))


@dataclass
class CNests:
    """The plain statements of one function.

    outputs: the arrays that the function writes; arrays: all arrays that are its parameters, in which a batch has rows
    of all its states; helpers: the first part of the names of the functions that it calls; has_codes: whether the
    states of a batch have codes from the beginning, which the first loop over states with requirements gives them
    otherwise; first_code: that of the first requirements, behind which there are none but those with other ones;
    starts: the elements from which on vectors are stored in local arrays, see `vector_starts`; counter: the type of
    integers and of the variables of loops in order. Where these place elements, ptrdiff_t spares an extension of each
    index.
    """

    outputs: Collection[str] = ()
    arrays: Collection[str] = ()
    helpers: str = ""
    has_codes: bool = False
    first_code: ReturnCode | None = None
    starts: Mapping[str, int] = field(default_factory=dict)
    counter: str = "int"
    _known: set[str] = field(default_factory=set)
    """The arrays that are declared."""
    _lanes: set[str] = field(default_factory=set)
    """The arrays of the lanes of sums."""
    _totals: dict[str, str] = field(default_factory=dict)
    """The arrays and sums that accumulators add up, by the names of these."""
    _vectors: set[str] | None = None
    """The names that differ from lane to lane, in a loop over lanes."""
    _lane: str = LANE
    """The variable of that loop, which is that of the ends in a loop over the ends of a path."""
    _few: int = 0
    """The number of iterations of that loop, if vectors have more lanes; 0 otherwise."""
    filled: set[str] = field(default_factory=set)
    """The arrays that have a number for each lane: angles, sines and cosines, sums over modes and their factors."""
    _checks: dict[ReturnCode, str] | None = None
    """The names of what a loop with lanes inside finds out about its requirements, by their codes."""
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
                return plain(f"    {kind} *{node.name} = {address_text(node.array, node.index)};")
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

    # ---- expressions ----

    def text(self, expr: Expr) -> BreakableText:
        """An expression; what differs from lane to lane is a vector."""
        return text(expr, C, self._leaf)

    def _leaf(self, leaf: Named) -> BreakableText:
        if isinstance(leaf, Ends):
            return BreakableText((f"{self._of_ends('LOAD', leaf)})",))
        if not isinstance(leaf, Element):
            return element(leaf)
        if leaf.state:
            return BreakableText((self._of_state(leaf),))
        if self._vectors is not None and leaf.index and leaf.index.stride(self._lane):
            address, stride = address_text(leaf.array, leaf.index), leaf.index.stride(self._lane)
            if self._has_few(leaf.array):
                return BreakableText((f"TISSERAND_GATHER_FEW({address}, {stride}, {self._left})",))
            return BreakableText(
                (f"{self._macro('GATHER')}({address}, {stride})",)
                if stride != 1
                else (f"{self._macro('LOAD')}({address})",)
            )
        return element(leaf)

    @property
    def _vector(self) -> str:
        """The type of the values of all lanes."""
        return "tisserand_lanes" if self._lane == LANE else "tisserand_ends"

    def _macro(self, what: str) -> str:
        return f"TISSERAND_{what}" if self._lane == LANE else f"TISSERAND_{what}_ENDS"

    def _has_few(self, array: str) -> bool:
        """Whether an array has no elements for the lanes that are left."""
        return self._few > 0 and array not in self.filled

    @property
    def _left(self) -> str:
        """The number of iterations from the first lane of a vector on."""
        return f"{self._few} - {LANE}"

    @staticmethod
    def _of_ends(what: str, ends: Ends) -> str:
        return (
            f"TISSERAND_{what}_BOTH({ends.array}, {ends.variable}, {index_text(ends.first)}, {index_text(ends.second)}"
        )

    def _of_state(self, leaf: Element) -> str:
        if leaf.array in self.arrays:
            rows = row_distance(leaf.index)
            return f"{leaf.array}[{rows} + {leaf.state}]" if rows else f"{leaf.array}[{leaf.state}]"
        index = f"[{index_text(leaf.index)}]" if leaf.index else ""
        return f"{leaf.array}{index}[{leaf.state}]"

    def _differs(self, expr: Expr) -> bool:
        """Whether the value of an expression differs from lane to lane."""
        assert self._vectors is not None
        return any(
            (isinstance(part, ScalarRef) and part.name in self._vectors)
            or (isinstance(part, Element) and part.index is not None and part.index.has(self._lane))
            or isinstance(part, Ends)
            for part in walk(expr)
        )

    def _is_vector(self, name: str, expr: Expr) -> bool:
        """Whether a value is a vector; its name is known from then on."""
        if self._vectors is None or not self._differs(expr):
            return False
        self._vectors.add(name)
        return True

    # ---- declarations and assignments ----

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

    def _accumulator(self, node: Accumulator) -> Lines:
        assert self._vectors is not None
        self._vectors.add(node.name)
        self._totals[node.name] = node.total
        value = self.text(node.expr) if self._differs(node.expr) else "{0.0}"
        return plain(f"    tisserand_lanes {node.name} = {value};")

    def _assign(self, node: Assign) -> Lines:
        negative = node.operator is Operator.NEG
        target, value = node.target, self.text(Operation(Operator.NEG, (node.expr,)) if negative else node.expr)
        if isinstance(target, ScalarRef):
            code = statement("    ", f"{target.name} {OPERATORS[node.operator]} ", value, ";")
            return defining(code, self._totals[target.name])
        if isinstance(target, Ends):
            return plain(*statement("    ", "", join(f"{self._of_ends('STORE', target)}, ", value, ")"), ";"))
        if self._vectors is None or not target.index or not target.index.has(self._lane):
            return self._stored(
                node, statement("    ", f"{self._leaf(target)} {OPERATORS[node.operator]} ", value, ";")
            )
        address, stride = address_text(target.array, target.index), target.index.stride(self._lane)
        if not self._differs(node.expr):
            index = index_text(ElementIndex(target.index.offset, (*target.index.terms, IndexTerm(stride, "m"))))
            width = f"TISSERAND_LEFT({self._left})" if self._has_few(target.array) else "TISSERAND_WIDTH"
            code = statement("    ", f"for (int m = 0; m < {width}; m++) {target.array}[{index}] = ", value, ";")
        elif self._has_few(target.array):
            few = join(f"TISSERAND_SCATTER_FEW({address}, {stride}, {self._left}, ", value, ")")
            code = statement("    ", "", few, ";")
        elif stride == 1:
            code = statement("    ", "", join(f"{self._macro('STORE')}({address}, ", value, ")"), ";")
        else:
            code = statement("    ", "", join(f"TISSERAND_SCATTER({address}, {stride}, ", value, ")"), ";")
        return self._stored(node, code)

    def _stored(self, node: Assign, code: list[str]) -> Lines:
        """The lines of an assignment to an element, with what they store or define."""
        assert isinstance(node.target, Element)
        array, index = node.target.array, node.target.index
        if array in self.outputs and index:
            return plain(*code) if node.operator else storing(code, array, index.offset, bool(index.terms))
        complete = isinstance(node.expr, ScalarRef) and node.expr.name in self._totals
        if complete or array in self._lanes:
            return plain(*code)
        return defining(code, array)

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
                short = self._vectors is None or self._lane == LANE  # rows of vectors written out run no faster
                body, head = self._body(node.body), loop_head(node, self.counter, short)
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
