"""Loops over the modes as C for a block of states: inside each of them runs a loop over the states, the innermost.

Additions have the order of the loops of one state: four lanes in a sum, column after column in a matrix.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import assert_never

from derive.backends.c.matrix_loops import rounds
from derive.backends.expression_text import C, Named, strided, text
from derive.backends.wrapping import BreakableText, join, statement
from derive.ir.expressions import ArrayAccess, Expr, MatrixEntry, Number, Operation, Operator, ScalarRef, walk
from derive.ir.model import View
from derive.ir.statements import LANES, Accumulate, Let, Map, MatVec, StoreLocal, StoreStrided, TriangularSolve, padded

Lines = list[str]

STATES = "TISSERAND_STATES for (int b = 0; b < count; b++)"
"""The head of a loop over the states of a block."""

STATES_MACRO = """\
/* Before a loop over the states of a batch: no state needs another one. gcc would unroll a short loop completely first,
   and then make no vectors of it. */
#if defined(__clang__)
#  pragma clang diagnostic ignored "-Wpass-failed"
#  define TISSERAND_STATES _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__) && __GNUC__ >= 8
#  define TISSERAND_STATES _Pragma("GCC ivdep") _Pragma("GCC unroll 1")
#else
#  define TISSERAND_STATES
#endif

/* INLINE: functions that are compiled anew wherever they are called, for the number of states that is given there.
   APART: functions that are not, so that what calls them last needs no stack. */
#if defined(__GNUC__)
#  define TISSERAND_INLINE static inline __attribute__((always_inline, unused))
#  define TISSERAND_APART static __attribute__((noinline))
#else
#  define TISSERAND_INLINE static inline
#  define TISSERAND_APART static
#endif
"""


@dataclass(frozen=True)
class Names:
    """The writer of names and expressions in a loop over the states b of a block.

    `elements` are the argument and the index of the elements of q and v; `wide` are the scalars that have a value for
    each state. Arrays are of k, if they are among `constants`, else local ones with a row for each element.
    """

    elements: Mapping[str, tuple[str, int]]
    constants: frozenset[str]
    wide: frozenset[str]

    def text(self, expr: Expr) -> BreakableText:
        """An expression."""
        return text(expr, C, self.leaf)

    def leaf(self, leaf: Named) -> BreakableText:
        """A name, or an element of an array."""
        match leaf:
            case ScalarRef():
                return BreakableText((f"{leaf.name}[b]" if leaf.name in self.wide else leaf.name,))
            case ArrayAccess():
                constant = not leaf.stride
                index = (
                    BreakableText((str(leaf.offset),))
                    if constant
                    else strided(leaf.offset, leaf.stride, BreakableText((leaf.index,)))
                )
                return self.element(leaf.array, index)
            case MatrixEntry():
                raise TypeError("matrices have no batch")
            case _:
                assert_never(leaf)

    def element(self, array: str, index: BreakableText) -> BreakableText:
        """Element `index` of an array, for state b."""
        return join(array, "[", index, "]" if array in self.constants else "][b]")

    def loads(self, exprs: Iterable[Expr]) -> Lines:
        """Name the elements of q and v that are read."""
        used = {part.name for e in exprs for part in walk(e) if isinstance(part, ScalarRef)}
        read = {name: where for name, where in self.elements.items() if name in used}
        return [f"    const double {name} = {argument}[{row(str(e))}b];" for name, (argument, e) in read.items()]

    def values(self, name: str) -> str:
        """The values of a scalar for all states of the block, as an array."""
        if name not in self.elements:
            return name
        argument, element = self.elements[name]
        return f"{argument} + {element} * all" if element else argument


def row(element: str) -> str:
    """The first part of an index, to which the number of a state is added: where the values of an element begin."""
    return {"0": "", "1": "all + "}.get(element, f"{element} * all + ")


def loop(body: Lines) -> Lines:
    """The loop over the states; see `STATES_MACRO`."""
    return [f"{STATES} {{", *body, "}"]


@dataclass
class BlockLoops:
    """The loops of one function; `arrays` collects the arrays that they declare, with their numbers of rows.

    `vectors` are the arrays that tables are multiplied with: they are padded with zeros.
    """

    names: Names
    prefix: str
    vectors: frozenset[str]
    arrays: dict[str, int] = field(default_factory=dict)

    def view(self, view: View, argument: str) -> Lines:
        """The call that gathers a part of q or v for the states of a block."""
        self.arrays[view.name] = padded(view.size)
        source = f"{argument} + {view.offset} * all" if view.offset else argument
        gather = f"{self.prefix}_gather(count, all, {view.size}, {source}, {view.name});"
        return [gather, *self._padding(view.name, view.size)]

    def map(self, loop_of_modes: Map) -> Lines:
        """A loop over the modes with a loop over the states in each step."""
        names, count = self.names, loop_of_modes.count
        body, padding = names.loads(item.expr for item in loop_of_modes.body), []
        for item in loop_of_modes.body:
            value = names.text(item.expr)
            match item:
                case Let():
                    body += statement("    ", f"const double {item.name} = ", value, ";")
                case StoreLocal():
                    self.arrays[item.array] = padded(count)
                    padding += self._padding(item.array, count)
                    body += statement("    ", f"{item.array}[i][b] = ", value, ";")
                case StoreStrided():
                    index = str(strided(item.offset, item.stride))
                    element = row(index if index == "i" else f"({index})")
                    body += statement("    ", f"{item.output}[{element}b] = ", value, ";")
                case _:
                    assert_never(item)
        return [_for("i", count), *map(_indented, loop(body)), "}", *padding]

    def accumulate(self, sums: Accumulate, name: str) -> Lines:
        """The loops that compute the lanes of sums in the array `name`; `totals` adds them."""
        many, names = len(sums.sums), self.names
        self.arrays[name] = many * LANES
        body = names.loads((*(let.expr for let in sums.lets), *(total.term for total in sums.sums)))
        for let in sums.lets:
            body += statement("    ", f"const double {let.name} = ", names.text(let.expr), ";")
        for k, total in enumerate(sums.sums):
            body += statement("    ", f"{name}[{k * LANES} + l][b] += ", names.text(total.term), ";")
        zero = loop([f"    {name}[i][b] = 0.0;"])
        return [
            *(_for("i", many * LANES), *map(_indented, zero), "}"),
            *(_for("i", sums.count), f"    const int l = i % {LANES};", *map(_indented, loop(body)), "}"),
        ]

    def matvec(self, product: MatVec) -> Lines:
        """The loops of matrix-vector products: four rows at a time for all products, four columns at a time."""
        packing, names = product.packing, self.names
        size = packing.padded
        self.arrays |= {term.name: size for term in product.terms}
        start = [
            f"    {term.name}[r][b] = {names.element(term.base, BreakableText(('r',))) if term.base else '0.0'};"
            for term in product.terms
        ]
        inner = [f"for (int r = i; r < i + {LANES}; r++) {{", *map(_indented, loop(start)), "}"]
        for totals in rounds(product):
            inner.append(f"for (int j = 0; j < {size}; j += {LANES}) {{")
            for total in totals:
                p = total.product
                first, stride = packing.first(p.table), packing.stride(p.table)
                at = f"{packing.array}{f' + {first}' if first else ''}"
                column = f"{at} + {packing.block(p.table) // LANES} * i + {stride} * j"
                given = f"{column}, {stride}, {p.sign}.0, {p.vector} + j, {total.name} + i"
                inner.append(f"    {self.prefix}_rows(count, {given});")
            inner.append("}")
        return [f"for (int i = 0; i < {size}; i += {LANES}) {{", *map(_indented, inner), "}"]

    def triangular_solve(self, solve: TriangularSolve) -> Lines:
        """The loops of triangular solutions, with a loop over the states in each step."""
        n, lines = solve.count, []
        for y in solve.arrays:
            to, by = ("j", "i") if solve.transposed else ("i", "j")
            scale = loop([f"    {y}[j][b] *= {solve.factor}[{n + 1} * j];"])
            update = loop([f"    {y}[{to}][b] -= {solve.factor}[{n} * j + i] * {y}[{by}][b];"])
            rest = [f"for (int i = j + 1; i < {n}; i++) {{", *map(_indented, update), "}"]
            inner = [*rest, *scale] if solve.transposed else [*scale, *rest]
            head = f"for (int j = {n - 1}; j >= 0; j--) {{" if solve.transposed else _for("j", n)
            lines += [head, *map(_indented, inner), "}"]
        return lines

    def _padding(self, array: str, count: int) -> Lines:
        if array not in self.vectors or count == padded(count):
            return []
        zero = loop([f"    {array}[i][b] = 0.0;"])
        return [f"for (int i = {count}; i < {padded(count)}; i++) {{", *map(_indented, zero), "}"]


def totals(loop: Accumulate, name: str) -> tuple[Let, ...]:
    """The sums of a loop as statements: their lanes in the array `name`, added."""

    def lane(k: int) -> ArrayAccess:
        return ArrayAccess(name, "i", 0, k)

    def whole(k: int) -> Operation:
        return Operation(
            Operator.ADD,
            (Operation(Operator.ADD, (lane(k), lane(k + 1))), Operation(Operator.ADD, (lane(k + 2), lane(k + 3)))),
        )

    sums = [(total, whole(k * LANES)) for k, total in enumerate(loop.sums)]
    return tuple(
        Let(s.name, w if s.base == Number(Fraction(0)) else Operation(Operator.ADD, (s.base, w))) for s, w in sums
    )


def rows_helper(prefix: str, width: int) -> Lines:
    """y += sign A x for the rows of a block and four columns of A, of which a row has the states of a block."""
    lines = [
        f"/* y += sign A x for {LANES} rows and {LANES} columns of A; rows of x and y have up to {width} states */",
        f"TISSERAND_INLINE void {prefix}_rows(",
        "    int count,",
        "    const double *TISSERAND_RESTRICT a,",
        "    int stride,",
        "    double sign,",
        f"    double (*TISSERAND_RESTRICT x)[{width}],",
        f"    double (*TISSERAND_RESTRICT y)[{width}])",
        "{",
    ]
    columns = ("", "stride", *(f"{c} * stride" for c in range(2, LANES)))
    for r in range(LANES):
        offsets = (" + ".join(filter(None, [column, str(r) if r else ""])) or "0" for column in columns)
        lines.append(
            f"    const double {', '.join(f'a{r}{c} = sign * a[{offset}]' for c, offset in enumerate(offsets))};"
        )
    body = [f"    const double {', '.join(f'x{c} = x[{c}][b]' for c in range(LANES))};"]
    for r in range(LANES):
        body.append(f"    y[{r}][b] = y[{r}][b] + {' + '.join(f'a{r}{c} * x{c}' for c in range(LANES))};")
    return [*lines, *map(_indented, loop(body)), "}", ""]


def _for(index: str, stop: int) -> str:
    return f"for (int {index} = 0; {index} < {stop}; {index}++) {{"


def _indented(line: str) -> str:
    return f"    {line}"
