"""From nodes to numbers: `reduce` makes the modal body that the equations of motion take out of a body of nodes."""

from derive.reduction.body import reduce, zero_stiffness_modes
from derive.reduction.residuals import Departure, Residuals, residuals

__all__ = ["Departure", "Residuals", "reduce", "residuals", "zero_stiffness_modes"]
