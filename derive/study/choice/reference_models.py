"""The models that references are made of, and those that they are compared with: each body with models of its kind.

The directions in which a reference may be too coarse are pieces of beams, shapes or modes, the kind of component modes
of finite-element bodies, and truncation.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import COMPONENT_MODES, LadderModel, Shapes, mixed
from derive.study.accuracy.modelled_bodies import Flexible, flexible_members
from derive.study.choice.modes_of_bodies import ModesOfBodies

FLEXIBLE = LadderModel(Shapes.POLYNOMIALS, 3, DisplacementOrder.TRUNCATED)
"""The flexible model of a beam that is examined first, and that references need as well."""
FIRST = replace(FLEXIBLE, pieces=2)
"""The model of a beam in the reference that is tried first."""
MOST_BEAMS, MOST_SHAPES = 8, 5
"""The largest numbers of pieces of each beam, and of shapes of each piece, of references."""
FULL_SHAPES = 2
"""The number of shapes of full models: the terms that truncation drops are largest in the lowest shapes."""
TWISTS = 2
"""The number of shapes of torsion of the reference that is tried first, of beams that twist."""
MODES, MORE_MODES = 6, 4
"""The modes of a finite-element body, beside static ones, in the reference that is tried first, and how many more finer
ones have: modes of bending come in pairs."""
OF_INTERFACE = {Shapes.CRAIG_BAMPTON: Shapes.ATTACHMENT}
"""The kinds of component modes that references have and are compared with: they converge alike, from other shapes."""


@dataclass(frozen=True)
class CoarserModels:
    """A direction in which a reference may be too coarse, and the coarser models that show it.

    label: of the coarser models. coarser: of a model, or None where a scene has no such. beams: whether more pieces of
    beams refine it.
    """

    label: str
    coarser: Callable[[LadderModel], LadderModel | None]
    beams: bool = False


class ReferenceModels:
    """The models that references of a scene are made of. modes: those that its finite-element bodies can have."""

    def __init__(self, scene: AnyScene) -> None:
        self._bodies, self.modes = flexible_members(scene), ModesOfBodies(scene)
        self._nodal = [body for body in self._bodies if isinstance(body, FlexibleBody)]
        self._beams = len(self._nodal) < len(self._bodies)

    @property
    def flexible(self) -> LadderModel:
        """The flexible model that is examined first, and that references need as well."""
        return self._each(lambda body: self._first(body, FLEXIBLE))

    @property
    def first(self) -> LadderModel:
        """The model of the reference that is tried first."""
        return self._each(lambda body: self._first(body, FIRST))

    @property
    def directions(self) -> tuple[CoarserModels, ...]:
        """The directions in which references of the scene may be too coarse, and are refined, besides truncation."""
        if not self._beams:
            return (CoarserModels("fewer modes", lambda model: self._shapes(model, -1)),)
        return (
            CoarserModels("fewer beams", lambda model: self._pieces(model, -1), True),
            CoarserModels("fewer shapes", lambda model: self._shapes(model, -1)),
            *(self._kinds if self._nodal else ()),
        )

    @property
    def confirming(self) -> tuple[CoarserModels, ...]:
        """The directions that a reference is compared in once it agrees in the others: they refine nothing else."""
        return () if self._beams else self._kinds

    @property
    def _kinds(self) -> tuple[CoarserModels, ...]:
        return (CoarserModels("other modes", self._other_modes),)

    def finer(self, model: LadderModel, beams_first: bool) -> LadderModel | None:
        """The model after another one, with more pieces of beams or more shapes; None where there is none."""
        finer = [self._shapes(model, 1), self._pieces(model, 1)]
        return next((of for of in (reversed(finer) if beams_first else finer) if of is not None), None)

    def lean(self, model: LadderModel) -> LadderModel | None:
        """The model with fewer shapes, which more beams may have as well; None where modes are among them."""
        return None if self._nodal or self.pieces(model) >= MOST_BEAMS else self._shapes(model, -1)

    def truncated(self, model: LadderModel, pieces: int) -> tuple[LadderModel, LadderModel] | None:
        """A model whose beams have few shapes in pieces, and one with nothing truncated; None without beams."""
        if not self._beams:
            return None

        def changed(order: DisplacementOrder) -> Callable[[Flexible], LadderModel]:
            def of(body: Flexible) -> LadderModel:
                own = model.of(body.name)
                few = replace(own, pieces=pieces, count=FULL_SHAPES, order=order)
                return own if own.shapes in COMPONENT_MODES else replace(few, torsion=own.torsion and 1)

            return of

        few, full = (self._each(changed(order)) for order in (DisplacementOrder.TRUNCATED, DisplacementOrder.FULL))
        return few, full

    def pieces(self, model: LadderModel) -> int:
        """The largest number of pieces of a beam of a model."""
        return max(model.of(body.name).pieces for body in self._bodies)

    def needed(self, model: LadderModel, settled: Collection[str] = ()) -> list[LadderModel]:
        """The model of a reference, those that it is compared with first, and two that show the error of truncation.

        settled: the labels of directions that need no comparison.
        """
        directions = [way for way in self.directions if way.label not in settled]
        coarser = [other for way in directions if (other := way.coarser(model)) is not None]
        return [model, *coarser, *(self.truncated(model, 1) or ())]

    def _first(self, body: Flexible, of_beam: LadderModel) -> LadderModel:
        """The first model of a body: that of a beam as it is given."""
        if isinstance(body, FlexibleBody):
            kind = self.modes.kinds(body)[0]
            return LadderModel(kind, min(MODES, self.modes.most(body, kind)), self.modes.order(body))
        twists = isinstance(body, SpatialBeam) and body.torsion is not None
        return replace(of_beam, torsion=TWISTS) if twists else of_beam

    def _with_shapes(self, body: Flexible, model: LadderModel, more: int) -> LadderModel:
        """The model of a body with more shapes, or with fewer, in the range that references have."""
        if isinstance(body, FlexibleBody):
            count = model.count + more * MORE_MODES
            return replace(model, count=max(0, min(count, self.modes.most(body, model.shapes))))
        count = max(1, min(model.count + more, MOST_SHAPES))
        torsion = model.torsion and max(1, min(model.torsion + more, MOST_SHAPES))
        return replace(model, count=count, torsion=torsion)

    def _each(self, of: Callable[[Flexible], LadderModel]) -> LadderModel:
        return mixed({body.name: of(body) for body in self._bodies})

    def _pieces(self, model: LadderModel, more: int) -> LadderModel | None:
        """The model with more pieces of each beam, or with fewer, down to one."""

        def changed(body: Flexible) -> LadderModel:
            own = model.of(body.name)
            return own if own.shapes in COMPONENT_MODES else replace(own, pieces=max(1, own.pieces + more))

        result = self._each(changed)
        return None if result == model or self.pieces(result) > MOST_BEAMS else result

    def _shapes(self, model: LadderModel, more: int) -> LadderModel | None:
        """The model with more, or fewer, shapes of each beam and modes of each finite-element body."""
        result = self._each(lambda body: self._with_shapes(body, model.of(body.name), more))
        return None if result == model else result

    def _other_modes(self, model: LadderModel) -> LadderModel | None:
        """The model with component modes of another kind."""

        def changed(body: Flexible) -> LadderModel:
            own = model.of(body.name)
            return replace(own, shapes=OF_INTERFACE.get(own.shapes, own.shapes))

        result = self._each(changed)
        return None if result == model else result
