"""Reasons why entries of tables vanish, whatever the numbers of a body are."""

from __future__ import annotations

AT_CENTRE = "the choice of the origin (the centre of mass)"
CONDITION_17 = "condition (17) (no mean displacement)"
SECOND_17 = "condition (17) at second order (no mean displacement)"
CONDITION_19 = "condition (19) (no mean rotation)"
SECOND_19 = "condition (19) at second order (no mean rotation)"
ORTHONORMAL = "orthogonality (modes orthonormal in the mass)"
UNDAMPED = "the specification (no damping)"
EXACT_SUM = "the sum over the nodes, which is exactly zero"
ZERO_THERE = "a zero of the integrand at the attached masses"
CANCEL = "the attached masses, which cancel"
NO_SHAPES = "the number of shapes (there is none)"
ODD = "c7 is odd in its indices (one shape does not act on itself)"
