"""The uniform slender beam in space: its shape integrals, its strain energy, and its cross-sections.

U = 1/2 int {EI_3 v''^2 + EI_2 w''^2 + GJ theta'^2 + EA u'^2} dx, primes by x. At second order the curvatures of a
beam that twists are v'' + theta w'' about e3 and -w'' + theta v'' about e2, which adds

    int (EI_3 - EI_2) theta v'' w'' dx,

a term of third order in the amplitudes, and of second order about a bent state: a cantilever buckles laterally by it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_damping import UNCOUPLED as DAMPED_ALONE
from derive.mechanics.bodies.beam_damping import damping_matrix
from derive.mechanics.bodies.beam_functions import LEFT, RIGHT, rational
from derive.mechanics.bodies.beam_integrals import ORTHOGONAL, PARITY
from derive.mechanics.bodies.beam_stiffness import NO_STRETCH, UNCOUPLED
from derive.mechanics.bodies.rod_deformation import deformation_mass
from derive.mechanics.bodies.section_fields import Direction, SectionShape, section_shapes
from derive.mechanics.bodies.section_inertia import length_of, section_inertia
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.symbols import Family, pair
from derive.mechanics.symbols import quantity as quantity_symbol
from derive.mechanics.tables import PLANAR_DOCS, exact_tables
from derive.mechanics.terms import ModelConstant
from derive.roles import Source
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import cut_into

if TYPE_CHECKING:
    from derive.spec.model.spatial_beam import SpatialBeam

CURVED = {Direction.ALONG_E2: 2, Direction.ALONG_E3: 2, Direction.TORSION: 1, Direction.AXIAL: 1}
"""The order of the derivative of a shape in the strain energy."""
OTHER_DOCS = {
    Family.CUBIC_STIFFNESS: ("stiffness of third order: int (EI_3 - EI_2) theta v'' w'' dx", "N/m^2"),
    Family.PRELOAD: PLANAR_DOCS[Family.PRELOAD],
}
"""The descriptions and units of tables that a finite-element body does not have."""
DESCRIPTIONS = {
    Direction.ALONG_E2: "int EI_3 (d2 phi_{i}/dx2) (d2 phi_{j}/dx2) dx",
    Direction.ALONG_E3: "int EI_2 (d2 phi_{i}/dx2) (d2 phi_{j}/dx2) dx",
    Direction.TORSION: "int GJ (2/l)^2 (d tau_{i}/dx) (d tau_{j}/dx) dx",
    Direction.AXIAL: "int EA (d chi_{i}/dx) (d chi_{j}/dx) dx",
}


def spatial_beam_body(beam: SpatialBeam, gravity: tuple[ModelConstant, ...] = ()) -> Body:
    """The body of a beam in space, or of a piece of one, with its integrals.

    Damping is that of the whole beam, which couples its pieces and is no part of them. Raises ConditionError when the
    ansatz does not fit the frame.
    """
    shapes, inertia = section_shapes(beam), section_inertia(beam)
    constants = (
        *inertia.constants,
        *stiffness_constants(beam, shapes),
        *(cubic_stiffness(beam, shapes) if beam.order is not DisplacementOrder.FIRST_ORDER else ()),
        *preload_constants(beam, shapes),
        *(damping_constants(beam, shapes) if cut_into(beam) == 1 else ()),
    )
    carried = f", with the attached masses {', '.join(m.name for m in beam.masses)}" if beam.masses else ""
    return Body(
        name=beam.name,
        doc=f"beam in space, {beam.frame.kind} frame, {shape_texts(shapes)}{carried}",
        frame_doc="c is where the centre of the undeformed beam lies in the floating frame, whose e1 is its axis.",
        dimension=3,
        modes=len(shapes),
        mass=inertia.mass,
        tables=exact_tables(constants, {**inertia.docs, **OTHER_DOCS}, 3),
        values=ExactValues(constants),
        gravity=gravity,
        order=beam.order,
        fields=inertia.fields,
    )


def shape_texts(shapes: tuple[SectionShape, ...]) -> str:
    """The shape functions as text, in a line."""
    texts = {d: ", ".join(shape.of.text for shape in shapes if shape.direction is d) for d in Direction}
    return "; ".join(f"{direction.value}: {text}" for direction, text in texts.items() if text)


def stiffness_units(beam: SpatialBeam) -> dict[Direction, sp.Expr]:
    """The units of which the entries of K are rational multiples, N/m, by directions."""
    length = length_of(beam)
    units = dict(zip(Direction, (quantity.value(x) / length**3 for x in beam.bending_stiffnesses), strict=False))
    if beam.torsion:
        units[Direction.TORSION] = quantity.value(beam.torsion.stiffness) / length**3
    if beam.axial:
        units[Direction.AXIAL] = quantity.value(beam.axial.stiffness) / length
    return units


def inertia_units(beam: SpatialBeam) -> dict[Direction, sp.Expr]:
    """The units of which the entries of c8 are rational multiples, kg, by directions: m, or 4 J/l^2 of torsion."""
    of_torsion = 4 * quantity.value(beam.rotary_inertia) / length_of(beam) ** 2
    return {d: of_torsion if d is Direction.TORSION else quantity.value(beam.mass) for d in stiffness_units(beam)}


def stiffness_constants(beam: SpatialBeam, shapes: tuple[SectionShape, ...]) -> Iterator[ModelConstant]:
    """The entries K_ij, i <= j, in N/m, with the reasons of the zeros."""
    units = stiffness_units(beam)
    for (i, first), (j, second) in combinations_with_replacement(enumerate(shapes, 1), 2):
        direction, symbol = first.direction, pair(Family.STIFFNESS, i, j)
        if second.direction is not direction:
            doc = f"stiffness of modes {i} and {j}"
            yield ModelConstant(symbol, sp.S.Zero, Source.STRETCHING, doc, "N/m", UNCOUPLED)
            continue
        value = _strain_product(first, second)
        zero = None if value else PARITY if (first.of * second.of).is_odd else ORTHOGONAL
        doc = f"stiffness: {DESCRIPTIONS[direction].format(i=i, j=j)}"
        source = Source.STRETCHING if direction is Direction.AXIAL else "(22)"
        yield ModelConstant(symbol, units[direction] * value, source, doc, "N/m", zero)


def _strain_product(first: SectionShape, second: SectionShape) -> sp.Rational:
    """The entry of K of two shapes of one direction in the unit of its stiffness."""
    one, other = (shape.of.derivative(CURVED[shape.direction]) for shape in (first, second))
    # Each derivative by x is 2/l times that by xi, dx is l/2 dxi, and an amplitude of torsion is l/2 times an angle.
    factor = 2 if first.direction is Direction.AXIAL else 8
    return factor * rational((one * other).integral())


def damping_constants(beam: SpatialBeam, shapes: tuple[SectionShape, ...]) -> Iterator[ModelConstant]:
    """The entries B_ij, i <= j, in N s/m, of a beam, or of all pieces of a beam that is one of them.

    The amplitudes are counted through the pieces from left to right. Entries that vanish have the reason; without
    damping there are none.
    """
    if beam.damping is None:
        return
    n, entries = cut_into(beam), dict[tuple[int, int], sp.Expr]()
    for direction in stiffness_units(beam):
        of = damping_along(beam, shapes, direction)
        entries |= {(i, j): of.B[p, q] for p, i in enumerate(of.numbers) for q, j in enumerate(of.numbers)}
    for i, j in combinations_with_replacement(range(1, n * len(shapes) + 1), 2):
        value = entries.get((i, j), sp.S.Zero)
        zero = None if value else UNCOUPLED if (i, j) not in entries else DAMPED_ALONE
        yield ModelConstant(pair(Family.DAMPING, i, j), value, "(13)", f"damping of modes {i} and {j}", "N s/m", zero)


@dataclass(frozen=True)
class DirectionalDamping:
    """The damping of the amplitudes of a direction: B (N s/m), and the times K^-1 B (s).

    numbers: those of the amplitudes, counted through the pieces of a beam that is cut.
    """

    numbers: tuple[int, ...]
    B: sp.Matrix
    retardation_times: sp.Matrix


def damping_along(beam: SpatialBeam, shapes: tuple[SectionShape, ...], direction: Direction) -> DirectionalDamping:
    """The damping of a beam, which has one, or of all pieces of a beam that is one of them, in a direction."""
    assert beam.damping is not None
    n, unit = cut_into(beam), stiffness_units(beam)[direction]
    own = [i for i, shape in enumerate(shapes) if shape.direction is direction]
    of = [shapes[i] for i in own]
    K = sp.Matrix(len(own), len(own), lambda p, q: _strain_product(of[min(p, q)], of[max(p, q)]))
    M = deformation_mass([shape.of for shape in of], CURVED[direction], n)
    B = damping_matrix(beam.damping, M, sp.diag(*[K] * n), inertia_units(beam)[direction], unit)
    numbers = tuple(len(shapes) * k + i + 1 for k in range(n) for i in own)
    return DirectionalDamping(numbers, B, (sp.diag(*[K.inv()] * n) * B / unit).expand())


def cubic_stiffness(beam: SpatialBeam, shapes: tuple[SectionShape, ...]) -> Iterator[ModelConstant]:
    """The factors of alpha_i alpha_j alpha_k in the strain energy, N/m^2, that do not vanish."""
    first, second = (quantity.value(x) for x in beam.bending_stiffnesses)
    unit = 16 * (first - second) / length_of(beam) ** 4
    numbered = {d: [(i, s.of) for i, s in enumerate(shapes, 1) if s.direction is d] for d in Direction}
    bending = product(numbered[Direction.ALONG_E2], numbered[Direction.ALONG_E3])
    for ((i, v), (j, w)), (k, tau) in product(bending, numbered[Direction.TORSION]):
        value = unit * rational((v.derivative(2) * w.derivative(2) * tau).integral())
        if value != 0:
            doc, of = OTHER_DOCS[Family.CUBIC_STIFFNESS]
            symbol = quantity_symbol(Family.CUBIC_STIFFNESS, shapes=(i, j, k))
            yield ModelConstant(symbol, value, Source.SECOND_ORDER, doc, of)


def preload_constants(beam: SpatialBeam, shapes: tuple[SectionShape, ...]) -> Iterator[ModelConstant]:
    """The generalised forces N int dchi_k/dx dx (N) of the axial force at rest; none without such a force."""
    if beam.axial is None or beam.axial.preload == 0:
        return
    force = quantity.value(beam.axial.preload, positive=False)
    doc, unit = OTHER_DOCS[Family.PRELOAD]
    for k, shape in enumerate(shapes, 1):
        apart = rational(shape.of.at(RIGHT) - shape.of.at(LEFT)) if shape.direction is Direction.AXIAL else 0
        symbol = quantity_symbol(Family.PRELOAD, shapes=(k,))
        yield ModelConstant(symbol, force * apart, Source.STRETCHING, doc, unit, None if apart else NO_STRETCH)
