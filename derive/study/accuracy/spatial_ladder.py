"""The ladder of models of a scene in space, and the ever finer models that are its reference.

Beams and finite-element bodies have rungs of their own; a model of one kind leaves the bodies of the other kind as they
are specified, while the reference refines both.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

from derive.enumerations import enumeration
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import (
    COMPONENT_KINDS,
    FAMILIES,
    MODES,
    ORDERS,
    STATIC,
    LadderModel,
    Shapes,
    mixed,
)
from derive.study.accuracy.spatial_models import (
    can_have,
    coordinates,
    flexible_bodies,
    modelled_in_space,
    most_modes,
    twists,
)
from derive.study.study_options import LadderRange

OF_PIECES = (2, 4)
"""The numbers of polynomials of each piece of a beam, in each of its planes."""
TWISTS = 2
"""The number of shapes of torsion of each piece of a beam in a reference."""
PIECES = ((1, 4), (2, 4), (3, 4), (4, 4), (6, 3), (8, 3))
"""The numbers of pieces of beams in a reference, and of polynomials of each piece."""
REFINED = (6, 12, 18, 30)
"""The numbers of modes of finite-element bodies in a reference, beside the static ones of their interfaces."""


def spatial_ladder(scene: SpatialScene, limits: LadderRange) -> tuple[LadderModel, ...]:
    """The models in the order of their number of coordinates, from rigid bodies on."""
    bodies = flexible_bodies(scene)
    models = [LadderModel(Shapes.RIGID)]
    if any(isinstance(body, SpatialBeam) for body in bodies):
        models += _beams(limits)
    finite = [body for body in bodies if isinstance(body, FlexibleBody)]
    models += [model for model in _component_modes(finite, limits) if any(can_have(scene, b, model) for b in finite)]

    def size(model: LadderModel) -> int:
        return sum(coordinates(modelled_in_space(scene, body, model)) for body in bodies)

    return tuple(sorted(dict.fromkeys(models), key=lambda m: (m.shapes is not Shapes.RIGID, size(m), m.label)))


def _beams(limits: LadderRange) -> Iterator[LadderModel]:
    for order, torsion in product((ORDERS[name] for name in limits.orders), limits.torsion or (None,)):
        for modes, count in product((Shapes.SINES, *(MODES[name] for name in limits.modes)), limits.sines):
            yield LadderModel(modes, count, order, FAMILIES[modes][1].kind, torsion=torsion)
        for frame, count in product(limits.frames, limits.shapes):
            yield LadderModel(Shapes.POLYNOMIALS, count, order, frame, torsion=torsion)
        for frame, pieces, count in product(limits.frames, limits.pieces, OF_PIECES):
            yield LadderModel(Shapes.POLYNOMIALS, count, order, frame, pieces, torsion=torsion)


def _component_modes(bodies: Iterable[FlexibleBody], limits: LadderRange) -> Iterator[LadderModel]:
    for order in (ORDERS[name] for name in limits.orders):
        kinds = (COMPONENT_KINDS[name] for name in limits.component_modes)
        for shapes, count in product(kinds, limits.component_counts):
            yield LadderModel(shapes, count, order)
            if shapes in STATIC:
                yield LadderModel(shapes, 0, order)
        for data in (body.body.data for body in bodies):
            if data.modes is not None:
                fewer = limits.component_counts if data.stiffness is None or data.has_geometric_stiffness else ()
                yield from (LadderModel(Shapes.GIVEN, count, order) for count in (*fewer, len(data.modes)))


def spatial_refinements(scene: SpatialScene) -> tuple[LadderModel, ...]:
    """Ever finer models, the last two of which give a reference and its error.

    Beams are of second order, in more and more pieces. Finite-element bodies have more and more modes, which are
    Craig-Bampton modes where joints hold them, otherwise free ones, or those of the files if there are no others.
    """
    steps = {
        body.name: _pieces(body) if isinstance(body, SpatialBeam) else _more_modes(scene, body)
        for body in flexible_bodies(scene)
    }
    numbers = range(max(map(len, steps.values())))
    return tuple(dict.fromkeys(mixed({name: of[min(n, len(of) - 1)] for name, of in steps.items()}) for n in numbers))


def linear_reference(scene: AnyScene) -> tuple[str, ...]:
    """A line on the bodies of which a reference from models is of first order, if there are any."""
    if not isinstance(scene, SpatialScene):
        return ()
    (finest, *_) = reversed(spatial_refinements(scene))
    first = DisplacementOrder.FIRST_ORDER
    names = [body.name for body in flexible_bodies(scene) if finest.of(body.name).order is first]
    if not names:
        return ()
    return (
        f"the reference of {enumeration(names)} is of first order: it does not know what axial forces and spin add",
    )


def _pieces(body: SpatialBeam) -> tuple[LadderModel, ...]:
    """The models of a beam, with its own shapes of torsion if these are the ones of a reference."""
    own = body.torsion is None or body.torsion.ansatz == twists(TWISTS)
    order, torsion = DisplacementOrder.TRUNCATED, None if own else TWISTS
    return tuple(LadderModel(Shapes.POLYNOMIALS, n, order, "mean", pieces, torsion=torsion) for pieces, n in PIECES)


def _more_modes(scene: SpatialScene, body: FlexibleBody) -> tuple[LadderModel, ...]:
    """The models of a finite-element body: as many modes as its nodes allow, at most."""
    kinds = (Shapes.CRAIG_BAMPTON, Shapes.FREE, Shapes.GIVEN)
    shapes = next(shapes for shapes in kinds if can_have(scene, body, LadderModel(shapes)))
    second = LadderModel(shapes, 1, DisplacementOrder.TRUNCATED)
    order = second.order if can_have(scene, body, second) else DisplacementOrder.FIRST_ORDER
    most = most_modes(scene, body, shapes)
    counts = REFINED if most >= REFINED[-1] else [most * n // REFINED[-1] for n in REFINED]
    return tuple(LadderModel(shapes, count, order) for count in counts)
