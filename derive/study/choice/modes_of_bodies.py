"""The kinds and the numbers of modes that the finite-element bodies of a scene can have."""

from __future__ import annotations

from derive.errors import SpecError, first_line
from derive.reduction.body import reduce
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.spatial_models import can_have, modelled_in_space, most_modes

MOST = 18
"""The largest number of modes of a body, beside static ones."""
OF_STIFFNESS = (Shapes.CRAIG_BAMPTON, Shapes.ATTACHMENT, Shapes.FREE)
"""The modes that are computed from a stiffness matrix, those that suit a body that joints hold first."""
NOT_HELD = "its joints are at no set of nodes, or at three nodes that are on no line"


class ModesOfBodies:
    """The modes of the finite-element bodies of a scene. refusals: why a body has no modes of a kind, by both."""

    def __init__(self, scene: AnyScene) -> None:
        self._scene = scene
        self._kinds: dict[str, tuple[Shapes, ...]] = {}
        self.refusals: dict[tuple[str, Shapes], str] = {}

    def kinds(self, body: FlexibleBody) -> tuple[Shapes, ...]:
        """The kinds of modes that a body can have, the best one first.

        Geometric stiffness matrices of files are those of their modes, and others would lose these.
        """
        if body.name not in self._kinds:
            own, data = body.body, body.body.data
            of_files = data.stiffness is None or (own.second_order and not own.computes_geometric_stiffness)
            kinds = (kind for kind in OF_STIFFNESS if self._has(body, kind))
            self._kinds[body.name] = (Shapes.GIVEN,) if of_files else tuple(kinds)
        return self._kinds[body.name]

    def order(self, body: FlexibleBody) -> DisplacementOrder:
        """The order of the modes of a body: the second one if its files, or its elements, have geometric stiffness."""
        stiffens = body.body.second_order or body.body.data.gives_geometric_stiffness
        return DisplacementOrder.TRUNCATED if stiffens else DisplacementOrder.FIRST_ORDER

    def most(self, body: FlexibleBody, kind: Shapes) -> int:
        """The largest number of modes of a kind that is tried, beside static ones."""
        assert isinstance(self._scene, SpatialScene)
        return min(MOST, most_modes(self._scene, body, kind))

    def _has(self, body: FlexibleBody, kind: Shapes) -> bool:
        """Whether a body has modes of a kind: there may be no interface, or one on a line."""
        assert isinstance(self._scene, SpatialScene)
        model = LadderModel(kind, 1, self.order(body))
        if not can_have(self._scene, body, model):
            self.refusals[body.name, kind] = NOT_HELD
            return False
        try:
            changed = modelled_in_space(self._scene, body, model)
            assert isinstance(changed, FlexibleBody)
            reduce(changed.body)
        except SpecError as problem:
            self.refusals[body.name, kind] = first_line(problem)
            return False
        return True
