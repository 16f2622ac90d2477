"""A scene to be assembled: its kernels at one time, its poses, and the targets that its poses are to have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.ir.patterns import Pattern, pattern
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix
from derive.simulation.initial.contradictions import Misfit
from derive.simulation.initial.kinematics import Columns, Kinematics, PoseValues
from derive.simulation.initial.targets import Target


@dataclass(frozen=True, eq=False)
class Assembler:
    """A scene to be assembled at the time t (s): its kernels, the constants k (nk,) and its size (m)."""

    native: NativeScene
    k: Vector
    t: float
    size: float

    def kinematics(self, q: Vector, moving: bool = False) -> Kinematics:
        """The poses in a configuration (nq,); with `moving`, also how drives change them."""
        return Kinematics(self.native, self.k, self.t, q, self.size, moving, groups=self._groups)

    def values(self, q: Vector) -> PoseValues:
        """The poses in a configuration (nq,) without their derivatives."""
        return PoseValues(self.native, self.k, self.t, q, self.size, False)

    @cached_property
    def _groups(self) -> tuple[Columns, ...]:
        return Kinematics(self.native, self.k, self.t, np.zeros(self.native.nq), self.size, False).grouped()

    def unit(self, target: Target) -> float:
        """The scale of a target: 1 rad, or the size of the scene (m)."""
        return 1.0 if target.angular else self.size

    def misfits(self, targets: Sequence[Target], q: Vector) -> tuple[Misfit, ...]:
        """The targets with the values that they have in a configuration."""
        kinematics = self.values(q)
        values = ((target, target.function(kinematics).value) for target in targets)
        return tuple(Misfit(target, value, (value - target.value) / self.unit(target)) for target, value in values)


class WithTargets:
    """The constraints of a compiled scene, and the constraints that targets have their values."""

    def __init__(self, assembler: Assembler, targets: Sequence[Target]) -> None:
        native = assembler.native
        self._assembler, self._native, self._targets = assembler, native, tuple(targets)
        self.nq, self.nv, self.roles, self.mass_pattern = native.nq, native.nv, native.roles, native.mass_pattern
        rows = native.nlambda + len(targets)
        self.constraint_pattern: Pattern = pattern(rows, self.nq, {(i, j) for i in range(rows) for j in range(self.nq)})

    def mass(self, q: Vector, k: Vector) -> Vector:
        """Values of the lower triangle of M."""
        return self._native.mass(q, k)

    def constraints(self, t: float, q: Vector, k: Vector) -> Vector:
        """The constraints g, and the deviations of the targets from their values (m, rad)."""
        kinematics = self._assembler.values(q)
        missed = [target.function(kinematics).value - target.value for target in self._targets]
        return np.concatenate([self._native.constraints(t, q, k), missed])

    def constraint_jacobian(self, t: float, q: Vector, k: Vector) -> Vector:
        """Values of the derivatives of `constraints` by the coordinates, by columns."""
        kinematics = self._assembler.kinematics(q)
        gradients = [target.function(kinematics).gradient for target in self._targets]
        return np.vstack([constraint_matrix(self._native, t, q, k), *gradients]).T.ravel()
