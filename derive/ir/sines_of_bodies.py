"""Sines and cosines of the angles of all bodies before the loops over these, where angles lie at equal distances.

Bodies at the ends of chains have loops of their own; with sines in each of them, compilers take as long for these as
for the rest of a body. One call computes those of all bodies, several at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace

from derive.ir.analysis import names_read
from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import LANES, ElementIndex, Of, constant
from derive.ir.loop_nests import Assign, For, If, Integer, Local, Node, Sines, every
from derive.ir.statements import Let

LEAST = 2
"""The angles that are worth a call."""
MANY, STORES = 24, 50
"""Loops over as many bodies that store as many numbers of each wait for their memory, and compute sines meanwhile.

So do loops in lanes, which compute several sines at a time anyway. With its sines before the loop, the Jacobian of a
chain of 100 beams took up to 8 % longer, that of ten 20 % less; accelerations of 1000 beams took 9 % longer.
"""

CIRCULAR = (Operator.SIN, Operator.COS)

Part = tuple[Node, ...]
"""The plain statements of a statement of a section."""


@dataclass(frozen=True)
class _Angles:
    """Some elements of an array at equal distances."""

    array: str
    first: int
    stride: int
    count: int

    def joined(self, other: _Angles) -> _Angles | None:
        """These angles and others, which begin later, if all of them lie at equal distances."""
        distance = other.first - self.first
        stride = self.stride if self.count > 1 else distance or other.stride
        if self.array != other.array or (other.count > 1 and other.stride != stride):
            return None
        if distance % stride or distance > stride * self.count:
            return None
        return replace(self, stride=stride, count=max(self.count, distance // stride + other.count))

    def has(self, other: _Angles) -> bool:
        """Whether the others are among these."""
        place, rest = divmod(other.first - self.first, self.stride)
        aligned = not rest and (other.count == 1 or other.stride == self.stride)
        return self.array == other.array and aligned and 0 <= place <= self.count - other.count

    def result(self, kind: Operator, index: ElementIndex) -> Element:
        """The sine or the cosine of the angle at an index."""
        terms = tuple(replace(term, stride=term.stride // self.stride) for term in index.terms)
        return Element(self._results(kind), ElementIndex((index.offset - self.first) // self.stride, terms))

    def _results(self, kind: Operator) -> str:
        return f"{kind.value}_{self.array}_{self.first}_{self.stride}_{self.count}"

    @property
    def nodes(self) -> Part:
        """The statements that compute the sines and cosines."""
        sine, cosine = (self._results(kind) for kind in (Operator.SIN, Operator.COS))
        angle = Element(self.array, constant(self.first))
        return Local(sine, self.count), Local(cosine, self.count), Sines(angle, sine, cosine, self.count, self.stride)


def with_sines_of_bodies(parts: Sequence[Part]) -> list[Part]:
    """The statements of a section, in which sines come before the first loop that reads them."""
    lines = every(node for part in parts for node in part)
    written = {n.target.array for n in lines if isinstance(n, Assign) and isinstance(n.target, Element)}
    named = [[_angles(node, written) for node in part] for part in parts]
    alone = {of for part, own in zip(parts, named, strict=True) for of in _in_one_block(part, own)}
    joined = _joined(angles for part in named for own in part for angles in own.values())
    known = [angles for angles in joined if angles.count >= LEAST and angles not in alone]
    computed: set[_Angles] = set()
    result: list[Part] = []
    for part, names in zip(parts, named, strict=True):
        nodes: list[Node] = []
        for node, own in zip(part, names, strict=True):
            used = {name: of for name, angles in own.items() for of in known if of.has(angles)}
            nodes += (item for of in dict.fromkeys(used.values()) if of not in computed for item in of.nodes)
            nodes.append(_with_elements(node, used) if isinstance(node, For) and used else _of_one(node, written))
            computed |= {*used.values()}
        result.append(tuple(nodes))
    return result


def _angles(loop: Node, written: Set[str]) -> dict[str, _Angles]:
    """The angles in all iterations of a loop, by the names of their sines and cosines; written: arrays that change."""
    if not isinstance(loop, For) or not loop.count or _waits(loop):
        return {}
    lets = {node.name: node.expr for node in every(loop.body) if isinstance(node, Let)}
    result: dict[str, _Angles] = {}
    for name, expr in lets.items():
        angle = _angle(expr, lets)
        index = angle.index if angle else None
        if angle and index and angle.array not in written and _counts(index, loop):
            places = sorted({index.at({loop.variable: value}) for value in loop.values({})})
            stride = abs(index.stride(loop.variable) * loop.step) or 1
            result[name] = _Angles(angle.array, places[0], stride, len(places))
    return result


def _of_one(loop: Node, written: Set[str]) -> Node:
    """A loop over one instance, whose number is an argument, with one call for the sine and the cosine of an angle."""
    if not isinstance(loop, For) or not loop.start.terms or loop.stop != loop.start.plus(1):
        return loop
    lets = {node.name: node.expr for node in loop.body if isinstance(node, Let)}
    named = {name: angle for name, expr in lets.items() if (angle := _angle(expr, lets))}
    angles = [angle for angle in dict.fromkeys(named.values()) if angle.index and angle.array not in written]
    results = {angle: {kind: f"{kind.value}_{k}" for kind in CIRCULAR} for k, angle in enumerate(angles)}
    calls: list[Node] = []
    for angle, names in results.items():
        calls += (Local(name, 1) for name in names.values())
        calls.append(Sines(angle, names[Operator.SIN], names[Operator.COS], 1, 1))
    body = [
        Let(node.name, Element(results[named[node.name]][node.expr.kind], constant(0)))
        if isinstance(node, Let) and isinstance(node.expr, Operation) and named.get(node.name) in results
        else node
        for node in loop.body
    ]
    read = {*names_read(body)}
    integers = [node for node in body if isinstance(node, Integer)]  # which may place the angles
    kept = (n for n in body if not isinstance(n, Integer) and (not isinstance(n, Let) or n.name in read))
    return replace(loop, body=(*integers, *calls, *kept))


def _waits(loop: For) -> bool:
    """Whether a loop is one in lanes, or stores so much that it waits for its memory."""
    stores = sum(isinstance(node, Assign) for node in every(loop.body))
    return (loop.count or 0) >= MANY and (loop.overlaps or stores >= STORES)


def _angle(expr: Expr | None, lets: Mapping[str, Expr]) -> Element | None:
    """The element of which an expression is the sine or the cosine."""
    match expr:
        case Operation(Operator.SIN | Operator.COS, (ScalarRef(name),)):
            angle = lets.get(name)
        case Operation(Operator.SIN | Operator.COS, (angle,)):
            pass
        case _:
            return None
    return angle if isinstance(angle, Element) else None


def _counts(index: ElementIndex, loop: For) -> bool:
    """Whether an index counts from the variable of a loop alone."""
    return all(term.variable == loop.variable and term.of is Of.VALUE for term in index.terms)


def _in_one_block(part: Part, named: Sequence[Mapping[str, _Angles]]) -> Iterator[_Angles]:
    """The angles of loops over so few bodies that these are in the lanes of one vector, and so are their sines."""
    for node, own in zip(part, named, strict=True):
        if isinstance(node, For) and node.overlaps and 1 < (node.count or 0) <= LANES:
            yield from own.values()


def _joined(every_angle: Iterable[_Angles]) -> list[_Angles]:
    """Angles with those that continue them."""
    result: list[_Angles] = []
    for angles in sorted(set(every_angle), key=lambda of: (of.array, of.first, -of.count)):
        joined = result[-1].joined(angles) if result else None
        result[len(result) - bool(joined) :] = [joined or angles]
    return result


def _with_elements(loop: For, used: Mapping[str, _Angles]) -> For:
    """A loop with elements of arrays as some sines and cosines, and without angles that nothing reads then."""
    lets = {node.name: node.expr for node in every(loop.body) if isinstance(node, Let)}

    def changed(node: Node) -> Node:
        match node:
            case Let(name, Operation(kind)) if name in used:
                angle = _angle(node.expr, lets)
                assert angle and angle.index
                return Let(name, used[name].result(kind, angle.index))
            case If():
                return replace(node, then=tuple(map(changed, node.then)), otherwise=tuple(map(changed, node.otherwise)))
            case For():
                return replace(node, body=tuple(map(changed, node.body)))
            case _:
                return node

    result = changed(loop)
    assert isinstance(result, For)
    read = {*names_read([result])}
    angles = {*names_read(Let(name, lets[name]) for name in used)}
    return replace(result, body=tuple(n for n in result.body if not (isinstance(n, Let) and n.name in angles - read)))
