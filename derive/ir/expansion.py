"""The meaning of the statements of a Kernel as plain statements: declarations, assignments and loops.

A statement is expanded here and nowhere else: the interpreter, the operation counts, the use of the stack, C, and its
batches know plain statements only.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import reduce
from typing import assert_never

from derive.ir.expressions import (
    Element,
    Expr,
    LaneSum,
    Leaf,
    MatrixEntry,
    Number,
    Operation,
    Operator,
    ScalarRef,
    mapped,
)
from derive.ir.factor_expansion import back_substitution, cholesky, forward_substitution
from derive.ir.indices import LANES, ElementIndex, IndexTerm, Of, constant, triangle, variable
from derive.ir.loop_nests import (
    START,
    Accumulator,
    Alias,
    Assign,
    BlockProduct,
    For,
    Integer,
    Local,
    LoopKind,
    Node,
    ordered_loop,
)
from derive.ir.packing import Packing
from derive.ir.statements import (
    Accumulate,
    Cholesky,
    Clear,
    Entry,
    ForEach,
    InstanceItem,
    Let,
    Map,
    MapItem,
    MatrixStore,
    MatVec,
    Pack,
    PackSource,
    Product,
    Require,
    RequireFinite,
    Requirement,
    Statement,
    Store,
    StoreElement,
    StoreLocal,
    StoreStrided,
    TriangularSolve,
    Work,
)

ZERO = Number(Fraction(0))
ROW, COLUMN, IN_BLOCK = map(variable, ("i", "j", "r"))
MAX_SUMS = 12
"""The largest number of sums in one loop: sixteen vector registers have room for these and for their operands."""


def expand(statement: Statement) -> tuple[Node, ...]:
    """A statement as plain statements, whose loops run over single modes."""
    match statement:
        case Let() | Require():
            return (statement,)
        case Store():
            return (Assign(Element(statement.output, constant(statement.index)), statement.expr),)
        case Map():
            return (*_arrays(statement), _over("i", statement.count, map(_map_item, statement.body)))
        case Accumulate():
            return _few_terms(statement) if statement.count < LANES else _sums(statement)
        case MatVec():
            return _products(statement)
        case MatrixStore():
            return _matrix_store(statement)
        case Pack():
            return tuple(_packed(statement, parity) for parity in (1, -1) if _sources(statement, parity))
        case Clear():
            element = Element(statement.output, ROW.plus(statement.first))
            return (ordered_loop("i", statement.count, [Assign(element, ZERO)]),)
        case RequireFinite(argument, count, code, text):
            return (ordered_loop("i", count, [Require(Requirement.FINITE, Element(argument, ROW), code, text)]),)
        case Work() | Entry() | StoreElement() | ForEach():
            return (_instance_item(statement),)
        case Cholesky():
            return cholesky(statement)
        case TriangularSolve():
            return (back_substitution(statement) if statement.transposed else forward_substitution(statement),)
        case _:
            assert_never(statement)


def _instance_item(item: InstanceItem) -> Node:
    """A statement over instances; its loops stay in their order unless they are independent."""
    match item:
        case Let() | Require():
            return item
        case Work():
            return Local(item.array, item.count, cleared=item.cleared, spacing=item.spacing)
        case Entry():
            return Integer(item.name, item.array, item.index)
        case StoreElement():
            return Assign(item.target, item.expr, item.operator)
        case ForEach():
            body = tuple(map(_instance_item, item.body))
            if item.backward:
                return For(item.variable, item.stop.plus(-1), item.start.plus(-1), body, step=-1)
            kind = LoopKind.INDEPENDENT if item.independent else LoopKind.ORDERED
            return For(item.variable, item.start, item.stop, body, kind, overlaps=item.independent)
        case _:
            assert_never(item)


def expand_in_tiles(statement: Statement) -> tuple[Node, ...]:
    """A statement as plain statements, with matrix-vector products in tiles of four by four for padded vectors."""
    return _tiles(statement) if isinstance(statement, MatVec) else expand(statement)


def _over(index: str, count: int, body: Iterable[Node], padded: bool = False) -> For:
    return For(index, START, constant(count), tuple(body), LoopKind.INDEPENDENT, padded=padded)


def _arrays(loop: Map) -> Iterator[Local]:
    names = dict.fromkeys(item.array for item in loop.body if isinstance(item, StoreLocal))
    return (Local(name, loop.count) for name in names)


def _map_item(item: MapItem) -> Node:
    match item:
        case Let():
            return item
        case StoreLocal():
            return Assign(Element(item.array, ROW), item.expr)
        case StoreStrided():
            return Assign(Element(item.output, variable("i", item.stride, item.offset)), item.expr)
        case _:
            assert_never(item)


def _based(base: Expr, value: Expr) -> Expr:
    return value if base == ZERO else _sum(base, value)


def _sum(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.ADD, (a, b))


def _sums(loop: Accumulate) -> tuple[Node, ...]:
    """The plain statements of sums over a loop, each accumulated in four lanes and then added up."""
    names = tuple(total.name for total in loop.sums)
    lanes = f"sums_{names[0]}"
    lane = (IndexTerm(1, "i", Of.LANE),)
    firsts = range(0, LANES * len(names), LANES)
    terms = [
        Assign(Element(lanes, ElementIndex(first, lane)), total.term, Operator.ADD)
        for first, total in zip(firsts, loop.sums, strict=True)
    ]
    return (
        Local(lanes, LANES * len(names), names, cleared=True),
        _over("i", loop.count, [*loop.lets, *terms]),
        *(Let(t.name, _based(t.base, LaneSum(lanes, first))) for first, t in zip(firsts, loop.sums, strict=True)),
    )


def _few_terms(loop: Accumulate) -> tuple[Node, ...]:
    """Sums of fewer terms than there are lanes, in straight line; a zero in front, since a sum never is -0."""
    names = {let.name for let in loop.lets}

    def term(expr: Expr, k: int) -> Expr:
        def leaf(item: Leaf) -> Expr:
            if isinstance(item, ScalarRef) and item.name in names:
                return ScalarRef(f"{item.name}_{k}")
            if isinstance(item, Element) and item.index:
                return Element(item.array, item.index.with_value("i", k))
            return item

        return mapped(expr, leaf)

    lets = (Let(f"{let.name}_{k}", term(let.expr, k)) for k in range(loop.count) for let in loop.lets)
    sums = ((total, (term(total.term, k) for k in range(loop.count))) for total in loop.sums)
    return (*lets, *(Let(total.name, _based(total.base, reduce(_sum, (ZERO, *terms)))) for total, terms in sums))


def _rounds(loop: MatVec) -> list[list[tuple[str, str, Product]]]:
    """The products of a statement: the first of each term, then the second of those that have one, and so on.

    Each has the name of the result, that of the vector it is added to, and the product. In a round, products with the
    same matrix are neighbours.
    """
    result = []
    for k in range(max((len(term.sums) for term in loop.terms), default=0)):
        present = [term for term in loop.terms if len(term.sums) > k]
        products = [(t.name, t.name if k else t.base, t.sums[k]) for t in present]
        result.append(sorted(products, key=lambda product: loop.packing.first(product[2].table)))
    return result


def _start(base: str, index: ElementIndex) -> Expr:
    return Element(base, index) if base else ZERO


def _products(loop: MatVec) -> tuple[Node, ...]:
    """Products row by row, each in a variable until it is complete."""
    packing = loop.packing
    used = {product.table for term in loop.terms for product in term.sums}
    body: list[Node] = [Alias(t, packing.array, packing.before(t)) for t in packing.tables if t in used]
    for products in _rounds(loop):
        for first in range(0, len(products), MAX_SUMS):
            together = products[first : first + MAX_SUMS]
            rows = [Accumulator(name, _start(base, ROW)) for name, base, _ in together]
            columns = (_column(row, product, packing) for row, (*_, product) in zip(rows, together, strict=True))
            body += [*rows, ordered_loop("j", packing.count, columns)]
            body += [Assign(Element(row.total, ROW), ScalarRef(row.name)) for row in rows]
    return (*(Local(term.name, packing.count) for term in loop.terms), _over("i", packing.count, body, padded=True))


def _column(row: Accumulator, product: Product, packing: Packing) -> Assign:
    """Add the product of a column of a matrix and an element of a vector."""
    entry = Element(product.table, packing.in_block(product.table))
    value = Operation(Operator.MUL, (entry, Element(product.vector, COLUMN)))
    return Assign(ScalarRef(row.name), value, Operator.ADD if product.sign > 0 else Operator.SUB)


def _tiles(loop: MatVec) -> tuple[Node, ...]:
    """Products in blocks of four rows and four columns."""
    packing = loop.packing
    size = packing.padded
    starts = (Assign(Element(term.name, IN_BLOCK), _start(term.base, IN_BLOCK)) for term in loop.terms)
    body: list[Node] = [ordered_loop("r", ROW.plus(LANES), starts, ROW)]
    for products in _rounds(loop):
        tiles = (_tile(packing, name, product) for name, _, product in products)
        body.append(For("j", START, constant(size), tuple(tiles), step=LANES))
    blocks = For("i", START, constant(size), tuple(body), step=LANES)
    return (*(Local(term.name, packing.count) for term in loop.terms), blocks)


def _tile(packing: Packing, name: str, product: Product) -> BlockProduct:
    first = packing.column(product.table).split("i", "r")
    matrix = packing.array, first, packing.stride(product.table), product.sign
    return BlockProduct(*matrix, Element(product.vector, COLUMN), Element(name, ROW))


def _matrix_store(loop: MatrixStore) -> tuple[Node, ...]:
    packing, used = loop.packing, dict[str, None]()

    def leaf(item: Leaf) -> Expr:
        if not isinstance(item, MatrixEntry):
            return item
        used[item.table] = None
        return Element(f"{item.table}_j", ElementIndex(0, (IndexTerm(1, "i", Of.LANE),)))

    target = Element(loop.output, ElementIndex(loop.offset, (IndexTerm(loop.stride, "j"), IndexTerm(1, "i"))))
    assigned = Assign(target, mapped(loop.expr, leaf))
    views = [Alias(f"{t}_j", packing.array, packing.column(t)) for t in packing.tables if t in used]
    nodes: tuple[Node, ...] = (_over("i", packing.count, [_over("j", packing.count, [*views, assigned])]),)
    if loop.diagonal is None:
        return nodes
    diagonal = Element(loop.output, variable("i", loop.stride + 1, loop.offset))
    return (*nodes, ordered_loop("i", packing.count, [Assign(diagonal, loop.diagonal, Operator.ADD)]))


def _sources(loop: Pack, parity: int) -> list[PackSource]:
    return [source for source in loop.sources if source.parity == parity]


def _packed(loop: Pack, parity: int) -> For:
    """The loop that packs both entries of each pair i <= j (or i < j) of the matrices of one parity."""
    packing, n = loop.packing, loop.packing.count
    body: list[Node] = []
    for source in _sources(loop, parity):
        index = triangle(n, parity, "i", "j").scaled(source.components, source.component)
        value = Element(source.array, index)
        upper, lower = (Element(loop.output, packing.entry(source.table, *pair)) for pair in (("i", "j"), ("j", "i")))
        body += [Assign(upper, value), Assign(lower, value, None if parity > 0 else Operator.NEG)]
    return ordered_loop("i", n, [ordered_loop("j", n, body, ROW if parity > 0 else ROW.plus(1))])
