"""The mass matrix of the deformation of a rod, which may be cut into pieces, without its rigid motion.

In piece k, whose own xi goes from -1 to 1, the displacement is a_k + b_k xi + sum_i alpha_ki phi_i across the axis, and
a_k + sum_i alpha_ki chi_i along it. The welds at the cuts keep the displacement continuous, and across the axis its
slope as well. To first order the amplitudes of all pieces therefore determine the a_k and b_k, but for a rigid motion
of the rod. Without it, which is the motion of the mean frame of the whole rod, its kinetic energy is
1/2 alphadot . M alphadot.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from derive.algebra import sp
from derive.mechanics.bodies.beam_functions import LEFT, ONE, RIGHT, XI, BeamFunction, rational

RIGID = {1: (ONE,), 2: (ONE, XI)}
"""The rigid fields along and across the axis; their number is that of continuous derivatives, from 0, at a cut."""


def deformation_mass(shapes: Sequence[BeamFunction], axis: int, pieces: int) -> sp.Matrix:
    """The exact mass matrix divided by the mass of the rod; amplitudes are counted through the pieces from the left.

    shapes: the shapes of each piece that displace it along the axis (1) or across it (2).
    """
    rigid = RIGID[axis]
    fields = (*rigid, *shapes)
    integrals = [[rational((f * g).integral()) for g in fields[:p]] for p, f in enumerate(fields, 1)]
    gram = sp.Matrix(len(fields), len(fields), lambda p, q: integrals[max(p, q)][min(p, q)]) / (2 * pieces)
    n = len(shapes) * pieces
    mass, moments, inertia = sp.zeros(n), sp.zeros(len(rigid), n), sp.zeros(len(rigid))
    for k, displacement in enumerate(_displacements(shapes, rigid, pieces)):
        moved = _rigid_motion(len(rigid), len(shapes), pieces, k)
        mass += displacement.T * gram * displacement
        moments += moved.T * gram * displacement
        inertia += moved.T * gram * moved
    return mass - moments.T * inertia.inv() * moments


def _displacements(shapes: Sequence[BeamFunction], rigid: Sequence[BeamFunction], pieces: int) -> Iterator[sp.Matrix]:
    """The factors of the rigid fields and the shapes of each piece, with a column for each amplitude of the rod.

    The first piece has no rigid motion: the rigid motion of the whole rod is removed from the mass matrix.
    """
    n = len(shapes)
    motion = sp.zeros(len(rigid), n * pieces)
    for k in range(pieces):
        own = sp.zeros(n, n * pieces)
        own[:, n * k : n * (k + 1)] = sp.eye(n)
        if k:
            motion = _at_cut(rigid, LEFT, rigid).inv() * (motion - _at_cut(shapes, LEFT, rigid) * own)
        yield motion.col_join(own)
        motion = _at_cut(rigid, RIGHT, rigid) * motion + _at_cut(shapes, RIGHT, rigid) * own


def _at_cut(functions: Sequence[BeamFunction], end: Fraction, rigid: Sequence[BeamFunction]) -> sp.Matrix:
    """The continuous quantities at a cut by rows: values of functions at an end, and across the axis slopes as well."""
    return sp.Matrix([[rational(f.derivative(d).at(end)) for f in functions] for d in range(len(rigid))])


def _rigid_motion(rigid: int, shapes: int, pieces: int, k: int) -> sp.Matrix:
    """The rigid fields of the whole rod as factors of the fields of piece k, a column each.

    With X of the rod and xi of the piece, both from -1 to 1, X = (2 k + 1 - pieces + xi)/pieces.
    """
    columns = ((sp.S.One, sp.S.Zero), (sp.Rational(2 * k + 1 - pieces, pieces), sp.Rational(1, pieces)))
    return sp.Matrix(rigid + shapes, rigid, lambda p, q: columns[q][p] if p < rigid else sp.S.Zero)
