"""The base class of the types of outputs: their keys, and their components with units and expressions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.terms import ModelConstant
from derive.spec.model.keys import Key


@dataclass(frozen=True)
class OutputComponent:
    """A number that an output consists of.

    label: the suffix to the name of the output, empty if there is one component; unit: its SI unit; doc: a description;
    expr: its value in the symbols of the mechanism, its accelerations and multipliers.
    """

    label: str
    unit: str
    doc: str
    expr: sp.Expr


@dataclass(frozen=True)
class OutputComponents:
    """The components of an output, and the constants in them that the equations of motion do not have."""

    components: tuple[OutputComponent, ...]
    constants: tuple[ModelConstant, ...] = ()


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


@dataclass(frozen=True)
class OutputInstance:
    """An output with its type and the values of its keys; markers are those of instances."""

    name: str
    type: OutputType
    values: Mapping[str, Any]
