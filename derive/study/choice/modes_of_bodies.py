"""The kinds and the numbers of modes that the finite-element bodies of a scene can have."""

from __future__ import annotations

from derive.errors import SpecError, first_line
from derive.reduction.body import reduce
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.spatial_models import modelled_in_space

MOST = 18
"""The largest number of modes of a body, beside static ones."""
OF_STIFFNESS = (Shapes.CRAIG_BAMPTON, Shapes.ATTACHMENT, Shapes.FREE)
"""The modes that are computed from a stiffness matrix, those that suit a body that joints hold first."""


class ModesOfBodies:
    """The modes of the finite-element bodies of a scene. refusals: why a body has no modes of a kind, by both."""

    def __init__(self, scene: AnyScene) -> None:
        self._scene = scene
        self._kinds: dict[str, tuple[Shapes, ...]] = {}
        self._most: dict[tuple[str, Shapes], int] = {}
        self.refusals: dict[tuple[str, Shapes], str] = {}

    def kinds(self, body: FlexibleBody) -> tuple[Shapes, ...]:
        """The kinds of modes that a body can have, the best one first.

        Modes with geometric stiffness matrices are those of the files, and others would lose these.
        """
        if body.name not in self._kinds:
            given = body.body.data.stiffness is None or body.body.second_order
            self._kinds[body.name] = (
                (Shapes.GIVEN,) if given else tuple(kind for kind in OF_STIFFNESS if self._has(body, kind, 1))
            )
        return self._kinds[body.name]

    def most(self, body: FlexibleBody, kind: Shapes) -> int:
        """The largest number of modes of a kind, beside static ones."""
        if kind is Shapes.GIVEN:
            modes = body.body.data.modes
            return 0 if modes is None else len(modes)
        if (body.name, kind) not in self._most:
            counts = (count for count in range(MOST, 0, -1) if self._has(body, kind, count))
            self._most[body.name, kind] = next(counts, 0)
        return self._most[body.name, kind]

    def _has(self, body: FlexibleBody, kind: Shapes, count: int) -> bool:
        """Whether a body has so many modes of a kind: its interface may be on a line, or there is none."""
        assert isinstance(self._scene, SpatialScene)
        try:
            changed = modelled_in_space(self._scene, body, LadderModel(kind, count))
            assert isinstance(changed, FlexibleBody)
            reduce(changed.body)
        except SpecError as problem:
            self.refusals[body.name, kind] = first_line(problem)
            return False
        return True
