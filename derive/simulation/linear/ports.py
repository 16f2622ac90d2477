"""Inputs and outputs of a linearisation: those of a scene, or forces at markers and the positions of markers.

Forces at markers take the place of missing inputs only beside the positions of markers, which do not depend on them
in the same state. Outputs such as reactions and section forces do, and the generated code knows this dependence only
for the inputs of the scene.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import rate_matrix

STEP = 1e-3
"""The step of differences with respect to inputs, relative to those above 1. Most equations are linear in them."""


@dataclass(frozen=True, eq=False)
class InputDerivatives:
    """Derivatives with respect to the inputs u, by their names.

    forces (nv, nu): of M vdot + h - G^T lambda; constraints, rates, accelerations (nlambda, nu): of g, of gdot, and of
    G vdot - gamma.
    """

    names: tuple[str, ...]
    forces: Matrix
    constraints: Matrix
    rates: Matrix
    accelerations: Matrix


@dataclass(frozen=True, eq=False)
class OutputDerivatives:
    """Derivatives of the outputs y, by their names, with respect to zeta (dq = Z zeta), v, vdot, lambda and inputs."""

    names: tuple[str, ...]
    by_zeta: Matrix
    by_v: Matrix
    by_vdot: Matrix
    by_lam: Matrix
    by_u: Matrix


def inputs_of(
    native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, vdot: Vector, lam: Vector
) -> InputDerivatives:
    """The run-time inputs of a scene, or for a model without inputs and outputs the force components at each marker.

    Derivatives with respect to run-time inputs are differences of fourth order of the generated functions.
    """
    if not native.inputs and not native.outputs:
        names, jacobian = _markers(native, k, q, v)
        none = np.zeros((native.nlambda, len(names)))
        forces = tuple(f"{marker}_F{i}" for marker, i in names)
        return InputDerivatives(forces, -jacobian.T, none, none, none)
    form = native.dae["index1"]
    qdot = native.rates(q, v, k)
    y, ydot = np.concatenate([q, v, lam]), np.concatenate([qdot, vdot, np.zeros(len(lam))])
    residual = _by_inputs(native, k, lambda k: form.residual(t, y, ydot, k))
    return InputDerivatives(
        names=native.inputs,
        forces=residual[native.nq : native.nq + native.nv],
        constraints=_by_inputs(native, k, lambda k: native.constraints(t, q, k)),
        rates=_by_inputs(native, k, lambda k: native.constraint_rates(t, q, v, k)),
        accelerations=residual[native.nq + native.nv :],
    )


def outputs_of(
    native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, vdot: Vector, lam: Vector
) -> OutputDerivatives:
    """The outputs of a scene, or the positions of the markers of a model without outputs."""
    nv = native.nv
    if not native.outputs:
        names, jacobian = _markers(native, k, q, v)
        none = np.zeros((len(names), nv))
        positions = tuple(f"{marker}_x{i}" for marker, i in names)
        inputs = len(native.inputs) or len(names)
        by_lam, by_u = np.zeros((len(names), native.nlambda)), np.zeros((len(names), inputs))
        return OutputDerivatives(positions, jacobian, none, none, by_lam, by_u)
    assert native.outputs_pattern is not None
    J = native.outputs_pattern.dense(native.outputs_jacobian(t, q, v, vdot, lam, k))
    ends = np.cumsum([native.nq, nv, nv, native.nlambda])
    by_q, *others = np.split(J, ends, axis=1)
    return OutputDerivatives(native.outputs, by_q @ rate_matrix(native, q, k), *others)


def _by_inputs(native: NativeScene, k: Vector, function: Callable[[Vector], Vector]) -> Matrix:
    """The derivatives (n, nu) of a function of the constants k, behind which the inputs are."""
    u = k[len(k) - len(native.inputs) :]
    columns = []
    for i, value in enumerate(u):
        step = STEP * max(1.0, abs(float(value)))
        unit = np.eye(len(u))[i]
        near, far = (
            function(native.with_inputs(k, u + s * step * unit)) - function(native.with_inputs(k, u - s * step * unit))
            for s in (1, 2)
        )
        columns.append((8 * near - far) / (12 * step))
    return np.array(columns).T if columns else np.zeros((len(function(k)), 0))


def _markers(native: NativeScene, k: Vector, q: Vector, v: Vector) -> tuple[list[tuple[str, int]], Matrix]:
    """The name of the marker and the component, from 1, of each row of d(velocity)/dv (rows, nv) of all markers."""
    names: list[tuple[str, int]] = []
    rows = [np.zeros((0, native.nv))]
    for marker in native.markers:
        pattern = native.marker_pattern(marker)
        rows.append(pattern.dense(native.marker(marker, q, v, k)[2]))
        names += [(marker, i + 1) for i in range(pattern.rows)]
    return names, np.vstack(rows)
