"""The base class of the types of outputs: their keys, and their components with units and expressions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from derive.algebra import sp
from derive.spec.model.keys import Key
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.multibody.bodies.body_type import ComponentDamping
    from derive.mechanics.multibody.kinds import EliminatedJoint, ForceInstance, JointInstance
    from derive.mechanics.multibody.scene_mechanics import SceneMechanics
    from derive.mechanics.terms import ModelConstant


@dataclass(frozen=True)
class OutputComponent:
    """A number that an output consists of.

    label: the suffix to the name of the output, empty if there is one component; unit: its SI unit; expr: its value in
    the symbols of the mechanism, its accelerations and multipliers.
    """

    label: str
    unit: str
    expr: sp.Expr


@dataclass(frozen=True)
class OutputComponents:
    """The components of an output, and the constants in them that the equations of motion do not have."""

    components: tuple[OutputComponent, ...]
    constants: tuple[ModelConstant, ...] = ()


class NamedElements(Protocol):
    """The elements of a mechanism that descriptions of outputs name: those of its specification, and its forces."""

    @property
    def scene(self) -> Scene:
        """The specification."""

    @property
    def forces(self) -> tuple[ForceInstance, ...]:
        """The forces, torques and springs, with the markers of instances that they act at."""


class Summands(NamedElements, Protocol):
    """The elements of a mechanism over which outputs sum."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its instances."""

    @property
    def dampings(self) -> tuple[ComponentDamping, ...]:
        """The damping between the components of bodies."""

    @property
    def joints(self) -> tuple[JointInstance, ...]:
        """The joints that are constraints, with their drives."""

    @property
    def eliminated_joints(self) -> tuple[EliminatedJoint, ...]:
        """The joints that have eliminated coordinates, with their drives."""


class OutputType(ABC):
    """A type of output. Subclasses are registered in `registry.OUTPUTS`.

    doc: a description, in a clause; keys: the keys of its table besides `kind`; labels: the labels of its components;
    counts_inertia: whether it depends on the inertia of bodies whose motion is prescribed.
    """

    doc: str
    labels: tuple[str, ...] = ("",)
    counts_inertia: bool = False
    keys: tuple[Key, ...]

    @abstractmethod
    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return the components of the output `name` from the values of its keys."""

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return a description of each component, in the order of `labels`.

        Outputs that loops compute with one code have the same components, and descriptions of their own.
        """
        return tuple(f"{self.doc}, {label}" if label else self.doc for label in self.labels)


class Addend(OutputType):
    """A type of output that is a part of a sum; no specification asks for it."""

    keys: tuple[Key, ...] = ()


class SumOutput(OutputType):
    """A type of output that is a sum over bodies, forces and drives, of which loops compute a part each.

    units: those of its components.
    """

    units: tuple[str, ...]

    @abstractmethod
    def addends(self, mechanism: Summands) -> Iterator[tuple[Addend, Mapping[str, Any]]]:
        """Yield the types of its parts with the values of their keys; they have the components of the sum.

        These values and its scene are all of the mechanism that a part depends on.
        """

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return the sums of the components of its parts, whose constants the equations of motion have."""
        parts = [part.components(name, given, scene).components for part, given in self.addends(scene)]
        totals = [sp.Add(*(part[k].expr for part in parts)) for k in range(len(self.labels))]
        of = zip(self.labels, self.units, totals, strict=True)
        return OutputComponents(tuple(OutputComponent(label, unit, total) for label, unit, total in of))


@dataclass(frozen=True)
class OutputInstance:
    """An output with its type and the values of its keys; markers are those of instances."""

    name: str
    type: OutputType
    values: Mapping[str, Any]
