"""The description of a mechanism for users of the generated code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from derive.mechanics.multibody.bodies.registry import BODIES
from derive.spec.model.instances import instance_parts, skeleton, text_of_instances
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.multibody.kinds import BodyInstance
    from derive.mechanics.terms import Constraint, Coordinate

BETWEEN_BODIES = "the mass matrix is block-diagonal, because joints couple bodies through constraints"


def frame_doc(instances: Sequence[BodyInstance], scene: Scene, by_table: bool = False) -> str:
    """The description of the frames of the bodies for users of the generated code.

    by_table: one for all instances of a table.
    """
    groups = Counter(instance.component.group for instance in instances)
    firsts: dict[str, str] = {}
    for instance in instances:
        firsts.setdefault(instance.component.group, instance.name)
    cut = [first for group, first in firsts.items() if groups[group] > 1]
    alike = f" The statements about {', '.join(cut)} hold for the other pieces as well." if cut else ""
    centre = "For beams, c is the position of the centre of the undeformed beam."
    texts = _notes_by_table(scene) if by_table else (BODIES[body.kind].note(body) for body in scene.bodies)
    notes = "".join(f"\n{text}" for text in texts if text)
    return f"{centre}{notes}\nFor several bodies {BETWEEN_BODIES}.{alike}"


def _notes_by_table(scene: Scene) -> Iterator[str]:
    """The notes on the bodies; on alike instances of a table one, with the index i in it."""
    notes = [(instance_parts(body.name), BODIES[body.kind].note(body)) for body in scene.bodies]
    for (table, _), group in groupby(notes, key=lambda note: (note[0].table, skeleton(note[1]))):
        of_table = list(group)
        texts = [text for _, text in of_table]
        yield from [text_of_instances(texts, of_table[0][0].index or 0)] if table else texts


def mechanism_doc(scene: Scene, coordinates: tuple[Coordinate, ...], conditions: tuple[Constraint, ...]) -> str:
    """A line that summarises what a mechanism consists of."""
    return (
        f"scene of {count_text(scene.bodies, 'planar bod', 'y', 'ies')}: {count_text(coordinates, 'coordinate')}, "
        f"{count_text(conditions, 'constraint')}, {count_text(coordinates[len(conditions) :], 'degree')} of freedom"
    )


def count_text(things: Sequence[object], noun: str, singular: str = "", plural: str = "s") -> str:
    """The number of things with their noun, which has one of two endings."""
    return f"{len(things)} {noun}{singular if len(things) == 1 else plural}"
