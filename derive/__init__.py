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
    from derive.artifacts import File, write
    from derive.backends.model_files import model_files
    from derive.derivation import derive, derive_modal, lower, modal, parameters
    from derive.errors import SpecError, TisserandError
    from derive.ir.interpreter import interpret
    from derive.ir.model import Model
    from derive.mechanics.bodies.modal_body import ModalBody
    from derive.mechanics.equations import Equations
    from derive.mechanics.indexed_equations import GenericEquations
    from derive.runtime.native import Native, load
    from derive.spec.construction import nodal_body, planar_beam, scene, symbolic_body, validated
    from derive.spec.model.body import (
        BodyFrame,
        Damping,
        Frame,
        Marker,
        NodalBody,
        NodeData,
        NodeMarker,
        Parameter,
        PlanarBeam,
        SymbolicBody,
    )
    from derive.spec.model.scene import (
        BeamBody,
        Deflection,
        Drive,
        Force,
        InitialGuess,
        Joint,
        MarkerRef,
        Plot,
        PointMarker,
        ReferenceCurve,
        RigidBody,
        Scene,
        Simulation,
        Spring,
        TimeFunction,
        Torque,
    )
    from derive.spec.parsing.time_expression import time_function
    from derive.spec.toml.read import read

_BODY_TYPES = (
    "BodyFrame",
    "Damping",
    "Frame",
    "Marker",
    "NodalBody",
    "NodeData",
    "NodeMarker",
    "Parameter",
    "PlanarBeam",
    "SymbolicBody",
)
_SCENE_TYPES = (
    "BeamBody",
    "Deflection",
    "Drive",
    "Force",
    "InitialGuess",
    "Joint",
    "MarkerRef",
    "Plot",
    "PointMarker",
    "ReferenceCurve",
    "RigidBody",
    "Scene",
    "Simulation",
    "Spring",
    "TimeFunction",
    "Torque",
)
_HOME = {
    "File": "derive.artifacts",
    "write": "derive.artifacts",
    "model_files": "derive.backends.model_files",
    "interpret": "derive.ir.interpreter",
    **dict.fromkeys(("derive", "derive_modal", "lower", "modal", "parameters"), "derive.derivation"),
    "Model": "derive.ir.model",
    "Equations": "derive.mechanics.equations",
    "GenericEquations": "derive.mechanics.indexed_equations",
    "ModalBody": "derive.mechanics.bodies.modal_body",
    "Native": "derive.runtime.native",
    "load": "derive.runtime.native",
    **dict.fromkeys(("SpecError", "TisserandError"), "derive.errors"),
    **dict.fromkeys(_BODY_TYPES, "derive.spec.model.body"),
    **dict.fromkeys(_SCENE_TYPES, "derive.spec.model.scene"),
    **dict.fromkeys(("nodal_body", "planar_beam", "scene", "symbolic_body", "validated"), "derive.spec.construction"),
    "read": "derive.spec.toml.read",
    "time_function": "derive.spec.parsing.time_expression",
}

__all__ = [
    "BeamBody",
    "BodyFrame",
    "Damping",
    "Deflection",
    "Drive",
    "Equations",
    "File",
    "Force",
    "Frame",
    "GenericEquations",
    "InitialGuess",
    "Joint",
    "Marker",
    "MarkerRef",
    "ModalBody",
    "Model",
    "Native",
    "NodalBody",
    "NodeData",
    "NodeMarker",
    "Parameter",
    "PlanarBeam",
    "Plot",
    "PointMarker",
    "ReferenceCurve",
    "RigidBody",
    "Scene",
    "Simulation",
    "SpecError",
    "Spring",
    "SymbolicBody",
    "TimeFunction",
    "TisserandError",
    "Torque",
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
    "scene",
    "symbolic_body",
    "time_function",
    "validated",
    "write",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
