"""Parts of loops as C: heads, declarations of arrays, addresses, and where vectors begin."""

from __future__ import annotations

from collections.abc import Container, Iterable

from derive.backends.expression_text import index_text
from derive.backends.source_map import SourceLine
from derive.backends.wrapping import WIDTH
from derive.ir.expressions import Element, Ends, Expr, walk
from derive.ir.indices import LANE, LANES, ElementIndex, Of
from derive.ir.library_calls import STATE
from derive.ir.loop_nests import Assign, For, Local, LoopKind, Node, every, expressions_of

Lines = list[SourceLine]

SHORT = 16
"""Iterations that gcc unrolls completely before it makes vectors."""


def vector_starts(nodes: Iterable[Node], whole: Container[str] = ()) -> dict[str, int]:
    """The elements from which on vectors are stored in local arrays that may be aligned.

    whole: the arrays in which fewer instances than lanes store vectors, see `filled_by_few`. A vector that is aligned
    does not cross the lines that caches exchange; storing to two of them takes twice the time.
    """
    nodes = tuple(every(nodes))
    may = {node.array for node in nodes if isinstance(node, Local) and (node.spacing or node.in_lanes)}
    starts = dict[str, int]()
    for loop in nodes:
        for node in every(loop.body) if isinstance(loop, For) and loop.kind in (LoopKind.LANES, LoopKind.FEW) else ():
            if isinstance(node, Assign) and isinstance(node.target, Element) and node.target.array in may:
                assert node.target.index
                is_whole = isinstance(loop, For) and (loop.kind is LoopKind.LANES or node.target.array in whole)
                if node.target.index.stride(LANE) == 1 and is_whole:
                    starts.setdefault(node.target.array, node.target.index.offset)
    return starts


def filled_by_few(nodes: Iterable[Node]) -> set[str]:
    """The local arrays with room for all lanes that only loops of fewer instances than lanes fill.

    A vector of all lanes then takes one store in place of three; lanes that are left repeat the last instance.
    """
    nodes = tuple(every(nodes))
    room = {
        node.array
        for node in nodes
        if isinstance(node, Local) and (node.in_lanes or (node.spacing and not node.cleared))
    }
    few = [node for loop in nodes if isinstance(loop, For) and loop.kind is LoopKind.FEW for node in every(loop.body)]
    whole = {id(node) for node in few if isinstance(node, Assign) and _begins_a_vector(node.target)}
    others = {
        node.target.array
        for node in nodes
        if isinstance(node, Assign) and isinstance(node.target, Element | Ends) and id(node) not in whole
    }
    read = (part for node in few for expr in expressions_of(node) for part in walk(expr) if isinstance(part, Element))
    return room - others - {part.array for part in read if not _begins_a_vector(part)}


def _begins_a_vector(element: Expr) -> bool:
    """Whether the element for the first lane is the first one of a vector of an array without gaps."""
    if not isinstance(element, Element) or not element.index:
        return False
    index = element.index
    alone = [term for term in index.terms if term.stride == 1 and term.of is Of.VALUE]
    others = [term for term in index.terms if term not in alone]
    apart = index.offset % LANES == 0 and all(term.stride % LANES == 0 for term in others)
    return apart and len(alone) <= 2 and LANE in {term.variable for term in alone}


def declarations(arrays: Iterable[str]) -> list[str]:
    """Declarations of arrays, on as few lines as possible."""
    lines: list[str] = []
    for name in arrays:
        if lines and len(lines[-1]) + len(name) + 3 <= WIDTH:
            lines[-1] = f"{lines[-1][:-1]}, {name};"
        else:
            lines.append(f"    double {name};")
    return lines


def loop_head(node: For, counter: str, short: bool) -> str:
    """The head of a loop; see the macros for the pragma before a short loop."""
    i, start, stop = node.variable, index_text(node.start, False), index_text(node.stop, False)
    if node.step < 0:
        return f"for ({counter} {i} = {start}; {i} >= {index_text(node.stop.plus(1), False)}; {i}--) {{"
    if last_block(node) is not None:
        i = block_name(i)
    step = f"{i}++" if node.step == 1 else f"{i} += {node.step}"
    vectors = any(isinstance(item, For) and item.variable in (LANE, STATE) for item in node.body)
    pragma = short and not vectors and node.step == 1 and 1 < (node.count or 2) <= SHORT
    return f"{'TISSERAND_SHORT ' if pragma else ''}for ({counter} {i} = {start}; {i} < {stop}; {step}) {{"


def last_block(node: For) -> int | None:
    """The beginning of the last block of a loop, if it overlaps the one before, so that it ends at the end of the loop.

    A branch that shortens the step before this block is predicted wrongly each time: three loops over the bodies of a
    chain of ten took 0.14 us longer.
    """
    if not node.overlaps or (node.stop.offset - node.start.offset) % node.step == 0:
        return None
    return node.stop.offset - node.step


def block_name(variable: str) -> str:
    """The name of the variable of the blocks of a loop, of which the last one begins earlier."""
    return f"{variable}_block"


def address_text(array: str, index: ElementIndex | None) -> str:
    """The address of an element."""
    return f"{array} + {index_text(index)}" if index and (index.offset or index.terms) else array


def row_distance(index: ElementIndex | None) -> str:
    """The distance of a row of states from the first one, as the first part of an index; "" if there is none."""
    assert index is not None
    if not index.terms and index.offset < 2:
        return ("", "all")[index.offset]
    count = index_text(index)
    return f"({count}) * all" if len(index.terms) + bool(index.offset) > 1 else f"{count} * all"


def indented(lines: Iterable[SourceLine]) -> Lines:
    """Lines in the body of a loop."""
    return [line.indented() for line in lines]
