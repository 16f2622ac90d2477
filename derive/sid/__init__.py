"""Standard input data (SID) of deformable bodies, the text that other multibody programs exchange: `write`, `read`."""

from derive.sid.errors import SidError, SidProblem
from derive.sid.read import read
from derive.sid.write import write

__all__ = ["SidError", "SidProblem", "read", "write"]
