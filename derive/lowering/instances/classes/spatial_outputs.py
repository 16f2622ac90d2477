"""Outputs in space in groups that have one code: those that depend on the motions of the markers they name."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import Any, NoReturn

from derive.errors import Problem
from derive.lowering.instances.classes.body_classes import plain_joint
from derive.lowering.instances.classes.groups import (
    Bodies,
    Group,
    GroupElement,
    NotInLoops,
    fixed_of,
    group_equations,
)
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.multibody.space.joint_motion import JointMotion, joint_motion
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.multibody.space.output_parts import SpatialParts
from derive.mechanics.multibody.space.outputs import spatial_output_equations
from derive.mechanics.terms import OutputEquation
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.ports import SceneOutput

INSTEAD = '; use lowering = "flat" or "auto"'
"""The advice at the end of messages on functions that loops do not have."""


def spatial_output_groups(bodies: Bodies) -> Iterator[tuple[Group, Equations]]:
    """Yield the groups of the outputs, with the equations of the first of each. Raises NotInLoops for other outputs."""
    groups: dict[Hashable, list[GroupElement]] = {}
    made: dict[Hashable, Equations] = {}
    first = 0
    for number, output in enumerate(bodies.mechanism.scene.outputs):
        named = _Named(bodies)
        components = named.components(output)
        names = named.bodies
        order = tuple(names.index(m.body) if m.body in names else -1 for m in named.markers)
        key: Hashable = (
            output.kind,
            _plain(output, bodies),
            order,
            tuple(map(bodies.end, named.markers)),
            fixed_of(bodies, names),
        )
        element = GroupElement(number, tuple(bodies.members[name] for name in names), first)
        groups.setdefault(key, []).append(element)
        if key not in made:
            own = {name: bodies.equations(name) for name in names}
            made[key] = group_equations(bodies, own, GeneralisedForce(()), outputs=components)
        first += len(components)
    for key, members in groups.items():
        yield Group("output", tuple(members)), made[key]


def output_components(bodies: Bodies) -> tuple[OutputEquation, ...]:
    """The components of all outputs, of which the groups have the values."""
    every = (_Named(bodies).components(output) for output in bodies.mechanism.scene.outputs)
    return tuple(component for components in every for component in components)


def missing_outputs(bodies: Bodies) -> Iterator[Problem]:
    """Yield a problem for each output that depends on more than the motions of markers."""
    for output in bodies.mechanism.scene.outputs:
        try:
            _Named(bodies).components(output)
        except NotInLoops:
            yield Problem(
                f"outputs.{output.name}", f'loops over bodies in space have no output "{output.kind}"{INSTEAD}'
            )


def missing_gears(bodies: Bodies) -> Iterator[Problem]:
    """Yield a problem for each gear, which couples bodies of two joints."""
    for gear in bodies.mechanism.gears:
        yield Problem(f"gears.{gear.gear.name}", f"loops over bodies in space have no gears{INSTEAD}")


def _plain(output: SceneOutput, bodies: Bodies) -> Hashable:
    """The values of the keys of an output without names."""
    joints = bodies.mechanism.joints_by_name
    result: list[tuple[str, Hashable]] = []
    for key, value in output.values.items():
        if isinstance(value, str) and value in joints:
            joint = joints[value]
            result.append((key, (type(joint), joint.type, plain_joint(joint), joint.drive)))
        elif not isinstance(value, MarkerRef) and not _has_markers(value):
            result.append((key, value))
    return tuple(result)


def _has_markers(value: object) -> bool:
    return isinstance(value, tuple) and any(isinstance(part, MarkerRef) for part in value)


class _Named:
    """The markers that an output asks for, in their order."""

    def __init__(self, of: Bodies) -> None:
        self.of, self.markers = of, list[MarkerRef]()

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies with coordinates that have these markers."""
        return tuple(dict.fromkeys(m.body for m in self.markers if m.body in self.of.members))

    def at(self, marker: MarkerRef) -> FrameMotion:
        """The motion of a marker."""
        self.markers.append(marker)
        motion: FrameMotion = (
            self.of.equations(marker.body).motions[marker.marker]
            if marker.body in self.of.members
            else self.of.known.point(marker)
        )
        return motion

    def motion(self, joint: str) -> JointMotion:
        """The motion of a joint."""
        mechanism: SpatialMechanism = self.of.mechanism
        of = mechanism.joints_by_name[joint]
        for marker in (of.joint.first, of.joint.second):
            self.at(marker)
        names = [marker.body for marker in (of.joint.first, of.joint.second) if marker.body != GROUND]
        rows = tuple(row for name in names for row in mechanism.instance(name).coordinates.rows)
        return joint_motion(of, self.at, mechanism.instances_by_name, rows)

    def components(self, output: SceneOutput) -> tuple[OutputEquation, ...]:
        """The components of an output. Raises NotInLoops if it asks for more than motions."""
        mechanism: SpatialMechanism = self.of.mechanism
        nothing: Any = _Nothing()
        parts = SpatialParts(
            scene=mechanism.scene,
            at=self.at,
            instances=nothing,
            actions=nothing,
            joint_loads=nothing,
            supports=nothing,
            joints=mechanism.joints_by_name,
            drive_multipliers=nothing,
            motion=self.motion,
            gear_loads=nothing,
            dissipations=nothing,
        )
        return spatial_output_equations((output,), parts)[0]  # motions have no constants of their own


class _Nothing(Mapping[str, Any]):
    """Parts of a mechanism that outputs of motions do not ask for."""

    def _refuse(self, *_: object) -> NoReturn:
        raise NotInLoops("an output depends on more than the motions of markers")

    __getitem__ = __iter__ = __len__ = __contains__ = _refuse
