"""Standard input data (SID) of flexible bodies, a text format that multibody programs exchange: `read`, `write`."""

from derive.sid.blocks import SidError, SidProblem
from derive.sid.read import read
from derive.sid.unused import SidWarning
from derive.sid.write import write

__all__ = ["SidError", "SidProblem", "SidWarning", "read", "write"]
