"""The proximal term, with which redundant constraints have multipliers of least norm: its size and its refinement.

S lambda = b with S = G M^-1 G^T has many solutions where constraints are redundant, all with the same accelerations.
With the diagonal D of S, or LEAST, the system (S + epsilon D) lambda' = b + epsilon D lambda is regular. Its solutions,
one from another and the first from lambda = 0, converge to the solution with the least lambda . D lambda: a part of b
in which S has the eigenvalue s, relative to D, is off by the factor epsilon/(s + epsilon) after each step.
"""

from __future__ import annotations

from fractions import Fraction

PROXIMAL = Fraction(1, 2**30)
"""epsilon: rounding errors of b appear in reactions that are not unique divided by it, and not in accelerations. Within
its root (rad) of a singular position the constraints that become dependent there are not kept by accelerations."""
LEAST = Fraction(1, 2**10)
"""The least entries of D, relative to those of constraints that each of their coordinates moves by 1 m or 1 rad. A
constraint that others imply entirely, as a second hinge of a door whose first one leaves it an angle, has a G of
rounding errors; without this it would count as much as any other, and stop the door."""
REFINEMENTS = 3
"""The solutions after the first one; then the error is that of rounding for eigenvalues s above 1e-4."""
