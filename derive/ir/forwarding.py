"""Values of ordered loops that stay in registers: what a body stores and reads again gets a name there.

Elements of local arrays that nothing else reads are not stored.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from derive.ir.accesses import accesses_of, are_apart, iterations
from derive.ir.analysis import names_read
from derive.ir.expressions import Element, ScalarRef, mapped, walk
from derive.ir.loop_nests import Assign, For, Local, Node, every, expressions_of
from derive.ir.statements import Let, Require


def forwarded(loop: For) -> For:
    """An ordered loop with names in place of elements that its body has written before."""
    later = set(_elements(loop.body))
    known: dict[Element, ScalarRef] = {}
    body: list[Node] = []
    for number, item in enumerate(loop.body):
        line = _with_values(item, known)
        if isinstance(line, Assign) and isinstance(line.target, Element):
            target = line.target
            known = {element: value for element, value in known.items() if are_apart(element, target)}
            if line.operator is None and target in later:
                name = line.expr if isinstance(line.expr, ScalarRef) else ScalarRef(f"stored_{number}")
                body += [Let(name.name, line.expr)] if name != line.expr else []
                line, known[target] = replace(line, expr=name), name
        body.append(line)
    return replace(loop, body=tuple(body))


def _elements(lines: Iterable[Node]) -> Iterator[Element]:
    """The elements that lines read."""
    parts = (part for line in lines for expr in expressions_of(line) for part in walk(expr))
    return (part for part in parts if isinstance(part, Element))


def _with_values(line: Node, known: Mapping[Element, ScalarRef]) -> Let | Assign | Require:
    assert isinstance(line, Let | Assign | Require)
    return replace(line, expr=mapped(line.expr, lambda e: known.get(e, e) if isinstance(e, Element) else e))


def without_idle_stores(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Plain statements without the elements of local arrays that loops write and nothing reads."""
    arrays = {node.array for node in nodes if isinstance(node, Local)}
    read = {
        (a.array, a.first + a.stride * step)
        for node in nodes
        for a in accesses_of(node)
        if not a.writes
        for step in range(iterations(node))
    }

    def is_read(loop: For, target: Element) -> bool:
        assert target.index
        variables = ({loop.variable: value} for value in loop.values({}))
        return any((target.array, target.index.at(values)) in read for values in variables)

    def kept(loop: For) -> For:
        overwritten: list[Element] = []
        body: list[Node] = []
        for line in reversed(loop.body):
            if isinstance(line, Assign) and isinstance(line.target, Element) and line.target.array in arrays:
                if line.operator is None and (line.target in overwritten or not is_read(loop, line.target)):
                    continue
                overwritten.append(line.target)
            read_here = tuple(_elements([line]))
            overwritten = [e for e in overwritten if all(are_apart(e, part) for part in read_here)]
            body.insert(0, line)
        return replace(loop, body=tuple(body))

    return tuple(kept(node) if isinstance(node, For) else node for node in nodes)


def without_unread_arrays(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Plain statements without local arrays that are written, or added to, and never read."""
    arrays = {node.array for node in nodes if isinstance(node, Local)}
    idle = arrays - {element.array for element in _elements(every(nodes))}

    def kept(node: Node) -> bool:
        target = node.target if isinstance(node, Assign) else None
        return not (isinstance(target, Element) and target.array in idle)

    result = (replace(n, body=tuple(filter(kept, n.body))) if isinstance(n, For) else n for n in nodes)
    return tuple(n for n in result if kept(n) and not (isinstance(n, Local) and n.array in idle))


def without_unread_values(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Plain statements without the values of loops that nothing reads, since their stores are gone."""

    def kept(loop: For) -> For:
        read: set[str] = set()
        body: list[Node] = []
        for line in reversed(loop.body):
            if not isinstance(line, Let) or line.name in read:
                read.update(names_read([line]))
                body.insert(0, line)
        return replace(loop, body=tuple(body))

    return tuple(kept(node) if isinstance(node, For) else node for node in nodes)
