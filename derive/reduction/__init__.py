"""Reduction of finite-element data to modes: `reduce` computes the shape integrals of a body given by its nodes."""

from derive.reduction.body import reduce, zero_stiffness_modes
from derive.reduction.properties import BodyProperties, body_properties
from derive.reduction.residuals import Departure, Residuals, residuals

__all__ = [
    "BodyProperties",
    "Departure",
    "Residuals",
    "body_properties",
    "reduce",
    "residuals",
    "zero_stiffness_modes",
]
