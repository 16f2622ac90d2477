"""The uniform slender beam in a plane, (21)-(27): its shape integrals and its strain energy, in closed form.

The inertia of (15) sees int rho ... dOmega = m/2 int ... dxi over -1 <= xi <= 1, with X = xi l/2 e1 (24) and
Phi_i = phi_i(xi) e2 (25). The rotary inertia of the cross-section is neglected, the axis does not stretch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

import sympy as sp

from derive.mechanics import quantity
from derive.mechanics.bodies.attached_masses import (
    IntegralsWithMasses,
    SecondOrderWithMasses,
    located_masses,
    mass_parameters,
    rotary_inertia,
)
from derive.mechanics.bodies.beam_damping import beam_damping, damping_parameters, retardation
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, rational
from derive.mechanics.bodies.beam_integrals import ORTHOGONAL, PARITY, BeamField, BeamIntegrals
from derive.mechanics.bodies.foreshortening import (
    Foreshortening,
    field_weights,
    point_shortening,
    second_order_vectors,
)
from derive.mechanics.bodies.planar_integrals import coefficients, second_order_coefficients
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.body import Body, planar_body
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import derive_body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, Identity, Symbol, pair
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.spec.model.body import DisplacementOrder, Marker, PlanarBeam
from derive.spec.model.quantity import Parameter


def derive(beam: PlanarBeam) -> Equations:
    """The equations of motion of a planar beam: (33) or (41) for the paper's cubic in its two frames.

    Raises ConditionError when the ansatz does not fit the frame.
    """
    return derive_body(beam_body(beam))


def beam_body(beam: PlanarBeam, pieces: int = 1) -> Body:
    """The body of a planar beam with its attached masses, or of each of its equal pieces, with its integrals.

    Markers and masses of a piece are those of `beam`, with positions in the piece. Raises ConditionError when the
    ansatz does not fit the frame.
    """
    shapes = assumed_shapes(beam.deflection)
    mass, length, bending = (quantity.value(q) for q in (beam.mass, beam.length, beam.bending_stiffness))
    mass, length = mass / pieces, length / pieces
    gravity, gravity_parameters = quantity.gravity(beam.gravity)
    family = tuple(BeamField(shape, 2) for shape in shapes)
    mean = beam.frame.kind == "mean"
    masses = located_masses(beam.masses, shapes, length)

    def of_fields(members: tuple[BeamField, ...]) -> tuple[ModelConstant, ...]:
        of_beam = BeamIntegrals(members, mass, length, mean)
        return coefficients(IntegralsWithMasses(of_beam, masses) if masses else of_beam, len(members))

    integrals = of_fields(family)
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
            family += tuple(BeamField(field, 1) for field in fields)
            integrals = of_fields(family) + field_weights(second)
        case _ as never:
            assert_never(never)
    carried = f", with the attached masses {', '.join(m.name for m in masses)}" if masses else ""
    return planar_body(
        name=beam.name,
        doc=f"free planar beam, {beam.frame.kind} frame, shapes {', '.join(shape.text for shape in shapes)}{carried}",
        frame_doc="X = xi l/2 e1 (24), so c is where the centre of the undeformed beam lies in the floating frame.",
        modes=len(shapes),
        mass=sp.Add(mass, *(m.mass for m in masses)),
        constants=(
            *integrals,
            *rotary_inertia(masses, len(shapes)),
            *_stiffness(shapes, length, bending),
            *damping_constants(beam, pieces),
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


def damping_constants(beam: PlanarBeam, pieces: int = 1) -> tuple[ModelConstant, ...]:
    """The entries of the damping matrix of a beam, or of its equal pieces; none without damping."""
    if beam.damping is None:
        return ()
    mass, length, bending = (quantity.value(q) for q in (beam.mass, beam.length, beam.bending_stiffness))
    mass, length = mass / pieces, length / pieces
    shapes = assumed_shapes(beam.deflection)
    family = tuple(BeamField(shape, 2) for shape in shapes)
    integrals = coefficients(BeamIntegrals(family, mass, length, beam.frame.kind == "mean"), len(shapes))
    stiffness = _stiffness(shapes, length, bending)
    return beam_damping(beam.damping, integrals, stiffness, mass, bending / length**3)


def retardation_times(beam: PlanarBeam, pieces: int = 1) -> sp.Matrix:
    """K^-1 B (s) of a beam with damping, or of its equal pieces; see `retardation`."""
    length, bending = (quantity.value(q) for q in (beam.length, beam.bending_stiffness))
    shapes = assumed_shapes(beam.deflection)
    unit = bending / (length / pieces) ** 3
    return retardation(_stiffness(shapes, length / pieces, bending), damping_constants(beam, pieces), unit)


def section_rotations(marker: Marker, beam: PlanarBeam, pieces: int = 1) -> tuple[ModelConstant, ...]:
    """The rotation of the section at a marker for unit amplitudes: dv/dx of each shape, to first order as in (22)."""
    length = quantity.value(beam.length) / pieces
    result = []
    for i, shape in enumerate(assumed_shapes(beam.deflection), 1):
        slope = rational(shape.derivative().at(marker.at))
        zero = None if slope else "these shapes (no slope there)"
        doc = f"rotation of the section at marker {marker.name} for a unit amplitude of mode {i}: d phi_{i}/dx"
        symbol = Symbol(Identity(Family.SECTION_ROTATION, shapes=(i,), point=marker.name))
        result.append(ModelConstant(symbol, 2 * slope / length, "(21)", doc, "1/m", zero))
    return tuple(result)


def _stiffness(shapes: tuple[BeamFunction, ...], length: sp.Expr, bending: sp.Expr) -> tuple[ModelConstant, ...]:
    """K_ij of U = 1/2 EI int (d^2v/dx^2)^2 dx, which is (22) since x = xi l/2."""
    dxi_dx = 2 / length
    dx_dxi = length / 2
    curvatures = [shape.derivative(2) for shape in shapes]
    result = []
    for i, first in enumerate(curvatures, 1):
        for j, second in enumerate(curvatures[i - 1 :], i):
            product = first * second
            value = rational(product.integral())
            zero = None if value else PARITY if product.is_odd else ORTHOGONAL
            doc = f"stiffness: int EI (d2 phi_{i}/dx2) (d2 phi_{j}/dx2) dx"
            expr = bending * dxi_dx**4 * dx_dxi * value
            result.append(ModelConstant(pair(Family.STIFFNESS, i, j), expr, "(22)", doc, "N/m", zero))
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
    """A point that moves as the beam, or one of its pieces, does at a place, or in the mean over some part.

    docs: of the point and of its position; value: what the point sees of a function of xi; zero: why its position
    vanishes if it does.
    """
    shapes = assumed_shapes(beam.deflection)
    length = quantity.value(beam.length) / pieces
    position, at = Symbol(Identity(Family.POINT_POSITION, point=name)), value(XI)
    constants = [ModelConstant(position, at * length / 2, "(24)", docs[1], "m", None if at else zero)]
    second: tuple[ModelConstant, ...] = ()
    if beam.order is not DisplacementOrder.FIRST_ORDER:
        second = point_shortening(Foreshortening(shapes, beam.frame, sp.S.Zero, length), name, value)
    return MaterialPoint(
        name=name,
        doc=docs[0],
        position=sp.ImmutableMatrix([position, 0]),
        shapes=tuple(sp.ImmutableMatrix([0, value(s)]) for s in shapes),
        coefficients=(*constants, *second),
        second=second_order_vectors(second, len(shapes)),
    )
