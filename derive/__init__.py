"""Tisserand: equations of motion of deformable bodies, from a specification to C and Python kernels.

    beam = derive.read("scenes/free_beam_mean.toml")    # or derive.planar_beam(...)
    equations = derive.derive(beam)                     # SymPy, named terms
    model = derive.lower(equations)                     # kernels with explicit sparsity
    files = derive.model_files(model, beam)             # C99, Python, manifest
    derive.write(files, Path("generated"))
    native = derive.load(files)                         # compiled, called through NumPy

Names are imported when they are first used, so that nothing pays for what it does not need.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from derive.version import VERSION as __version__  # noqa: N811  the name Python expects

if TYPE_CHECKING:
    from derive.emit.files import File, write
    from derive.emit.model_files import model_files
    from derive.kernel.interpret import interpret
    from derive.kernel.lower import lower
    from derive.kernel.model import Model
    from derive.mechanics.beam import derive
    from derive.mechanics.equations import Equations
    from derive.native import Native, load
    from derive.spec import Frame, Marker, Parameter, PlanarBeam, SpecError, planar_beam, read

_HOME = {
    "File": "derive.emit.files",
    "write": "derive.emit.files",
    "model_files": "derive.emit.model_files",
    "interpret": "derive.kernel.interpret",
    "lower": "derive.kernel.lower",
    "Model": "derive.kernel.model",
    "derive": "derive.mechanics.beam",
    "Equations": "derive.mechanics.equations",
    "Native": "derive.native",
    "load": "derive.native",
    **dict.fromkeys(("Frame", "Marker", "Parameter", "PlanarBeam", "SpecError", "planar_beam", "read"), "derive.spec"),
}

__all__ = [
    "Equations",
    "File",
    "Frame",
    "Marker",
    "Model",
    "Native",
    "Parameter",
    "PlanarBeam",
    "SpecError",
    "__version__",
    "derive",
    "interpret",
    "load",
    "lower",
    "model_files",
    "planar_beam",
    "read",
    "write",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
