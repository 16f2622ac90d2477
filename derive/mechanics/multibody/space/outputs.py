"""The kinds of outputs of a scene in space: what they are called, and their expressions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.multibody.outputs.energies import Energies, Powers, material_damping
from derive.mechanics.multibody.space.joints import Freedom
from derive.mechanics.multibody.space.marker_outputs import FRAME, LABELS, MARKER_OUTPUTS, along, observer
from derive.mechanics.multibody.space.output_parts import SpatialComponent, SpatialOutputType, SpatialParts
from derive.mechanics.multibody.space.section_monitors import SPATIAL_MONITORS
from derive.mechanics.multibody.space.section_outputs import SECTION_OUTPUTS
from derive.mechanics.terms import ModelConstant, OutputEquation
from derive.registry import Registry
from derive.spec.model.instances import identifier, joined
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_forces import SpatialJointLoad, SpatialJointTorque, SpatialSpring

JOINT = Key("joint", KeyType.JOINT, "", "Name of the joint.", required=True)
DRIVE = Key("drive", KeyType.DRIVE, "", "Name of the drive.", required=True)
SPRING = Key("spring", KeyType.SPRING, "", "Name of the spring.", required=True)
LOAD = Key("load", KeyType.JOINT_LOAD, "", "Name of a force or a torque in a joint.", required=True)
_OF_LOAD = (*LABELS, *(f"torque{k}" for k in AXES))
"""The labels of a force and a torque."""


def _joint_coordinate(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    joint = values["joint"]
    of = parts.motion(joint)
    doc = f"relative motion in joint {joint}" + ("" if of.counted else ", a rotation from -pi to pi")
    return (SpatialComponent("", of.freedom.unit, doc, of.motion.value),)


def _joint_speed(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    joint = values["joint"]
    of = parts.motion(joint)
    doc = f"rate of the relative motion in joint {joint}"
    return (SpatialComponent("", f"{of.freedom.unit}/s", doc, of.motion.rate),)


def _energy(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    kinetic, strain, weight = (sp.Add(*(i.energies[k] for i in parts.instances.values())) for k in range(3))
    strain += sp.Add(*(action.potential for action in parts.actions))
    return (
        SpatialComponent("kinetic", "J", "kinetic energy", kinetic),
        SpatialComponent("strain", "J", "strain energy, with that of springs", strain),
        SpatialComponent("gravity", "J", "potential of gravity", weight),
        SpatialComponent("total", "J", "kinetic energy and potentials", kinetic + strain + weight),
    )


def _reaction(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    return _force_and_torque(*parts.reaction(values["joint"]), f"of joint {values['joint']} on body 2", values, parts)


def _force_and_torque(
    force: sp.Matrix, torque: sp.Matrix, text: str, values: Mapping[str, Any], parts: SpatialParts
) -> tuple[SpatialComponent, ...]:
    """The components of a force and a torque in the frame; `text` is what follows their noun in descriptions."""
    frame, name = observer(values, parts)
    force, torque = along(frame, force), along(frame, torque)
    axes = "along e{0} of " + name if FRAME.name in values else "along e{0}"
    return (
        *(SpatialComponent(str(k), "N", f"force {text} {axes.format(k)}", force[k - 1]) for k in AXES),
        *(SpatialComponent(f"torque{k}", "N m", f"torque {text} {axes.format(k)}", torque[k - 1]) for k in AXES),
    )


def _drive(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    name = values["drive"]
    _, _, driven = parts.drive(name)
    noun, unit = ("torque", "N m") if driven is Freedom.ROTATION else ("force", "N")
    return (SpatialComponent("", unit, f"{noun} of drive {name} on body 2", parts.drive_force(name)),)


def _spring(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    spring = next(s for s in parts.scene.springs if s.name == values["spring"])
    (action,) = (action for action in parts.actions if action.element == spring)
    load = next(load for load in action.loads if load.marker == spring.second)
    return _force_and_torque(load.force, load.torque, f"of spring {spring.name} on {spring.second}", values, parts)


def _joint_load(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    (action,) = (
        a for a in parts.actions if isinstance(a.element, SpatialJointLoad) and a.element.name == values["load"]
    )
    of, value = action.element, action.value
    unit = "N m" if isinstance(of, SpatialJointTorque) else "N"
    return (
        SpatialComponent("", unit, f"{of.kind} {of.name} on body 2 of its joint", value),
        SpatialComponent("power", "W", f"power of {of.kind} {of.name}", parts.power(action.loads)),
    )


def _power(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    loads = [parts.power(a.loads) for a in parts.actions if not isinstance(a.element, SpatialSpring)]
    driven = [(d.name, parts.drive(d.name)[1].motion[1]) for d in parts.scene.drives]
    drives = [parts.drive_force(name) * speed for name, speed in driven]
    dissipated = sp.Add(*(action.dissipation for action in parts.actions))
    dissipated += sp.Add(*map(material_damping, parts.instances.values()), *parts.dissipations)
    return (
        SpatialComponent("loads", "W", "power of forces and torques", sp.Add(*loads)),
        SpatialComponent("drives", "W", "power of the drives", sp.Add(*drives)),
        SpatialComponent("dissipated", "W", "power of dampers and of material damping", dissipated),
    )


SPATIAL_OUTPUTS: Registry[SpatialOutputType] = Registry(
    "output in space",
    {
        **MARKER_OUTPUTS,
        **SECTION_OUTPUTS,
        "joint": SpatialOutputType(
            "rotation about z of a joint with parallel z axes, or displacement of a prismatic one",
            (JOINT,),
            ("",),
            _joint_coordinate,
            of_motion=True,
        ),
        "joint_speed": SpatialOutputType("rate of that motion", (JOINT,), ("",), _joint_speed, of_motion=True),
        "energy": SpatialOutputType(Energies.doc, (), Energies.labels, _energy, counts_inertia=True, adds=True),
        "reaction": SpatialOutputType(
            "what a joint exerts on body 2, with its drive, the torque about the second marker",
            (JOINT, FRAME),
            _OF_LOAD,
            _reaction,
            counts_inertia=True,
        ),
        "drive": SpatialOutputType("the torque or the force of a drive", (DRIVE,), ("",), _drive, counts_inertia=True),
        "spring": SpatialOutputType(
            "what a spring with its damper exerts on its second marker, the torque about this marker",
            (SPRING, FRAME),
            _OF_LOAD,
            _spring,
        ),
        "joint_load": SpatialOutputType(
            "the force or the torque of a load in a joint, and its power", (LOAD,), ("", "power"), _joint_load
        ),
        "power": SpatialOutputType(Powers.doc, (), Powers.labels, _power, counts_inertia=True, adds=True),
    },
    doc="""The kinds of outputs in space by their names, which are the values of `kind` in [outputs.NAME].

    `derive.SPATIAL_OUTPUTS.register(name, member)` adds one of your own, a `derive.extensions.SpatialOutputType` with
    its keys and the function that gives its components.

    Examples:
        >>> import derive
        >>> derive.SPATIAL_OUTPUTS["joint_speed"].doc
        'rate of that motion'
    """,
)


def spatial_output_type(kind: str) -> SpatialOutputType:
    """The type of an output of a scene in space, or of one that a simulation adds. Raises UnknownNameError."""
    return SPATIAL_MONITORS[kind] if kind in SPATIAL_MONITORS else SPATIAL_OUTPUTS[kind]


def spatial_output_equations(
    outputs: tuple[SceneOutput, ...], parts: SpatialParts
) -> tuple[tuple[OutputEquation, ...], tuple[ModelConstant, ...]]:
    """The components of all outputs of a scene, and the constants in them alone."""
    equations: list[OutputEquation] = []
    constants: dict[sp.Symbol, ModelConstant] = {}
    for output in outputs:
        for part in spatial_output_type(output.kind).components(output.values, parts):
            shown = joined(output.name, part.label)
            equations.append(OutputEquation(identifier(shown), shown, part.unit, part.doc, part.expr))
            constants |= {c.symbol: c for c in part.constants}
    return tuple(equations), tuple(constants.values())
