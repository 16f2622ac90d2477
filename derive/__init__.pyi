"""The types of the public names of Tisserand; `derive/__init__.py` imports each of them when it is first used."""

from derive.artifacts import File as File, write as write
from derive.derivation import derive as derive, derive_modal as derive_modal, modal as modal, parameters as parameters
from derive.errors import SpecError as SpecError, TisserandError as TisserandError
from derive.export.casadi.loading import casadi_function as casadi_function
from derive.export.host_model import HostModel as HostModel, host_model as host_model
from derive.export.registry import exported as exported
from derive.ir.interpreter import interpret as interpret
from derive.ir.model import Model as Model
from derive.mechanics.bodies.modal_body import ModalBody as ModalBody
from derive.mechanics.equations import Equations as Equations
from derive.mechanics.multibody.bodies.registry import BODIES as BODIES
from derive.mechanics.multibody.forces.registry import FORCES as FORCES
from derive.mechanics.multibody.joints.registry import JOINTS as JOINTS
from derive.mechanics.multibody.mechanism import Mechanism as Mechanism
from derive.mechanics.multibody.outputs.registry import OUTPUTS as OUTPUTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS as SPATIAL_JOINTS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS as SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.springs import SPATIAL_SPRINGS as SPATIAL_SPRINGS
from derive.model_lowering import lower as lower
from derive.pipeline import model_files as model_files
from derive.registry import UnknownNameError as UnknownNameError
from derive.roles import Role as Role
from derive.runtime.compiled_model import Native as Native
from derive.runtime.compiler import CompilerError as CompilerError, vector_flags as vector_flags
from derive.runtime.integrators.c_integrator import Integration as Integration, IntegratorError as IntegratorError
from derive.runtime.integrators.fixed_step import FixedStep as FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha as GeneralisedAlpha
from derive.runtime.integrators.ida import Ida as Ida
from derive.runtime.inverse_dynamics import (
    DrivingForces as DrivingForces,
    MissingInputs as MissingInputs,
    inverse_dynamics as inverse_dynamics,
)
from derive.runtime.loading import load as load, load_scene as load_scene
from derive.runtime.native_call import ModelError as ModelError
from derive.runtime.native_scene import NativeScene as NativeScene
from derive.runtime.requested_functions import RequestedFunctions as RequestedFunctions
from derive.simulation.equilibrium import Equilibrium as Equilibrium, equilibrium as equilibrium
from derive.simulation.errors import SimulationError as SimulationError
from derive.simulation.initial.initial_state import InitialState as InitialState, initial_state as initial_state
from derive.simulation.integration.registry import INTEGRATORS as INTEGRATORS
from derive.simulation.integration.scipy_methods import integrate as integrate
from derive.simulation.integration.solution import Solution as Solution
from derive.simulation.linear.eigenmodes import Mode as Mode
from derive.simulation.linear.linearisation import Linearisation as Linearisation
from derive.simulation.linear.modes import Modes as Modes, modes as modes
from derive.simulation.simulate import simulate as simulate
from derive.simulation.trajectory import Trajectory as Trajectory
from derive.spec.construction.bodies import (
    nodal_body as nodal_body,
    planar_beam as planar_beam,
    symbolic_body as symbolic_body,
)
from derive.spec.construction.scenes import scene as scene, spatial_scene as spatial_scene
from derive.spec.construction.validated import validated as validated
from derive.spec.model.beam import PlanarBeam as PlanarBeam
from derive.spec.model.beam_parts import (
    AttachedMass as AttachedMass,
    BeamDamping as BeamDamping,
    Frame as Frame,
    Marker as Marker,
)
from derive.spec.model.body import (
    BodyFrame as BodyFrame,
    Damping as Damping,
    NodalBody as NodalBody,
    SymbolicBody as SymbolicBody,
)
from derive.spec.model.forces import (
    Bushing as Bushing,
    CustomForce as CustomForce,
    Force as Force,
    Spring as Spring,
    Torque as Torque,
)
from derive.spec.model.joints import (
    CustomJoint as CustomJoint,
    Drive as Drive,
    Joint as Joint,
    JointInitialValues as JointInitialValues,
)
from derive.spec.model.markers import MarkerRef as MarkerRef, PointMarker as PointMarker
from derive.spec.model.mode_selection import ModeSelection as ModeSelection
from derive.spec.model.node_data import NodeData as NodeData
from derive.spec.model.node_markers import NodeMarker as NodeMarker
from derive.spec.model.planar_bodies import (
    BeamBody as BeamBody,
    CustomBody as CustomBody,
    DistributedLoad as DistributedLoad,
    RigidBody as RigidBody,
)
from derive.spec.model.plots import Deflection as Deflection, Plot as Plot, ReferenceCurve as ReferenceCurve
from derive.spec.model.quantity import Parameter as Parameter
from derive.spec.model.scene import Scene as Scene
from derive.spec.model.simulation import (
    InitialValues as InitialValues,
    Simulation as Simulation,
    SpatialStart as SpatialStart,
)
from derive.spec.model.spatial_beam import SpatialBeam as SpatialBeam
from derive.spec.model.spatial_beam_parts import LateralDeflection as LateralDeflection
from derive.spec.model.spatial_beam_parts import SectionFrame as SectionFrame
from derive.spec.model.spatial_beam_parts import TorsionalDeformation as TorsionalDeformation
from derive.spec.model.spatial_beam_parts import (
    SpatialAttachedMass as SpatialAttachedMass,
)
from derive.spec.model.spatial_beam_parts import (
    SpatialDistributedLoad as SpatialDistributedLoad,
)
from derive.spec.model.spatial_bodies import (
    FlexibleBody as FlexibleBody,
    FrameMarker as FrameMarker,
    NodeFrame as NodeFrame,
    SpatialRigidBody as SpatialRigidBody,
)
from derive.spec.model.spatial_forces import (
    SpatialForce as SpatialForce,
    SpatialJointForce as SpatialJointForce,
    SpatialJointTorque as SpatialJointTorque,
    SpatialSpring as SpatialSpring,
    SpatialTorque as SpatialTorque,
)
from derive.spec.model.spatial_scene import (
    Gear as Gear,
    SpatialJoint as SpatialJoint,
    SpatialJointInitialValues as SpatialJointInitialValues,
    SpatialScene as SpatialScene,
)
from derive.spec.model.spatial_start import SpatialInitialValues as SpatialInitialValues
from derive.spec.model.time_function import TimeFunction as TimeFunction
from derive.spec.model.visuals import Visual as Visual
from derive.spec.parsing.time_expression import time_function as time_function
from derive.spec.toml.read import read as read
from derive.study.accuracy.ladder_chart import LadderChart as LadderChart
from derive.study.accuracy.study import study_accuracy as study_accuracy
from derive.study.choice.choose import choose as choose
from derive.study.choice.search import Choice as Choice
from derive.study.frame_study import FrameStudy as FrameStudy, study_frames as study_frames
from derive.study.methods.method_study import MethodStudy as MethodStudy, study_methods as study_methods
from derive.study.pivot_study import PivotStudy as PivotStudy, study_pivots as study_pivots
from derive.study.stability.ladder_stability import (
    LadderStability as LadderStability,
    study_stability as study_stability,
)
from derive.study.sweep.result import SweepResult as SweepResult
from derive.study.sweep.run import sweep as sweep
from derive.study.sweep.samples import (
    Samples as Samples,
    grid as grid,
    listed as listed,
    random_samples as random_samples,
)

__version__: str
