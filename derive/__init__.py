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
    from derive.derivation import derive, derive_modal, lower, modal, parameters
    from derive.emit.files import File, write
    from derive.emit.model_files import model_files
    from derive.kernel.interpret import interpret
    from derive.kernel.model import Model
    from derive.mechanics.equations import Equations
    from derive.mechanics.generic import GenericEquations
    from derive.mechanics.modal import ModalBody
    from derive.native import Native, load
    from derive.spec import (
        Frame,
        Marker,
        NodalBody,
        Parameter,
        PlanarBeam,
        SpecError,
        SymbolicBody,
        nodal_body,
        planar_beam,
        read,
        symbolic_body,
    )

_HOME = {
    "File": "derive.emit.files",
    "write": "derive.emit.files",
    "model_files": "derive.emit.model_files",
    "interpret": "derive.kernel.interpret",
    **dict.fromkeys(("derive", "derive_modal", "lower", "modal", "parameters"), "derive.derivation"),
    "Model": "derive.kernel.model",
    "Equations": "derive.mechanics.equations",
    "GenericEquations": "derive.mechanics.generic",
    "ModalBody": "derive.mechanics.modal",
    "Native": "derive.native",
    "load": "derive.native",
    **dict.fromkeys(("Frame", "Marker", "Parameter", "PlanarBeam", "SpecError", "planar_beam", "read"), "derive.spec"),
    **dict.fromkeys(("NodalBody", "SymbolicBody", "nodal_body", "symbolic_body"), "derive.spec"),
}

__all__ = [
    "Equations",
    "File",
    "Frame",
    "GenericEquations",
    "Marker",
    "ModalBody",
    "Model",
    "Native",
    "NodalBody",
    "Parameter",
    "PlanarBeam",
    "SpecError",
    "SymbolicBody",
    "__version__",
    "derive",
    "derive_modal",
    "interpret",
    "load",
    "lower",
    "modal",
    "model_files",
    "nodal_body",
    "parameters",
    "planar_beam",
    "read",
    "symbolic_body",
    "write",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
