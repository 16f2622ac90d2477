"""The uniform slender beam in a plane, (21)-(27): its shape integrals and its strain energy, exactly.

The inertia of (15) sees int rho ... dOmega = m/2 int ... dxi over -1 <= xi <= 1, with X = xi l/2 e1 (24) and
Phi_i = phi_i(xi) e2 (25). The rotary inertia of the cross-section is neglected, the axis does not stretch.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from derive.mechanics import quantity
from derive.mechanics.bodies.beam_damping import beam_damping
from derive.mechanics.bodies.foreshortening import Foreshortening, point_shortening, second_order_vectors
from derive.mechanics.bodies.planar_integrals import Value, coefficients, second_order_coefficients
from derive.mechanics.bodies.reference_conditions import assumed_shapes, exact_polynomial, integral, xi
from derive.mechanics.body import Body, planar_body
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import derive_body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, Identity, Symbol, pair
from derive.mechanics.terms import ModelConstant
from derive.spec.model.body import Kinematics, Marker, Parameter, PlanarBeam, Polynomial

LATERAL = "geometry (the beam lies along e1 and deflects along e2)"
PARALLEL = "geometry (all deflections are along e2)"
CENTRED = "the choice of the origin (the centre of the undeformed beam)"
CONDITION_17 = "condition (17) (no mean displacement)"
CONDITION_19 = "condition (19) (no mean rotation)"
PARITY = "parity (the integrand is odd in xi)"
BY_CHANCE = "these shapes (the integral vanishes exactly)"
ORTHOGONAL = "orthogonality (the integral vanishes exactly)"


def derive(beam: PlanarBeam) -> Equations:
    """The equations of motion of a planar beam: (33) or (41) for the paper's cubic in its two frames.

    Raises ConditionError when the ansatz does not fit the frame.
    """
    return derive_body(beam_body(beam))


def beam_body(beam: PlanarBeam, pieces: int = 1) -> Body:
    """The body of a planar beam, or of each of its equal pieces, with its integrals. Raises ConditionError when the
    ansatz does not fit the frame."""
    shapes = assumed_shapes(beam.ansatz, beam.frame, beam.orthogonal)
    mass, length, bending = (quantity.value(q) for q in (beam.mass, beam.length, beam.bending_stiffness))
    mass, length = mass / pieces, length / pieces
    gravity, gravity_parameters = quantity.gravity(beam.gravity)
    docs = {"mass": "mass of the beam", "length": "length of the beam", "bending_stiffness": "bending stiffness EI"}
    integrals = coefficients(BeamIntegrals(shapes, mass, length, beam.frame.kind == "mean"), len(shapes))
    if beam.kinematics is not Kinematics.FIRST_ORDER:
        second = Foreshortening(tuple(map(exact_polynomial, shapes)), beam.frame, mass, length)
        integrals += second_order_coefficients(second, integrals, len(shapes))
    stiffness = _stiffness(shapes, length, bending)
    damping = beam_damping(beam.damping, integrals, stiffness, mass, bending / length**3) if beam.damping else ()
    return planar_body(
        name=beam.name,
        doc=f"free planar beam, {beam.frame.kind} frame, shapes {', '.join(map(shape_text, shapes))}",
        frame_doc="X = xi l/2 e1 (24), so c is where the centre of the undeformed beam lies in the floating frame.",
        modes=len(shapes),
        mass=mass,
        constants=(*integrals, *stiffness, *damping),
        points=tuple(beam_point(marker, beam, pieces) for marker in beam.markers),
        parameters=tuple(
            quantity.parameter(getattr(beam, field), doc)
            for field, doc in docs.items()
            if isinstance(getattr(beam, field), Parameter)
        )
        + gravity_parameters,
        gravity=gravity,
        kinematics=beam.kinematics,
    )


def section_rotations(marker: Marker, beam: PlanarBeam, pieces: int = 1) -> tuple[ModelConstant, ...]:
    """The rotation of the section at a marker for unit amplitudes: dv/dx of each shape, to first order as in (22)."""
    at, length = sp.Rational(marker.at), quantity.value(beam.length) / pieces
    result = []
    for i, shape in enumerate(assumed_shapes(beam.ansatz, beam.frame, beam.orthogonal), 1):
        slope = exact_polynomial(shape).diff(xi).eval(at)
        zero = None if slope else "these shapes (no slope there)"
        doc = f"rotation of the section at marker {marker.name} for a unit amplitude of mode {i}: d phi_{i}/dx"
        symbol = Symbol(Identity(Family.SECTION_ROTATION, shapes=(i,), point=marker.name))
        result.append(ModelConstant(symbol, 2 * slope / length, "(21)", doc, "1/m", zero))
    return tuple(result)


def shape_text(coefficients: Polynomial) -> str:
    """A shape in xi as it is written."""
    return str(exact_polynomial(coefficients).as_expr()).replace("**", "^")


@dataclass(frozen=True)
class BeamIntegrals:
    """Moments of X (index 0) and of the shapes phi_i(xi) of a uniform beam; see FieldIntegrals."""

    shapes: tuple[Polynomial, ...]
    mass: sp.Expr
    length: sp.Expr
    mean_frame: bool

    def first(self, i: int, component: int) -> Value:
        """X lies along e1 and the shapes along e2."""
        if (i == 0) != (component == 1):
            return Value(sp.S.Zero, LATERAL)
        if i == 0:
            return self._value(self._field(0), self.length / 2, CENTRED)
        return self._value(self._field(i), sp.S.One, CONDITION_17 if self.mean_frame else None, BY_CHANCE)

    def trace(self, i: int, j: int) -> Value:
        """X . X, X . Phi_j or Phi_i . Phi_j."""
        if (i == 0) != (j == 0):
            return Value(sp.S.Zero, LATERAL)
        factor = self.length**2 / 4 if i == 0 else sp.S.One
        return self._value(self._field(i) * self._field(j), factor)

    def axial(self, i: int, j: int) -> Value:
        """X x Phi_j; the shapes are parallel to each other."""
        if i and j:
            return Value(sp.S.Zero, PARALLEL)
        condition = CONDITION_19 if self.mean_frame else None
        return self._value(self._field(i) * self._field(j), self.length / 2, condition)

    def _field(self, i: int) -> sp.Poly:
        return exact_polynomial(self.shapes[i - 1]) if i else sp.Poly(xi, xi, domain="QQ")

    def _value(
        self, integrand: sp.Poly, factor: sp.Expr, reason: str | None = None, otherwise: str = ORTHOGONAL
    ) -> Value:
        """m/2 int integrand dxi times factor, with the reason if it is zero."""
        value = integral(integrand)
        if value:
            return Value(self.mass * factor * value / 2)
        odd = all(n % 2 for (n,), _ in integrand.terms())
        return Value(sp.S.Zero, reason or (PARITY if odd else otherwise))


def _stiffness(shapes: tuple[Polynomial, ...], length: sp.Expr, bending: sp.Expr) -> tuple[ModelConstant, ...]:
    """K_ij of U = 1/2 EI int (d^2v/dx^2)^2 dx, which is (22) since x = xi l/2."""
    dxi_dx = 2 / length
    dx_dxi = length / 2
    curvatures = [exact_polynomial(s).diff((xi, 2)) for s in shapes]
    result = []
    for i, first in enumerate(curvatures, 1):
        for j, second in enumerate(curvatures[i - 1 :], i):
            value = integral(first * second)
            odd = all(n % 2 for (n,), _ in (first * second).terms())
            zero = None if value else PARITY if odd else ORTHOGONAL
            doc = f"stiffness: int EI (d2 phi_{i}/dx2) (d2 phi_{j}/dx2) dx"
            expr = bending * dxi_dx**4 * dx_dxi * value
            result.append(ModelConstant(pair(Family.STIFFNESS, i, j), expr, "(22)", doc, "N/m", zero))
    return tuple(result)


def beam_point(marker: Marker, beam: PlanarBeam, pieces: int = 1) -> MaterialPoint:
    """A point of the beam, or of one of its pieces, of which the marker then is."""
    shapes, length = assumed_shapes(beam.ansatz, beam.frame, beam.orthogonal), quantity.value(beam.length) / pieces
    at = sp.Rational(marker.at)
    position = Symbol(Identity(Family.POINT_POSITION, point=marker.name))
    zero = None if at else "the choice of the origin (the marker is there)"
    doc = f"reference position of marker {marker.name}"
    shortening = _shortening_at(marker, beam, length) if beam.kinematics is not Kinematics.FIRST_ORDER else ()
    return MaterialPoint(
        name=marker.name,
        doc=f"material point at xi = {at}",
        position=sp.ImmutableMatrix([position, 0]),
        shapes=tuple(sp.ImmutableMatrix([0, exact_polynomial(s).eval(at)]) for s in shapes),
        coefficients=(ModelConstant(position, at * length / 2, "(24)", doc, "m", zero), *shortening),
        second=second_order_vectors(shortening, len(shapes)),
    )


def _shortening_at(marker: Marker, beam: PlanarBeam, length: sp.Expr) -> tuple[ModelConstant, ...]:
    """psi_ij at a marker."""
    shapes = tuple(map(exact_polynomial, assumed_shapes(beam.ansatz, beam.frame, beam.orthogonal)))
    second = Foreshortening(shapes, beam.frame, sp.S.Zero, length)
    at = sp.Rational(marker.at)
    return point_shortening(second, marker.name, lambda psi: psi.eval(at))
