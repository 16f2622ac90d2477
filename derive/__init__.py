"""Tisserand: a compiler for flexible multibody dynamics, from a specification to C and Python kernels.

    beam = derive.read("scenes/free_beam_mean.toml")    # or derive.planar_beam(...)
    equations = derive.derive(beam)                     # SymPy, named terms
    model = derive.lower(equations)                     # kernels with explicit sparsity
    files = derive.model_files(model, beam)             # C99, Python, manifest
    derive.write(files, "generated")
    native = derive.load(files)                         # compiled, called through NumPy

    scene = derive.read("scenes/crank_slider_3.toml")
    trajectory = derive.simulate(scene)                 # consistent initialisation and integration

The public interface, by stages:

    specification   read, validated; scene, spatial_scene, planar_beam, nodal_body, symbolic_body
                    bodies: PlanarBeam with AttachedMass and BeamDamping, SymbolicBody, NodalBody with NodeData,
                    NodeMarker, BodyFrame, Damping, ModeSelection
                    scenes: Scene, RigidBody, BeamBody, PointMarker, MarkerRef, InitialValues, JointInitialValues,
                    Joint, Drive, Force, Torque, Spring, Bushing, DistributedLoad, TimeFunction, time_function, Plot,
                    Deflection, ReferenceCurve
                    in space: SpatialScene, SpatialRigidBody, FlexibleBody, FrameMarker, NodeFrame, Visual,
                    SpatialJoint, Gear, SpatialBeam, SectionFrame, LateralDeflection, TorsionalDeformation,
                    SpatialAttachedMass, SpatialDistributedLoad,
                    SpatialForce, SpatialTorque, SpatialJointForce, SpatialJointTorque,
                    SpatialSpring, SpatialInitialValues, SpatialJointInitialValues
                    all: Frame, Marker, Parameter, Simulation; SpatialStart of a body in space
                    registries: JOINTS, BODIES, FORCES, OUTPUTS; CustomJoint, CustomBody, CustomForce; in space
                    SPATIAL_JOINTS, SPATIAL_SPRINGS, SPATIAL_OUTPUTS
    equations       derive, modal, derive_modal, parameters; ModalBody; Equations of a body, or for a scene a
                    Mechanism, which keeps the equations once for each kind of body
    kernels         lower, interpret; Model
    files           model_files, write; File
    compiled code   load, load_scene, vector_flags; Native, NativeScene, RequestedFunctions, Role; inverse_dynamics,
                    DrivingForces
    modes           modes; Modes, Mode, Linearisation
    simulation      simulate, initial_state, equilibrium, integrate; Trajectory, Solution,
                    InitialState, Equilibrium, INTEGRATORS
    studies         choose, study_accuracy, study_stability, study_methods, study_frames, study_pivots; Choice,
                    LadderChart, LadderStability, MethodStudy, FrameStudy, PivotStudy
    sweeps          sweep; grid, listed, random_samples; Samples, SweepResult
    other programs  exported, host_model, casadi_function; HostModel
    C integrators   FixedStep, GeneralisedAlpha, Ida; Integration
    errors          TisserandError and its subclasses SpecError, UnknownNameError, CompilerError, ModelError,
                    IntegratorError, SimulationError, MissingInputs

Names are imported when they are first used, so that `import derive` is fast and nothing pays for what it does not need.
The module of each of them is in `__init__.pyi`, where type checkers look too.
"""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path
from typing import Any

from derive import display as _display
from derive.version import VERSION as __version__  # noqa: N811  the name Python expects


def _modules_of_names() -> dict[str, str]:
    """The module that each public name is imported from, which the stub of this package lists."""
    stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = (node for node in stub.body if isinstance(node, ast.ImportFrom))
    return {alias.name: str(node.module) for node in imports for alias in node.names if alias.name == alias.asname}


_MODULE_OF = _modules_of_names()
__all__ = ["__version__", *_MODULE_OF]  # noqa: PLE0604  names are texts


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    return getattr(import_module(_MODULE_OF[name]), name)


def __dir__() -> list[str]:
    return __all__


_display.register(
    lambda shown: str(import_module("derive.notebook.html").html(shown)),
    lambda shown: import_module("derive.notebook.tables").data_frame(shown),
)
