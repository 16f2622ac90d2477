"""The contents of a scene as frozen data: planar bodies, joints, drives, forces, and what to simulate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from derive.display import html
from derive.short_text import record_text
from derive.spec.model.body import GRAVITY
from derive.spec.model.documentation import documented
from derive.spec.model.forces import Bushing, CustomForce, Force, Spring, Torque
from derive.spec.model.joints import Drive, Joint
from derive.spec.model.keys import KeyType, key
from derive.spec.model.markers import PointMarker
from derive.spec.model.planar_bodies import POINTS, SceneBody
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import UNIT, Quantity
from derive.spec.model.simulation import Simulation
from derive.spec.model.spec_text import scene_text
from derive.spec.model.time_function import TimeFunction

NAMED = {
    "bodies": "body",
    "joints": "joint",
    "drives": "drive",
    "gears": "gear",
    "forces": "force",
    "torques": "torque",
    "springs": "spring",
    "plots": "plot",
    "inputs": "input",
    "outputs": "output",
}
"""The sections of a scene whose elements have names, with the noun for one element; gears are in space alone."""


@dataclass(frozen=True)
class SceneInput:
    """A run-time input of the generated code, which forces, torques and drives refer to by its name."""

    name: str
    unit: Annotated[str, UNIT] = ""
    function: Annotated[
        TimeFunction | None,
        key(KeyType.FUNCTION, "What the input is in simulations: a number, or a function of t.", name="value"),
    ] = None
    __repr__ = record_text


SceneStart = Literal["equilibrium", "steady"]
SceneLowering = Literal["auto", "flat", "instances"]
EQUILIBRIUM: SceneStart = "equilibrium"
"""The value of `start` for which the initial state of a scene is its static equilibrium."""
STEADY: SceneStart = "steady"
"""The value of `start` for which it is a steady motion with the initial velocities."""

Redundant = Literal["auto", "resolve", "error"]
"""The treatment of redundant joints."""


@documented
@dataclass(frozen=True)
class Scene:
    """Planar bodies with joints, drives, forces and gravity.

    Attributes:
        name: the name of the model.
        bodies: rigid bodies, beams and bodies of registered types.
        simulation: duration, output and tolerance of a simulation.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -9.81), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> ball.gravity
        (Fraction(0, 1), Fraction(-981, 100))
    """

    name: str
    ground: Annotated[tuple[PointMarker, ...], POINTS]
    gravity: Annotated[tuple[Quantity, Quantity] | None, key(KeyType.PLANAR_ACCELERATION, GRAVITY, optional=True)]
    bodies: tuple[SceneBody, ...]
    joints: Annotated[tuple[Joint, ...], key(Joint, "Joints by name.", example="[joints.pin]", default=())]
    drives: Annotated[
        tuple[Drive, ...], key(Drive, "Prescribed motions of joints by name.", example="[drives.motor]")
    ] = ()
    forces: Annotated[tuple[Force | CustomForce, ...], key(Force, "Forces by name.", example="[forces.load]")] = ()
    torques: Annotated[tuple[Torque | CustomForce, ...], key(Torque, "Torques by name.", example="[torques.load]")] = ()
    springs: Annotated[
        tuple[Spring | Bushing | CustomForce, ...],
        key(Spring, "Springs and dampers by name.", example="[springs.mount]"),
    ] = ()
    simulation: Simulation | None = None
    plots: Annotated[tuple[Plot, ...], key(Plot, "Plots of a simulation by name.", example="[plots.deflection]")] = ()
    start: Annotated[
        SceneStart | None,
        key(
            KeyType.CHOICE,
            '"equilibrium": the motion begins in the static equilibrium, computed with the loads and drives at t = 0; '
            "initial positions of bodies and joints are then its first guess. "
            '"steady": it begins in a steady motion, at rest in axes that rotate at a constant speed or translate; '
            "initial velocities and drives determine which.",
            choice_of="the start of a scene",
        ),
    ] = None
    redundant: Annotated[
        Redundant,
        key(
            KeyType.CHOICE,
            "The treatment of redundant joints, whose motion is determined and whose reactions are not. auto: those of "
            "least norm are computed where joints are redundant; resolve: always, which takes longer, also through "
            "singular positions; error: redundant joints are refused.",
            choice_of="redundant joints",
        ),
    ] = "auto"
    inputs: Annotated[
        tuple[SceneInput, ...], key(SceneInput, "Run-time inputs by name.", example="[inputs.motor]")
    ] = ()
    outputs: Annotated[tuple[SceneOutput, ...], key(SceneOutput, "Outputs by name.", example="[outputs.tip]")] = ()
    lowering: Annotated[
        SceneLowering,
        key(
            KeyType.CHOICE,
            "Code of bodies and joints: flat (unrolled), instances (loops over all of a kind), or auto (the faster, as "
            "predicted).",
            default="auto",
            choice_of="the lowering of a scene",
        ),
    ] = "auto"
    _repr_html_ = html

    def __repr__(self) -> str:
        return scene_text(self, NAMED)
