"""Loads where their first reader is, so that compilers need not keep what is read from memory anyway.

gcc keeps the order of a long straight line: what is loaded at its beginning and read more than once goes to the stack
in between. All operations stay as they were, and so do the bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from derive.ir.accesses import are_apart
from derive.ir.analysis import names_read
from derive.ir.expressions import Element, Ends
from derive.ir.loop_nests import Assign, BlockProduct, For, Node, Sines, every
from derive.ir.statements import Let


def with_late_loads(lines: Iterable[Node]) -> tuple[Node, ...]:
    """Lines in which each name of an element is behind those that neither read it nor write to the element."""
    waiting: dict[str, Let] = {}
    return tuple(line for node in lines for line in (*_due(node, waiting), *_kept(node, waiting)))


def _kept(node: Node, waiting: dict[str, Let]) -> Iterator[Node]:
    """A line, unless it waits for its reader from now on."""
    if isinstance(node, Let) and isinstance(node.expr, Element | Ends):
        waiting[node.name] = node
    else:
        yield replace(node, body=with_late_loads(node.body)) if isinstance(node, For) else node


def _due(node: Node, waiting: dict[str, Let]) -> Iterator[Node]:
    """The loads that have to precede a line."""
    read = dict.fromkeys(names_read([node]))
    written = tuple(_written(node))
    met = [name for name, load in waiting.items() if any(_may_change(load.expr, of) for of in written)]
    for name in (*(name for name in read if name in waiting), *met):
        if name in waiting:
            yield waiting.pop(name)


def _written(node: Node) -> Iterator[object]:
    """The values that a line writes, also in its body."""
    for line in every([node]):
        match line:
            case Assign(target=target) | BlockProduct(target=target):
                yield target
            case Sines():
                yield from (Element(array, None) for array in (line.sine, line.cosine))
            case _:
                pass


def _may_change(loaded: object, written: object) -> bool:
    """Whether what is loaded may be what is written."""
    if not isinstance(loaded, Element | Ends) or not isinstance(written, Element | Ends):
        return False
    if isinstance(loaded, Element) and isinstance(written, Element):
        return not are_apart(loaded, written)
    return loaded.array == written.array
