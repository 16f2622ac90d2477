"""The uniform slender beam in a plane, (21)-(27): its shape integrals and its strain energy, in closed form.

The inertia of (15) sees int rho ... dOmega = m/2 int ... dxi over -1 <= xi <= 1, with X = xi l/2 e1 (24) and
Phi_i = phi_i(xi) e2 (25). Beyond the paper, the axis may stretch: further shapes chi_k(xi) e1 follow those of bending.
The rotary inertia of the cross-section and its shear deformation are neglected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations_with_replacement
from typing import assert_never

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.attached_masses import (
    IntegralsWithMasses,
    SecondOrderWithMasses,
    located_masses,
    mass_parameters,
    rotary_inertia,
)
from derive.mechanics.bodies.beam_damping import damping_constants, damping_parameters
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, rational
from derive.mechanics.bodies.beam_integrals import BeamField, BeamIntegrals
from derive.mechanics.bodies.beam_stiffness import beam_stiffness, preload_constants
from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.bodies.foreshortening import (
    Foreshortening,
    field_weights,
    point_shortening,
    second_order_vectors,
)
from derive.mechanics.bodies.planar_integrals import coefficients, second_order_coefficients
from derive.mechanics.body import Body, planar_body
from derive.mechanics.indexed_equations import IndexedEquations, derive_body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.roles import Source
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Marker
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.quantity import Parameter


def derive(beam: PlanarBeam) -> IndexedEquations:
    """The equations of motion of a planar beam: (33) or (41) for the paper's cubic in its two frames.

    Raises ConditionError when the ansatz does not fit the frame.
    """
    return derive_body(beam_body(beam))


def beam_body(beam: PlanarBeam, pieces: int = 1) -> Body:
    """The body of a planar beam with its attached masses, or of each of its equal pieces, with its integrals.

    Markers and masses of a piece are those of `beam`, with positions in the piece. Damping is that of the rod, which
    couples its pieces and is no part of them. Raises ConditionError when the ansatz does not fit the frame.
    """
    shapes = displacement_fields(beam)
    mass, length = quantity.value(beam.mass) / pieces, quantity.value(beam.length) / pieces
    gravity, gravity_parameters = quantity.gravity(beam.gravity)
    mean = beam.frame.kind == "mean"
    masses = located_masses(beam.masses, shapes, length)

    def of_fields(members: tuple[BeamField, ...]) -> tuple[ModelConstant, ...]:
        of_beam = BeamIntegrals(members, mass, length, mean)
        return coefficients(IntegralsWithMasses(of_beam, masses) if masses else of_beam, len(members))

    integrals = of_fields(shapes)
    fields: tuple[BeamFunction, ...] = ()
    second = Foreshortening(shapes, beam.frame, mass, length)
    match beam.order:
        case DisplacementOrder.FIRST_ORDER:
            pass
        case DisplacementOrder.TRUNCATED:
            of_second = SecondOrderWithMasses(second, masses) if masses else second
            integrals += second_order_coefficients(of_second, integrals, len(shapes))
        case DisplacementOrder.FULL:
            fields = tuple(combination.field for combination in second.combinations)
            family = (*shapes, *(BeamField(field, 1) for field in fields))
            integrals = of_fields(family) + field_weights(second)
        case _ as never:
            assert_never(never)
    carried = f", with the attached masses {', '.join(m.name for m in masses)}" if masses else ""
    return planar_body(
        name=beam.name,
        doc=f"free planar beam, {beam.frame.kind} frame, {_shape_texts(shapes)}{carried}",
        frame_doc="X = xi l/2 e1 (24), so c is where the centre of the undeformed beam lies in the floating frame.",
        modes=len(shapes),
        mass=sp.Add(mass, *(m.mass for m in masses)),
        constants=(
            *integrals,
            *rotary_inertia(masses, len(shapes)),
            *beam_stiffness(beam, pieces),
            *preload_constants(beam),
            *(damping_constants(beam) if pieces == 1 else ()),
        ),
        points=tuple(beam_point(marker, beam, pieces) for marker in beam.markers),
        parameters=(*_parameters(beam), *mass_parameters(beam), *damping_parameters(beam), *gravity_parameters),
        gravity=gravity,
        order=beam.order,
        fields=len(fields),
    )


def _parameters(beam: PlanarBeam) -> Iterator[ParameterSymbol]:
    """The run-time parameters of mass, length and bending stiffness."""
    docs = {"mass": "mass of the beam", "length": "length of the beam", "bending_stiffness": "bending stiffness EI"}
    for field, doc in docs.items():
        if isinstance(value := getattr(beam, field), Parameter):
            yield quantity.parameter(value, doc)
    if beam.axial and isinstance(beam.axial.stiffness, Parameter):
        yield quantity.parameter(beam.axial.stiffness, AXIAL_DOCS["stiffness"])
    if beam.axial and isinstance(beam.axial.preload, Parameter):
        yield quantity.parameter(beam.axial.preload, AXIAL_DOCS["preload"], positive=False)


AXIAL_DOCS = {"stiffness": "axial stiffness EA", "preload": "axial force at rest"}
"""The descriptions of the constants of AxialDeformation."""


def _shape_texts(shapes: tuple[BeamField, ...]) -> str:
    """The shape functions as text, in a line."""
    bending = ", ".join(shape.of.text for shape in shapes if shape.axis == 2)
    along = ", ".join(shape.of.text for shape in shapes if shape.axis == 1)
    return f"shapes {bending}" + (f", along the axis {along}" if along else "")


def section_rotations(marker: Marker, beam: PlanarBeam, pieces: int = 1) -> tuple[ModelConstant, ...]:
    """The rotation of the section at a marker for unit amplitudes: dv/dx of each shape, to first order as in (22).

    A section turns by dv/dx/(1 + du/dx). At second order, where the beam stretches, this adds -dv/dx du/dx: the
    constants of two shapes are the factors of alpha_i alpha_k.
    """
    length, shapes = quantity.value(beam.length) / pieces, displacement_fields(beam)
    slopes = [2 * rational(field.of.derivative().at(marker.at)) / length for field in shapes]
    result = []
    for i, (field, slope) in enumerate(zip(shapes, slopes, strict=True), 1):
        zero = "displacements along the axis turn no section" if field.axis == 1 else "these shapes (no slope there)"
        turns = field.axis == 2 and slope != 0
        doc = f"rotation of the section at marker {marker.name} for a unit amplitude of mode {i}: d phi_{i}/dx"
        symbol = Identity(Family.SECTION_ROTATION, shapes=(i,), point=marker.name).symbol
        value = slope if turns else sp.S.Zero
        result.append(ModelConstant(symbol, value, "(21)", doc, "1/m", None if turns else zero))
    if beam.order is DisplacementOrder.FIRST_ORDER:
        return tuple(result)
    for i, k in combinations_with_replacement(range(1, len(shapes) + 1), 2):
        value = -slopes[i - 1] * slopes[k - 1]
        if value != 0 and shapes[i - 1].axis != shapes[k - 1].axis:
            doc = f"rotation of the section at marker {marker.name} by modes {i} and {k}: -(d phi_{i}/dx)(d chi_{k}/dx)"
            symbol = Identity(Family.SECTION_ROTATION, shapes=(i, k), point=marker.name).symbol
            result.append(ModelConstant(symbol, value, Source.SECOND_ORDER, doc, "1/m^2"))
    return tuple(result)


def beam_point(marker: Marker, beam: PlanarBeam, pieces: int = 1) -> MaterialPoint:
    """A point of the beam, or of one of its pieces, of which the marker then is."""
    docs = (f"material point at xi = {marker.at}", f"reference position of marker {marker.name}")
    zero = "the choice of the origin (the marker is there)"
    return point_that_sees(marker.name, docs, beam, pieces, lambda of: rational(of.at(marker.at)), zero)


def point_that_sees(
    name: str,
    docs: tuple[str, str],
    beam: PlanarBeam,
    pieces: int,
    value: Callable[[BeamFunction], sp.Rational],
    zero: str,
) -> MaterialPoint:
    """A point that moves like the beam, or one of its pieces, at a position or in the mean over some part.

    docs: the descriptions of the point and of its position; value: evaluates a function of xi at the point; zero: the
    reason if its position vanishes.
    """
    shapes = displacement_fields(beam)
    length = quantity.value(beam.length) / pieces
    position, at = Identity(Family.POINT_POSITION, point=name).symbol, value(XI)
    constants = [ModelConstant(position, at * length / 2, "(24)", docs[1], "m", None if at else zero)]
    second: tuple[ModelConstant, ...] = ()
    if beam.order is not DisplacementOrder.FIRST_ORDER:
        second = point_shortening(Foreshortening(shapes, beam.frame, sp.S.Zero, length), name, value)
    return MaterialPoint(
        name=name,
        doc=docs[0],
        position=sp.ImmutableMatrix([position, 0]),
        shapes=tuple(sp.ImmutableMatrix([value(s.of), 0] if s.axis == 1 else [0, value(s.of)]) for s in shapes),
        coefficients=(*constants, *second),
        second=second_order_vectors(second, len(shapes)),
    )
