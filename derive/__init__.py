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
                    NodeMarker, BodyFrame, Damping
                    scenes: Scene, RigidBody, BeamBody, PointMarker, MarkerRef, InitialValues, JointInitialValues,
                    Joint, Drive, Force, Torque, Spring, Bushing, DistributedLoad, TimeFunction, time_function, Plot,
                    Deflection, ReferenceCurve
                    in space: SpatialScene, SpatialRigidBody, FlexibleBody, FrameMarker, NodeFrame, SpatialJoint, Gear,
                    SpatialForce, SpatialTorque, SpatialJointForce, SpatialJointTorque,
                    SpatialSpring, SpatialInitialValues, SpatialJointInitialValues
                    all: Frame, Marker, Parameter, Simulation; SpatialStart of a body in space
                    registries: JOINTS, BODIES, FORCES, OUTPUTS; CustomJoint, CustomBody, CustomForce
    equations       derive, modal, derive_modal, parameters; ModalBody; Equations of a body, or for a scene a
                    Mechanism, which keeps the equations once for each kind of body
    kernels         lower, interpret; Model
    files           model_files, write; File
    compiled code   load, load_scene, vector_flags; Native, NativeScene, Role
    modes           modes; Modes, Mode, Linearisation
    simulation      simulate, initial_state, equilibrium, integrate; Trajectory, Solution,
                    InitialState, Equilibrium, INTEGRATORS
    sweeps          sweep; grid, listed, random_samples; Samples, SweepResult
    other programs  exported, host_model, casadi_function; HostModel
    C integrators   FixedStep, GeneralisedAlpha, Ida; Integration
    errors          TisserandError and its subclasses SpecError, UnknownNameError, CompilerError, ModelError,
                    IntegratorError, SimulationError

Names are imported when they are first used, so that `import derive` is fast and nothing pays for what it does not need.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from derive import display as _display
from derive.version import VERSION as __version__  # noqa: N811  the name Python expects

if TYPE_CHECKING:
    from derive.artifacts import File, write
    from derive.derivation import derive, derive_modal, lower, modal, parameters
    from derive.errors import SpecError, TisserandError
    from derive.export.casadi.loading import casadi_function
    from derive.export.host_model import HostModel, host_model
    from derive.export.registry import exported
    from derive.ir.interpreter import interpret
    from derive.ir.model import Model
    from derive.mechanics.bodies.modal_body import ModalBody
    from derive.mechanics.equations import Equations
    from derive.mechanics.multibody.bodies.registry import BODIES
    from derive.mechanics.multibody.forces.registry import FORCES
    from derive.mechanics.multibody.joints.registry import JOINTS
    from derive.mechanics.multibody.mechanism import Mechanism
    from derive.mechanics.multibody.outputs.registry import OUTPUTS
    from derive.pipeline import model_files
    from derive.registry import UnknownNameError
    from derive.roles import Role
    from derive.runtime.compiled_model import Native
    from derive.runtime.compiler import CompilerError, vector_flags
    from derive.runtime.integrators.c_integrator import Integration, IntegratorError
    from derive.runtime.integrators.fixed_step import FixedStep
    from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
    from derive.runtime.integrators.ida import Ida
    from derive.runtime.loading import load, load_scene
    from derive.runtime.native_call import ModelError
    from derive.runtime.native_scene import NativeScene
    from derive.simulation.equilibrium import Equilibrium, equilibrium
    from derive.simulation.errors import SimulationError
    from derive.simulation.initial.initial_state import InitialState, initial_state
    from derive.simulation.integration.registry import INTEGRATORS
    from derive.simulation.integration.scipy_methods import integrate
    from derive.simulation.integration.solution import Solution
    from derive.simulation.linear.eigenmodes import Mode
    from derive.simulation.linear.linearisation import Linearisation
    from derive.simulation.linear.modes import Modes, modes
    from derive.simulation.simulate import simulate
    from derive.simulation.trajectory import Trajectory
    from derive.spec.construction import nodal_body, planar_beam, scene, spatial_scene, symbolic_body, validated
    from derive.spec.model.beam import PlanarBeam
    from derive.spec.model.beam_parts import AttachedMass, BeamDamping, Frame, Marker
    from derive.spec.model.body import BodyFrame, Damping, NodalBody, NodeData, NodeMarker, SymbolicBody
    from derive.spec.model.forces import Bushing, CustomForce, Force, Spring, Torque
    from derive.spec.model.markers import MarkerRef, PointMarker
    from derive.spec.model.plots import Deflection, Plot, ReferenceCurve
    from derive.spec.model.quantity import Parameter
    from derive.spec.model.scene import (
        BeamBody,
        CustomBody,
        CustomJoint,
        DistributedLoad,
        Drive,
        Joint,
        JointInitialValues,
        RigidBody,
        Scene,
    )
    from derive.spec.model.simulation import InitialValues, Simulation, SpatialStart
    from derive.spec.model.spatial_bodies import (
        FlexibleBody,
        FrameMarker,
        NodeFrame,
        SpatialInitialValues,
        SpatialRigidBody,
    )
    from derive.spec.model.spatial_forces import (
        SpatialForce,
        SpatialJointForce,
        SpatialJointTorque,
        SpatialSpring,
        SpatialTorque,
    )
    from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialJointInitialValues, SpatialScene
    from derive.spec.model.time_function import TimeFunction
    from derive.spec.parsing.time_expression import time_function
    from derive.spec.toml.read import read
    from derive.study.sweep.result import SweepResult
    from derive.study.sweep.run import sweep
    from derive.study.sweep.samples import Samples, grid, listed, random_samples

_MODULES = {
    "derive.artifacts": (
        "File",
        "write",
    ),
    "derive.derivation": (
        "derive",
        "derive_modal",
        "lower",
        "modal",
        "parameters",
    ),
    "derive.errors": (
        "SpecError",
        "TisserandError",
    ),
    "derive.export.casadi.loading": ("casadi_function",),
    "derive.export.host_model": ("HostModel", "host_model"),
    "derive.export.registry": ("exported",),
    "derive.ir.interpreter": ("interpret",),
    "derive.ir.model": ("Model",),
    "derive.mechanics.bodies.modal_body": ("ModalBody",),
    "derive.mechanics.equations": ("Equations",),
    "derive.mechanics.multibody.bodies.registry": ("BODIES",),
    "derive.mechanics.multibody.forces.registry": ("FORCES",),
    "derive.mechanics.multibody.joints.registry": ("JOINTS",),
    "derive.mechanics.multibody.mechanism": ("Mechanism",),
    "derive.mechanics.multibody.outputs.registry": ("OUTPUTS",),
    "derive.pipeline": ("model_files",),
    "derive.registry": ("UnknownNameError",),
    "derive.roles": ("Role",),
    "derive.runtime.native_call": ("ModelError",),
    "derive.runtime.compiler": (
        "CompilerError",
        "vector_flags",
    ),
    "derive.runtime.integrators.c_integrator": (
        "Integration",
        "IntegratorError",
    ),
    "derive.runtime.integrators.fixed_step": ("FixedStep",),
    "derive.runtime.integrators.generalised_alpha": ("GeneralisedAlpha",),
    "derive.runtime.integrators.ida": ("Ida",),
    "derive.runtime.compiled_model": ("Native",),
    "derive.runtime.loading": (
        "load",
        "load_scene",
    ),
    "derive.runtime.native_scene": ("NativeScene",),
    "derive.simulation.equilibrium": ("Equilibrium", "equilibrium"),
    "derive.simulation.errors": ("SimulationError",),
    "derive.simulation.initial.initial_state": (
        "InitialState",
        "initial_state",
    ),
    "derive.simulation.integration.registry": ("INTEGRATORS",),
    "derive.simulation.integration.scipy_methods": ("integrate",),
    "derive.simulation.integration.solution": ("Solution",),
    "derive.simulation.linear.eigenmodes": ("Mode",),
    "derive.simulation.linear.linearisation": ("Linearisation",),
    "derive.simulation.linear.modes": (
        "Modes",
        "modes",
    ),
    "derive.simulation.simulate": ("simulate",),
    "derive.simulation.trajectory": ("Trajectory",),
    "derive.spec.construction": (
        "nodal_body",
        "planar_beam",
        "scene",
        "spatial_scene",
        "symbolic_body",
        "validated",
    ),
    "derive.spec.model.beam": ("PlanarBeam",),
    "derive.spec.model.beam_parts": (
        "AttachedMass",
        "BeamDamping",
        "Frame",
        "Marker",
    ),
    "derive.spec.model.body": (
        "BodyFrame",
        "Damping",
        "NodalBody",
        "NodeData",
        "NodeMarker",
        "SymbolicBody",
    ),
    "derive.spec.model.forces": (
        "Bushing",
        "CustomForce",
        "Force",
        "Spring",
        "Torque",
    ),
    "derive.spec.model.markers": (
        "MarkerRef",
        "PointMarker",
    ),
    "derive.spec.model.plots": (
        "Deflection",
        "Plot",
        "ReferenceCurve",
    ),
    "derive.spec.model.quantity": ("Parameter",),
    "derive.spec.model.scene": (
        "BeamBody",
        "CustomBody",
        "CustomJoint",
        "DistributedLoad",
        "Drive",
        "Joint",
        "JointInitialValues",
        "RigidBody",
        "Scene",
    ),
    "derive.spec.model.simulation": (
        "InitialValues",
        "Simulation",
        "SpatialStart",
    ),
    "derive.spec.model.spatial_bodies": (
        "FlexibleBody",
        "FrameMarker",
        "NodeFrame",
        "SpatialInitialValues",
        "SpatialRigidBody",
    ),
    "derive.spec.model.spatial_forces": (
        "SpatialForce",
        "SpatialJointForce",
        "SpatialJointTorque",
        "SpatialSpring",
        "SpatialTorque",
    ),
    "derive.spec.model.spatial_scene": ("Gear", "SpatialJoint", "SpatialJointInitialValues", "SpatialScene"),
    "derive.spec.model.time_function": ("TimeFunction",),
    "derive.spec.parsing.time_expression": ("time_function",),
    "derive.spec.toml.read": ("read",),
    "derive.study.sweep.result": ("SweepResult",),
    "derive.study.sweep.run": ("sweep",),
    "derive.study.sweep.samples": (
        "Samples",
        "grid",
        "listed",
        "random_samples",
    ),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "BODIES",
    "FORCES",
    "INTEGRATORS",
    "JOINTS",
    "OUTPUTS",
    "AttachedMass",
    "BeamBody",
    "BeamDamping",
    "BodyFrame",
    "Bushing",
    "CompilerError",
    "CustomBody",
    "CustomForce",
    "CustomJoint",
    "Damping",
    "Deflection",
    "DistributedLoad",
    "Drive",
    "Equations",
    "Equilibrium",
    "File",
    "FixedStep",
    "FlexibleBody",
    "Force",
    "Frame",
    "FrameMarker",
    "Gear",
    "GeneralisedAlpha",
    "HostModel",
    "Ida",
    "InitialState",
    "InitialValues",
    "Integration",
    "IntegratorError",
    "Joint",
    "JointInitialValues",
    "Linearisation",
    "Marker",
    "MarkerRef",
    "Mechanism",
    "ModalBody",
    "Mode",
    "Model",
    "ModelError",
    "Modes",
    "Native",
    "NativeScene",
    "NodalBody",
    "NodeData",
    "NodeFrame",
    "NodeMarker",
    "Parameter",
    "PlanarBeam",
    "Plot",
    "PointMarker",
    "ReferenceCurve",
    "RigidBody",
    "Role",
    "Samples",
    "Scene",
    "Simulation",
    "SimulationError",
    "Solution",
    "SpatialForce",
    "SpatialInitialValues",
    "SpatialJoint",
    "SpatialJointForce",
    "SpatialJointInitialValues",
    "SpatialJointTorque",
    "SpatialRigidBody",
    "SpatialScene",
    "SpatialSpring",
    "SpatialStart",
    "SpatialTorque",
    "SpecError",
    "Spring",
    "SweepResult",
    "SymbolicBody",
    "TimeFunction",
    "TisserandError",
    "Torque",
    "Trajectory",
    "UnknownNameError",
    "__version__",
    "casadi_function",
    "derive",
    "derive_modal",
    "equilibrium",
    "exported",
    "grid",
    "host_model",
    "initial_state",
    "integrate",
    "interpret",
    "listed",
    "load",
    "load_scene",
    "lower",
    "modal",
    "model_files",
    "modes",
    "nodal_body",
    "parameters",
    "planar_beam",
    "random_samples",
    "read",
    "scene",
    "simulate",
    "spatial_scene",
    "sweep",
    "symbolic_body",
    "time_function",
    "validated",
    "vector_flags",
    "write",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    return getattr(import_module(_MODULE_OF[name]), name)


def __dir__() -> list[str]:
    return __all__


_display.register(lambda shown: str(import_module("derive.report.notebook").html(shown)))
