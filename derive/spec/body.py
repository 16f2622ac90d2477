"""What a specification says, as frozen data: the types that `read` returns and `derive` takes."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

Polynomial = tuple[Fraction, ...]
"""Coefficients of 1, xi, xi^2, ...; no trailing zeros."""

FrameKind = Literal["mean", "point", "chord", "tangent", "given"]


@dataclass(frozen=True)
class Parameter:
    """A run-time parameter of the generated code: its symbol, unit and default value."""

    symbol: str
    unit: str
    default: float


Quantity = Parameter | Fraction
"""A physical constant of the body: a run-time parameter, or a number folded into the code."""


@dataclass(frozen=True)
class Frame:
    """How rigid motion is kept out of the displacements due to deformation: conditions (16) or (17), (19).

    `mean`: no mean displacement and no mean rotation; `point`: no displacement and no slope at `at`;
    `chord`: no displacement at either end; `tangent`: no displacement and no slope at the end `at`;
    `given`: the ansatz is used as it stands, and refused if it holds a rigid motion. In every frame X = xi l/2 e1, so
    that c is where the centre of the undeformed beam lies in the floating frame, not the point `at`.
    """

    kind: FrameKind
    at: Fraction | None = None


@dataclass(frozen=True)
class Marker:
    """A named material point of a beam, at the dimensionless distance `at` in [-1, 1] of (21)."""

    name: str
    at: Fraction


@dataclass(frozen=True)
class PlanarBeam:
    """A uniform slender free beam that moves in a plane: the example of the paper, (21)-(27)."""

    name: str
    ansatz: tuple[Polynomial, ...]
    frame: Frame
    mass: Quantity
    length: Quantity
    bending_stiffness: Quantity
    markers: tuple[Marker, ...] = ()
    orthogonal: bool = False
