"""The base class of the types of outputs: their keys, and their components with units and expressions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import sympy as sp

from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.terms import ModelConstant
from derive.spec.model.keys import Key
from derive.spec.model.scene import Scene


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


@dataclass(frozen=True)
class OutputInstance:
    """An output with its type and the values of its keys; markers are those of instances."""

    name: str
    type: OutputType
    values: Mapping[str, Any]
