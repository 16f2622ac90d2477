"""The free beam of the paper, (21)-(27): what a specification describes where it says nothing."""

from __future__ import annotations

from derive.spec.model.body import Parameter

ANSATZ = ("1", "xi", "xi^2", "xi^3")
FRAME = "mean"
MASS = Parameter("m", "kg", 1.0)
LENGTH = Parameter("l", "m", 1.0)
BENDING_STIFFNESS = Parameter("EI", "N m^2", 1.0)
