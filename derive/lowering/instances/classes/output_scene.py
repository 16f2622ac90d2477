"""The part of a mechanism that an output names, which raises NotInLoops when the output asks for more."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from derive.lowering.instances.classes.dimension import plane
from derive.lowering.instances.classes.groups import Bodies, NotInLoops
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.spec.model.markers import GROUND


def output_scene(
    bodies: Bodies,
    own: Mapping[str, InstanceEquations],
    forces: tuple[ForceInstance, ...],
    generalised: Sequence[GeneralisedForce] = (),
    joints: Sequence[int] = (),
    points: Mapping[str, Mapping[str, PointMotion]] = MappingProxyType({}),
    of_all: bool = False,
) -> SceneMechanics:
    """The parts of the mechanism that an output names.

    own: its bodies with coordinates; points: those of bodies, and of the ground, that have others than their own;
    of_all: whether it has all bodies.
    """
    mechanism = bodies.mechanism
    known = {name: replace(b, points=points.get(name, b.points)) for name, b in bodies.known.bodies.items()}
    return SceneMechanics(
        scene=mechanism.scene,
        ground=points.get(GROUND, mechanism.ground),
        instances={**known, **own} if of_all else _Some(known, own),
        joints=tuple(mechanism.joints[k] for k in joints),
        eliminated_joints=mechanism.eliminated_joints,
        forces=forces,
        generalised=tuple(generalised),
        dampings=mechanism.dampings,
        constraints=tuple(c for k in joints for c in bodies.known.constraints[k]),
    )


class _Some(dict[str, Any]):
    """Some bodies by their names; any other one is a body whose motion does not matter, and nobody asks for all."""

    def __init__(self, *of: Mapping[str, InstanceEquations]) -> None:
        super().__init__(pair for bodies in of for pair in bodies.items())

    def __missing__(self, key: str) -> _Elsewhere:
        return _ELSEWHERE

    def values(self) -> Any:
        """Raise NotInLoops."""
        raise NotInLoops("an output depends on all bodies")

    items = values
    __iter__ = values


class NamedForces(tuple[Any, ...]):
    """The forces that an output names; nobody asks for all."""

    def __iter__(self) -> Any:
        """Yield these, and raise NotInLoops at their end."""
        yield from super().__iter__()
        raise NotInLoops("an output depends on all forces")


class _Still(dict[str, PointMotion]):
    """The points of a body that an output does not name: what joints do to others does not depend on their motion."""

    def __missing__(self, key: str) -> Any:
        return plane().still


class _Elsewhere:
    """A body that an output does not name."""

    points: Mapping[str, PointMotion] = _Still()


_ELSEWHERE = _Elsewhere()
