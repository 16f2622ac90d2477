"""Implicit forms of a scene, and one whose iteration matrix is regular where joints are redundant."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from derive.ir.patterns import Pattern, pattern
from derive.lowering.proximal import LEAST, PROXIMAL
from derive.runtime.native_call import Vector


class Form(Protocol):
    """A form F(t, y, ydot) = 0 of `NativeScene.dae`: y = [q; v; lambda], or [q; v; lambda; mu] if stabilised."""

    size: int
    pattern: Pattern

    def residual(self, t: float, y: Vector, ydot: Vector, k: Vector) -> Vector:
        """The residual F (size,)."""

    def jacobian(self, t: float, y: Vector, ydot: Vector, cj: float, k: Vector) -> Vector:
        """The values of the iteration matrix dF/dy + cj dF/dydot by columns."""


class ProximalForm:
    """A form with a proximal term on the diagonal of the multipliers in its iteration matrix alone.

    With the matrix [A, B; C, 0] of the state and the multipliers, the term is - PROXIMAL times the diagonal of
    C A^-1 B, estimated by the diagonal of A. A correction of Newton's method is off by this part of itself, which the
    next one mends; corrections of reactions that balance each other are finite.
    """

    def __init__(self, form: Form, state: int) -> None:
        """state: the number of elements of y before the multipliers."""
        self._form, self.size, self._state = form, form.size, state
        entries = {*form.pattern.entries} | {(j, j) for j in range(state, form.size)}
        self.pattern = pattern(form.size, form.size, entries)
        number = {entry: k for k, entry in enumerate(self.pattern.entries)}
        self._given = np.array([number[entry] for entry in form.pattern.entries])
        self._diagonal = np.array([number.get((j, j), -1) for j in range(form.size)])
        pairs = [(i, j) for i, j in number if i < state <= j and (j, i) in number and (i, i) in number]
        self._down = np.array([number[i, j] for i, j in pairs], dtype=int)
        self._across = np.array([number[j, i] for i, j in pairs], dtype=int)
        self._rows = np.array([i for i, _ in pairs], dtype=int)
        self._columns = np.array([j for _, j in pairs], dtype=int)

    def residual(self, t: float, y: Vector, ydot: Vector, k: Vector) -> Vector:
        """The residual F (size,)."""
        return self._form.residual(t, y, ydot, k)

    def jacobian(self, t: float, y: Vector, ydot: Vector, cj: float, k: Vector) -> Vector:
        """The values of the iteration matrix by columns, with the proximal term."""
        values = np.zeros(len(self.pattern.rowidx))
        values[self._given] = self._form.jacobian(t, y, ydot, cj, k)
        inverse = 1.0 / values[self._diagonal[self._rows]]
        compliance, full = np.zeros(self.size), np.zeros(self.size)
        np.add.at(compliance, self._columns, values[self._down] * values[self._across] * inverse)
        np.add.at(full, self._columns, np.abs(inverse))
        own = slice(self._state, None)
        sign = np.where(compliance < 0, -1.0, 1.0)
        size = np.maximum(np.abs(compliance), float(LEAST) * full)
        values[self._diagonal[own]] -= float(PROXIMAL) * (sign * np.where(full > 0, size, 1.0))[own]
        return values
