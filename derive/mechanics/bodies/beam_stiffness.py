"""The stiffness of a beam in bending and stretching, and the work of the axial force that it carries at rest.

U = 1/2 int {EI (d^2v/dx^2)^2 + EA epsilon^2} dx + int N epsilon dx, with the strain epsilon = sum alpha_k dchi_k/dx of
the axis, see `displacement_fields`, and the axial force N at rest. Bending alone is (22).
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_functions import LEFT, RIGHT, rational
from derive.mechanics.bodies.beam_integrals import ORTHOGONAL, PARITY
from derive.mechanics.bodies.displacement_fields import displacement_fields, stretching_shapes
from derive.mechanics.symbols import Family, pair
from derive.mechanics.symbols import quantity as quantity_symbol
from derive.mechanics.terms import ModelConstant
from derive.roles import Source
from derive.spec.model.beam import PlanarBeam

UNCOUPLED = "mechanics (bending and stretching are coupled by the kinematics alone)"
NO_STRETCH = "these shapes (the ends do not move apart)"


def beam_stiffness(beam: PlanarBeam, pieces: int = 1) -> tuple[ModelConstant, ...]:
    """The entries K_ij, i <= j, in N/m, of a beam or of each of its equal pieces, with the reasons of the zeros."""
    fields, units = displacement_fields(beam), stiffness_units(beam, pieces)
    order = {1: 1, 2: 2}  # of the derivatives, by the axis of a field: strain and curvature
    strained = [field.of.derivative(order[field.axis]) for field in fields]
    result = []
    for i, first in enumerate(strained, 1):
        for j, second in enumerate(strained[i - 1 :], i):
            axis = fields[i - 1].axis
            if fields[j - 1].axis != axis:
                doc = f"stiffness of modes {i} and {j}"
                result.append(
                    ModelConstant(pair(Family.STIFFNESS, i, j), sp.S.Zero, Source.STRETCHING, doc, "N/m", UNCOUPLED)
                )
                continue
            product = first * second
            value = rational(product.integral())
            zero = None if value else PARITY if product.is_odd else ORTHOGONAL
            doc = f"stiffness: int EI (d2 phi_{i}/dx2) (d2 phi_{j}/dx2) dx"
            equation = "(22)"
            if axis == 1:
                doc, equation = f"stiffness: int EA (d chi_{i}/dx) (d chi_{j}/dx) dx", Source.STRETCHING
            # Each derivative by x is 2/l times that by xi, and dx is l/2 dxi.
            expr = units[axis] * 2 ** (2 * order[axis] - 1) * value
            result.append(ModelConstant(pair(Family.STIFFNESS, i, j), expr, equation, doc, "N/m", zero))
    return tuple(result)


def stiffness_units(beam: PlanarBeam, pieces: int = 1) -> dict[int, sp.Expr]:
    """The units of which the entries are rational multiples, by the axis of their fields: EA/l and EI/l^3, in N/m."""
    length = quantity.value(beam.length) / pieces
    units = {2: quantity.value(beam.bending_stiffness) / length**3}
    return units | ({1: quantity.value(beam.axial.stiffness) / length} if beam.axial else {})


def preload_constants(beam: PlanarBeam) -> Iterator[ModelConstant]:
    """The generalised forces N int dchi_k/dx dx (N) of the axial force at rest; none without such a force."""
    if beam.axial is None or beam.axial.preload == 0:
        return
    force = quantity.value(beam.axial.preload, positive=False)
    bending = len(displacement_fields(beam)) - len(stretching_shapes(beam))
    for i in range(1, bending + 1):
        yield _preload(i, sp.S.Zero, "bending stretches the axis no more than the kinematics say")
    for k, shape in enumerate(stretching_shapes(beam), bending + 1):
        apart = rational(shape.at(RIGHT) - shape.at(LEFT))
        yield _preload(k, force * apart, None if apart else NO_STRETCH)


def _preload(k: int, value: sp.Expr, zero: str | None) -> ModelConstant:
    symbol, doc = (
        quantity_symbol(Family.PRELOAD, shapes=(k,)),
        f"work of the axial force at rest: N int d chi_{k}/dx dx",
    )
    return ModelConstant(symbol, value, Source.STRETCHING, doc, "N", zero)
