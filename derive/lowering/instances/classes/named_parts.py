"""The parts of a mechanism in space that an output asks for, by which it names its bodies and joints."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, Generic, TypeVar

from derive.algebra import sp
from derive.lowering.instances.classes.gears import gears_of
from derive.lowering.instances.classes.groups import Bodies
from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.multibody.component_damping import damping_force
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.space.forces import ActionLoads, MarkerLoad
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.multibody.space.gears import gear_loads
from derive.mechanics.multibody.space.joint_motion import JointMotion, joint_motion
from derive.mechanics.multibody.space.mechanism import SpatialActionInstance, SpatialMechanism, joint_loads
from derive.mechanics.multibody.space.output_parts import SpatialParts
from derive.mechanics.terms import Intermediate, ModelConstant
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_scene import SpatialScene

T = TypeVar("T")


class NamedParts:
    """The markers, actions and joints that an output asks for, in their order, and the definitions in their loads.

    constants: those of the dampings that it asks for, and its own.
    """

    def __init__(self, of: Bodies) -> None:
        self.of = of
        self.mechanism: SpatialMechanism = of.mechanism
        self.markers, self.actions, self.joints = list[MarkerRef](), list[SpatialActionInstance](), list[str]()
        self.definitions: dict[sp.Symbol, Intermediate] = {}
        self.constants: list[ModelConstant] = []
        self.own: dict[str, None] = {}

    def of_scene(
        self,
        scene: SpatialScene | None = None,
        bodies: Iterable[str] | None = None,
        actions: Iterable[SpatialActionInstance] | None = None,
        dampings: Iterable[ComponentDamping] | None = None,
    ) -> SpatialParts:
        """The parts of the mechanism, with some bodies, actions, dampings and the drives of a scene in sums."""
        mechanism, known = self.mechanism, self.of.known
        every = [i.name for i in mechanism.instances] if bodies is None else bodies
        multipliers = {j.joint.name: c for j, c in zip(mechanism.joints, known.constraints, strict=False)}
        drives = {
            c.shown: (name, c.multiplier) for name, of in multipliers.items() for c in of if c.shown in self._drives
        }
        named: Any = [_Action(self, f) for f in (mechanism.forces if actions is None else actions)]
        return SpatialParts(
            scene=scene or mechanism.scene,
            at=self.at,
            instances=_Lazy(every, self.instance),
            actions=named,
            joint_loads=_Lazy(multipliers, self.joint_load),
            supports={j.joint.name: j.own for j in mechanism.eliminated_joints},
            joints=mechanism.joints_by_name,
            drive_multipliers=_Lazy(drives, lambda name: self._multiplier(*drives[name])),
            motion=self.motion,
            gear_loads=self.gear_loads,
            dissipations=map(self.dissipation, mechanism.dampings if dampings is None else dampings),
        )

    @cached_property
    def _drives(self) -> frozenset[str]:
        return frozenset(d.name for d in self.mechanism.scene.drives)

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies with coordinates among those that it asks for."""
        return tuple(name for name in self.own if name in self.of.members)

    @property
    def idle_joints(self) -> tuple[int, ...]:
        """The numbers of the joints that it asks for between markers whose motion is known."""
        every = self.mechanism.joints
        ends = ((k, (j.joint.first, j.joint.second)) for k, j in enumerate(every) if j.joint.name in self.joints)
        return tuple(k for k, markers in ends if all(map(self.of.known.is_known, markers)))

    def at(self, marker: MarkerRef) -> FrameMotion:
        """The motion of a marker."""
        self.markers.append(marker)
        self.own.setdefault(marker.body)
        is_own = marker.body in self.of.members
        motion: FrameMotion = (
            self.of.equations(marker.body).motions[marker.marker] if is_own else self.of.known.point(marker)
        )
        return motion

    def instance(self, name: str) -> InstanceEquations:
        """The equations of a body."""
        self.own.setdefault(name)
        return self.of.equations(name) if name in self.of.members else self.of.known.bodies[name]

    def dissipation(self, damping: ComponentDamping) -> sp.Expr:
        """The power (W) of a damping between components."""
        self.constants += damping.constants
        return damping_force(damping, {name: self.instance(name) for name in damping.components}).dissipation

    def joint_load(self, name: str) -> tuple[MarkerLoad, MarkerLoad]:
        """The loads of a joint that is a constraint on its bodies."""
        number = next(k for k, j in enumerate(self.mechanism.joints) if j.joint.name == name)
        self.joints.append(name)
        return joint_loads(
            self.mechanism.joints[number], (c.multiplier for c in self.of.known.constraints[number]), self.at
        )

    def motion(self, joint: str) -> JointMotion:
        """The motion of a joint."""
        of = self.mechanism.joints_by_name[joint]
        names = [marker.body for marker in (of.joint.first, of.joint.second) if marker.body in self.of.members]
        self.own |= dict.fromkeys(names)
        rows = tuple(row for name in names for row in self.mechanism.instance(name).coordinates.rows)
        return joint_motion(of, self.at, self.mechanism.instances_by_name, rows)

    def gear_loads(self, body: str) -> Iterator[MarkerLoad]:
        """Yield the loads of gears on a body."""
        conditions = self.of.known.constraints[len(self.mechanism.joints) :]
        for gear, (condition,) in zip(gears_of(self.mechanism), conditions, strict=True):
            if any(marker.body == body for marker in gear.markers):
                loads = gear_loads(gear.instance, condition.multiplier, self.motion)
                yield from (load for load in loads if load.marker.body == body)

    def _multiplier(self, joint: str, multiplier: sp.Symbol) -> sp.Symbol:
        """The multiplier of a drive, whose joint its bodies have."""
        self.joints.append(joint)
        of = self.mechanism.joints_by_name[joint].joint
        self.own |= dict.fromkeys(marker.body for marker in (of.first, of.second))
        return multiplier


class _Lazy(Mapping[str, T], Generic[T]):
    """Values that are computed when they are asked for."""

    def __init__(self, names: Iterable[str], value: Callable[[str], T]) -> None:
        self._names, self._value = (*names,), value

    def __getitem__(self, name: str) -> T:
        if name not in self._names:
            raise KeyError(name)
        return self._value(name)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class _Action:
    """An action whose loads are computed when somebody asks for more than the action itself."""

    def __init__(self, of: NamedParts, instance: SpatialActionInstance) -> None:
        self._of, self._instance, self.element = of, instance, instance.element

    def on(self, body: str) -> Iterable[MarkerLoad]:
        """Its loads on a body."""
        return self._made.on(body) if any(marker.body == body for marker in self._instance.markers) else ()

    @cached_property
    def _made(self) -> ActionLoads:
        self._of.actions.append(self._instance)
        made = self._of.mechanism.loads(self._instance, self._of.at, ())
        self._of.definitions |= {d.symbol: d for d in made.definitions}
        return made

    def __getattr__(self, name: str) -> Any:
        return getattr(self._made, name)
