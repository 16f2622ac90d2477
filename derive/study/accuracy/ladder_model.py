"""A model of a ladder: whether the flexible bodies of a scene are rigid, or which shapes and how many they have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from typing import Any, assert_never

from derive.spec.model.beam_parts import AssumedDeflection, FamilyKind, Frame, ShapeFamily
from derive.spec.model.body import ComponentModes, DisplacementOrder
from derive.spec.parsing import choices
from derive.spec.tables.beam import frame_from
from derive.study.table import columns
from derive.terminal import beam_count


class Shapes(Enum):
    """The kind of the shape functions of the flexible bodies: of beams, or of finite-element bodies."""

    RIGID = "rigid"
    """The flexible bodies are rigid."""
    POLYNOMIALS = "polynomials"
    """Polynomials of rising degree in a floating frame."""
    SINES = "sines"
    """Half sine waves in the chord frame: the natural modes of a beam between pins."""
    FREE_FREE = "free-free modes"
    """Natural modes of a free beam, in the mean frame."""
    CLAMPED_FREE = "clamped-free modes"
    """Natural modes of a beam that is clamped at its left end, in the tangent frame there."""
    FREE = "free modes"
    """Natural modes of a finite-element body that is free."""
    CRAIG_BAMPTON = "Craig-Bampton modes"
    """Static modes of the interface of a finite-element body, and vibrations of the body that is held there."""
    ATTACHMENT = "attachment modes"
    """Static modes of loads at the interface of a finite-element body, and free modes."""
    GIVEN = "modes of the files"
    """The modes that the files of a finite-element body contain."""


FAMILIES: dict[Shapes, tuple[FamilyKind, Frame]] = {
    Shapes.SINES: ("pinned", Frame("chord")),
    Shapes.FREE_FREE: ("free-free", Frame("mean")),
    Shapes.CLAMPED_FREE: ("clamped-free", Frame("tangent", Fraction(-1))),
}
"""The natural modes that are used as shapes, and the frame whose conditions they fulfil."""

COMPONENT_MODES: dict[Shapes, ComponentModes | None] = {
    Shapes.FREE: "free",
    Shapes.CRAIG_BAMPTON: "craig_bampton",
    Shapes.ATTACHMENT: "attachment",
    Shapes.GIVEN: None,
}
"""The modes of finite-element bodies by the kinds of `component_modes`, which modes of files have none of."""
COMPONENT_KINDS: dict[str, Shapes] = {kind: shapes for shapes, kind in COMPONENT_MODES.items() if kind is not None}
"""Computed modes of finite-element bodies by their names in a command."""
STATIC = (Shapes.CRAIG_BAMPTON, Shapes.ATTACHMENT)
"""The kinds with static modes of an interface, which their counts are beside."""

MODES = {"free-free": Shapes.FREE_FREE, "clamped-free": Shapes.CLAMPED_FREE}
"""Natural modes beside the half sine waves by their names in a command."""

ORDERS = {
    "first": DisplacementOrder.FIRST_ORDER,
    "truncated": DisplacementOrder.TRUNCATED,
    "full": DisplacementOrder.FULL,
}
"""The orders of displacements by their names in a command."""


@dataclass(frozen=True)
class LadderModel:
    """The model of the flexible bodies of a scene: the order and the kind of shapes, their number, frame, pieces.

    It is one of beams, or of finite-element bodies, and leaves bodies of the other kind as they are specified. count:
    of the shapes, in space in each plane of bending, or of the modes of a finite-element body, beside the static ones
    if there are such. torsion: the number of the shapes of torsion of beams in space; None leaves these as they are.
    beams: models of the bodies by their names, where they differ; the other fields are then those of the finest.
    of_scene: the name of the scene, where one with another name has the same model.
    """

    shapes: Shapes
    count: int = 0
    order: DisplacementOrder = DisplacementOrder.FIRST_ORDER
    frame: str = "mean"
    pieces: int = 1
    beams: tuple[tuple[str, LadderModel], ...] = ()
    torsion: int | None = None
    of_scene: str = ""

    def of(self, beam: str) -> LadderModel:
        """The model of a beam."""
        return dict(self.beams).get(beam, self)

    @property
    def size(self) -> int:
        """The coordinates of a beam without its joints; a rigid one counts as none."""
        return self.pieces * (3 * (self.count > 0) + self.count)

    @property
    def kind(self) -> tuple[object, ...]:
        """The key that models share of which one has the shapes of the other and more."""
        return self.shapes, self.order, self.frame, self.pieces, self.torsion

    @property
    def label(self) -> str:
        """The text of the model: 2 beams, P2 to P4, full; crank: rigid; rod: 1 sine, first."""
        return f"{self.of_scene}: {self._label}" if self.of_scene else self._label

    @property
    def _label(self) -> str:
        if self.beams:
            groups: dict[str, list[str]] = {}
            for name, model in self.beams:
                groups.setdefault(model.label, []).append(name)
            return "; ".join(f"{', '.join(names)}: {label}" for label, names in groups.items())
        match self.shapes:
            case Shapes.RIGID:
                return "rigid"
            case Shapes.SINES:
                text = f"{self.count} sine{'s' * (self.count > 1)}"
            case Shapes.FREE_FREE | Shapes.CLAMPED_FREE:
                text = f"{self.count} {self.shapes.value if self.count > 1 else self.shapes.value.removesuffix('s')}"
            case Shapes.POLYNOMIALS:
                text = f"{beam_count(self.pieces)}, {self._polynomials}"
                text += f", {self.frame}" if self.frame != "mean" else ""
            case Shapes.FREE | Shapes.GIVEN:
                noun = self.shapes.value if self.count > 1 else self.shapes.value.replace("modes", "mode")
                text = f"{self.count} {noun}"
            case Shapes.CRAIG_BAMPTON | Shapes.ATTACHMENT:
                static = self.shapes.value.removesuffix(" modes")
                text = f"{static} + {self.count or 'no'} vibration{'s' * (self.count > 1)}"
            case _ as never:
                assert_never(never)
        if self.torsion is not None:
            text += f", {self.torsion or 'no'} twist{'s' * (self.torsion > 1)}"
        if self.shapes in COMPONENT_MODES and self.order is DisplacementOrder.FIRST_ORDER:
            return text
        return f"{text}, {next(name for name, order in ORDERS.items() if order is self.order)}"

    @property
    def _polynomials(self) -> str:
        """The text of polynomials: P2 to P4 in the mean frame (Legendre polynomials), elsewhere their number."""
        if self.frame != "mean":
            return f"{self.count} shapes"
        names = [f"P{n}" for n in (2, self.count + 1)]
        return names[0] if self.count == 1 else ", ".join(names) if self.count == 2 else " to ".join(names)


MODEL_COLUMNS = columns("model", "order", "shapes", "number_of_shapes", "beams", "frame")
"""The columns of the tables of ladders that describe a model."""


def model_row(model: LadderModel, label: str) -> tuple[Any, ...]:
    """The values of `MODEL_COLUMNS`, with the text that names the model."""
    return label, model.order.value, model.shapes.value, model.count, model.pieces, model.frame


def mixed(beams: Mapping[str, LadderModel]) -> LadderModel:
    """The model of a scene with the given models of the beams, by their names."""
    models = tuple(beams.values())
    if all(model == models[0] for model in models):
        return models[0]
    return replace(max(models, key=lambda m: m.size), beams=tuple(beams.items()))


def deflection_of(model: LadderModel) -> AssumedDeflection:
    """The assumed deflection of beams with a model."""
    if model.shapes in FAMILIES:
        family, frame = FAMILIES[model.shapes]
        return AssumedDeflection(ShapeFamily(family, model.count), frame)
    frame = _frame(model.frame)
    ansatz = tuple(tuple(Fraction(int(i == n)) for i in range(n + 1)) for n in range(model.count + 2))
    return AssumedDeflection(ansatz, frame, orthogonal=frame.kind == "mean")


def _frame(name: str) -> Frame:
    """A frame by its name in a command; a tangent frame is at the left end."""
    kind = choices.frame_kind(name)
    return frame_from(kind, Fraction(-1) if kind == "tangent" else None)
