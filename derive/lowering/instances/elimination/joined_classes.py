"""Bodies at the ends of chains, which join the class of those between, where four bodies are in the lanes of a vector.

A body with fewer joints, or with joints that remove fewer motions, is one of a class of bodies that have more of them
if what it computes too much is dropped: its rows of joints that it does not have go to places that nothing reads, and
what it writes to rows that its joints do not have is nothing beside the large number that gets their diagonals. The
reactions of these rows are zero, or 1e-50 of others. A vector takes about as long as a body alone, so that four bodies
of a chain take the time of one, and not of three.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations, pairwise

from derive.ir.indices import LANES, padded
from derive.lowering.instances.classes.body_classes import (
    NO_JOINT,
    BodyClass,
    Handle,
    Member,
    body_key,
    force_keys,
    with_forces,
)
from derive.lowering.instances.classes.dimension import AnyJoint, plain_joint
from derive.lowering.instances.classes.gears import gears_of
from derive.lowering.instances.classes.varying_joints import varies
from derive.lowering.instances.elimination.block_system import (
    COUPLING,
    DIAGONAL,
    FEW,
    FLOOR,
    RIGHT,
    Blocks,
    packed,
)
from derive.mechanics.multibody.joints.relative_rows import Axes
from derive.mechanics.multibody.space.joints import SpatialJointInstance
from derive.mechanics.multibody.space.mechanism import AnyMechanism

BODY = 20
"""The work of a body without joints, in entries of the blocks of the joints."""
WORTH = 1.02
"""The work for which a class less, whose text compilers need not read, is worth it, divided by the least work.

One vector more is hidden among many: where it was 2 % of the work, chains took .6 to .9 % longer.
"""
MOST = 4
"""The most classes that may join another one, of which all selections are compared."""


def joined_classes(
    mechanism: AnyMechanism, classes: Sequence[BodyClass], system: Blocks | None
) -> tuple[BodyClass, ...]:
    """The classes of bodies in lanes: those given, and in place of some the class that they have joined."""
    result = tuple(classes)
    if system is None or system.adds or gears_of(mechanism) or any(map(_needs_class, mechanism.joints)):
        return result
    if any(len(elements) > FEW for elements in system.left().values()):
        return result  # bodies would compute many rows that joints do not have
    for larger in classes:
        if any(of is larger for of in result):
            result = _with_smaller(mechanism, result, larger, system)
    return result


def written_too_much(of: BodyClass, handles: Sequence[Sequence[int]], system: Blocks) -> Iterator[tuple[str, int]]:
    """The elements of the system that a joined class writes, by array and index, also of rows that joints do not have.

    handles: the rows of the class by its handles.
    """
    size, spacing = system.size, system.spacing
    rows = [range(len(own)) for own in handles]
    for member in of.members if of.is_joined else ():
        places = [system.place(handle.joint) for handle in member.handles]
        for place, own, handle in zip(places, rows, member.handles, strict=True):
            side = 0 if handle.is_first else 1
            yield from ((DIAGONAL[side], packed(size, i, j) * spacing + place) for i in own for j in own)
            yield from ((array[side], i * spacing + place) for array in (RIGHT, FLOOR) for i in own)
        for pair in combinations(range(len(places)), 2):
            a, b = sorted(pair, key=places.__getitem__)
            block, between = system.block(places[a], places[b]), system.coupling_spacing
            yield from ((COUPLING, (size * i + j) * between + block) for i in rows[a] for j in rows[b])


def _needs_class(joint: AnyJoint) -> bool:
    """Whether the bodies of a joint that varies join no others: in the plane, or where a drive turns it."""
    return varies(joint) and not (isinstance(joint, SpatialJointInstance) and joint.drive is None)


def _with_smaller(
    mechanism: AnyMechanism, classes: tuple[BodyClass, ...], larger: BodyClass, system: Blocks
) -> tuple[BodyClass, ...]:
    """The classes after some have joined one of them, if this takes less, or little more with fewer classes."""
    smaller = [
        (of, members)
        for of in classes
        if of is not larger and (members := _as_members(mechanism, of, larger)) is not None
    ][:MOST]
    options = [(_work(mechanism, classes), classes)]
    for number in range(1, len(smaller) + 1):
        for chosen in combinations(smaller, number):
            joined = _joined(larger, [members for _, members in chosen])
            gone = [of for of, _ in chosen]
            others = tuple(joined if of is larger else of for of in classes if all(of is not other for other in gone))
            if _is_spaced(joined, larger, system):
                options.append((_work(mechanism, others), others))
    most = WORTH * min(work for work, _ in options)
    return min((o for o in options if o[0] <= most), key=lambda option: (len(option[1]), option[0]))[1]


def _work(mechanism: AnyMechanism, classes: Iterable[BodyClass]) -> int:
    """The work of the loops over some classes in lanes, in entries of the blocks of the joints."""
    total = 0
    for of in classes:
        rows = sum(mechanism.joints[h.joint].multipliers for h in of.first.handles)
        total += padded(len(of.members)) // LANES * (BODY + rows + rows * (rows + 1) // 2)
    return total


def _as_members(mechanism: AnyMechanism, smaller: BodyClass, larger: BodyClass) -> tuple[Member, ...] | None:
    """The bodies of a class as members of another one; None if they have what the bodies of that one have not."""
    first, own = larger.first, smaller.first
    if force_keys(first) != force_keys(own) or body_key(first) != body_key(own) or first.instance.coordinates.reason:
        return None
    numbers: list[int] = []
    for handle in own.handles:  # of the joints that are left the one with the fewest rows, so that others find theirs
        left = (k for k in range(len(first.handles)) if k not in numbers and _fits(mechanism, handle, larger, k))
        number = min(left, key=lambda k: mechanism.joints[first.handles[k].joint].multipliers, default=None)
        if number is None:
            return None
        numbers.append(number)
    return tuple(_member(member, first.handles, numbers) for member in smaller.members)


def _fits(mechanism: AnyMechanism, handle: Handle, larger: BodyClass, number: int) -> bool:
    """Whether the rows of a joint are the first ones of that at a handle of a class; all of varying ones."""
    other = larger.first.handles[number]
    here, there = mechanism.joints[handle.joint], mechanism.joints[other.joint]
    vary = larger.along_first or varies(here) or varies(there)
    return (
        (handle.is_first, handle.marker) == (other.is_first, other.marker)
        and (not vary or plain_joint(here) == plain_joint(there))
        and _axes(here) is _axes(there)
        and _rows(here) == _rows(there)[: here.multipliers]
    )


def _axes(joint: AnyJoint) -> Axes | None:
    """The axes of the displacements that a joint in the plane removes."""
    return None if isinstance(joint, SpatialJointInstance) else joint.type.axes


def _rows(joint: AnyJoint) -> list[tuple[object, ...]]:
    """The rows that a joint removes or drives, with the values of the keys that they depend on."""
    if isinstance(joint, SpatialJointInstance):
        return [(row,) for row in joint.rows]
    rows = [*joint.type.removes, *([joint.type.driven] if joint.drive else ())]
    keys = joint.type.axes.keys
    return [(row, *(getattr(joint.joint, key.name) for key in (*keys, *row.keys))) for row in rows if row]


def _member(member: Member, handles: Sequence[Handle], numbers: Sequence[int]) -> Member:
    own = dict(zip(numbers, member.handles, strict=True))
    absent = (replace(handle, joint=NO_JOINT) for handle in handles)
    return replace(member, handles=tuple(own.get(number, handle) for number, handle in enumerate(absent)))


def _joined(larger: BodyClass, smaller: Iterable[Sequence[Member]]) -> BodyClass:
    """A class with the members of others, in the order of the mechanism."""
    every = (*larger.members, *(member for of in smaller for member in of))
    members = with_forces(sorted(every, key=lambda member: member.number))
    leading = next(k for k, member in enumerate(members) if member.number == larger.first.number)
    return replace(larger, members=members, leading=leading, is_joined=True)


def _is_spaced(joined: BodyClass, larger: BodyClass, system: Blocks) -> bool:
    """Whether the places of the bodies are equally spaced, besides those that are not in the class by itself."""
    both = zip(_places(larger, system), _places(joined, system), strict=True)
    return all(_equally(after) or not _equally(before) for before, after in both)


def _places(of: BodyClass, system: Blocks) -> Iterator[list[int]]:
    """The first coordinates of the bodies, the places of their joints, and the blocks of pairs of these."""
    yield [member.coordinate for member in of.members]
    joints = [[system.place(handle.joint) for handle in member.handles] for member in of.members]
    yield from map(list, zip(*joints, strict=True))
    for a, b in combinations(range(len(of.first.handles)), 2):
        yield [system.block(own[a], own[b]) for own in joints]
        yield [own[a] > own[b] for own in joints if system.joints not in own]


def _equally(numbers: Sequence[int]) -> bool:
    """Whether the differences of successive numbers are equal."""
    return len({after - before for before, after in pairwise(numbers)}) < 2
