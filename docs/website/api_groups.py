"""The pages of the reference of the Python API: the public names of `derive`, grouped by their use."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Group:
    """A page of the reference.

    title: its heading; text: what its names are for; names: sections, each with a heading (none if it is empty) and its
    public names in order. constructed: whether users construct its classes, so that their arguments are of interest.
    """

    title: str
    text: str
    names: dict[str, str]
    constructed: bool = False


GROUPS = {
    "specify": Group(
        "Specify bodies and scenes",
        "Functions that read or make a specification. A scene may mix tables, as in a TOML file, with the types of the "
        "[next page](specification_types.md).",
        {"": "read scene spatial_scene planar_beam nodal_body symbolic_body validated time_function"},
    ),
    "specification_types": Group(
        "Types of specifications",
        "What the functions that make specifications return and accept: frozen dataclasses, whose fields are keys of "
        "the [TOML files](../reference_toml.md).",
        {
            "Bodies": "PlanarBeam AttachedMass BeamDamping Frame Marker SymbolicBody NodalBody NodeData NodeMarker "
            "BodyFrame Damping ModeSelection Parameter",
            "Scenes in the plane": "Scene RigidBody BeamBody CustomBody PointMarker MarkerRef Joint CustomJoint Drive "
            "Force Torque Spring Bushing DistributedLoad CustomForce InitialValues JointInitialValues",
            "Scenes in space": "SpatialScene SpatialRigidBody FlexibleBody FrameMarker NodeFrame Visual SpatialJoint "
            "Gear SpatialBeam SectionFrame LateralDeflection TorsionalDeformation "
            "SpatialAttachedMass SpatialDistributedLoad "
            "SpatialForce SpatialTorque SpatialJointForce SpatialJointTorque SpatialSpring SpatialInitialValues "
            "SpatialJointInitialValues SpatialStart",
            "Simulations and plots": "Simulation TimeFunction Plot Deflection ReferenceCurve",
        },
        constructed=True,
    ),
    "derive": Group(
        "Derive equations and kernels",
        "From a specification to its equations of motion in SymPy, and from these to kernels with explicit sparsity.",
        {"": "derive modal derive_modal parameters ModalBody Equations Mechanism lower interpret Model"},
    ),
    "build": Group(
        "Build and load code",
        "From kernels to files of C and Python, and from these to functions that NumPy calls. What the functions "
        "compute, and what their return codes mean, is on the page of [the generated code](../generated_code.md).",
        {
            "": "model_files write File load load_scene vector_flags Native NativeScene RequestedFunctions Role "
            "inverse_dynamics DrivingForces"
        },
    ),
    "simulate": Group(
        "Simulate",
        "Consistent initial states, integration, and trajectories as named columns.",
        {
            "": "simulate Trajectory initial_state InitialState integrate Solution",
            "Integrators in C": "FixedStep GeneralisedAlpha Ida Integration",
        },
    ),
    "analyse": Group(
        "Analyse",
        "Static equilibria, natural frequencies and linearised models.",
        {"": "equilibrium Equilibrium modes Modes Mode Linearisation"},
    ),
    "study": Group(
        "Studies and sweeps",
        "What models of beams and methods of integration cost, and where they fail; and simulations with many sets of "
        "parameters, on the processors of one machine or of many.",
        {
            "Studies": "choose Choice study_accuracy LadderChart study_stability LadderStability study_methods "
            "MethodStudy study_frames FrameStudy study_pivots PivotStudy",
            "Sweeps": "sweep grid listed random_samples Samples SweepResult",
        },
    ),
    "export": Group(
        "Export to other programs",
        "Models for FMI, CasADi, SUNDIALS and other [hosts](../hosts.md).",
        {"": "exported host_model HostModel casadi_function"},
    ),
    "errors": Group(
        "Errors",
        "Every error that Tisserand raises on purpose is a `TisserandError`, whose text says what to do.",
        {
            "": "TisserandError SpecError UnknownNameError CompilerError ModelError IntegratorError SimulationError "
            "MissingInputs",
        },
    ),
    "registries": Group(
        "Registries",
        "Joints, bodies, forces, outputs and integrators of your own are registered here.",
        {"": "JOINTS BODIES FORCES OUTPUTS SPATIAL_JOINTS SPATIAL_SPRINGS SPATIAL_OUTPUTS INTEGRATORS __version__"},
    ),
}
"""The pages by the names of their files."""


def names(group: Group) -> list[str]:
    """The public names on a page."""
    return [name for section in group.names.values() for name in section.split()]
