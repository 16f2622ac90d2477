"""The inputs and the reactions of joints that a given motion of a scene needs.

The equations M vdot + h0 + B u - G^T lambda = 0 and G vdot = gamma are linear in the inputs u, in lambda and in the
accelerations that are not given. B has the differences of h, which is linear in the inputs that are forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import frexp

import numpy as np
from numpy.typing import ArrayLike

from derive.errors import TisserandError
from derive.registry import UnknownNameError
from derive.runtime.native_call import Matrix, Vector, checked_vector, doubles
from derive.runtime.native_scene import NativeScene

RANK = 1e-11
"""The singular value, relative to the largest one, below which a combination of unknowns has no effect."""
LARGEST = 1e-9
"""The largest residual of an equation, relative to its terms, that counts as rounding."""


class MissingInputs(TisserandError, ArithmeticError):
    """No inputs give the accelerations: too few act, or joints and drives do not allow these accelerations.

    Examples:
        >>> import derive
        >>> scene = derive.scene("free", bodies={"rod": {"mass": 1, "inertia": 1}})
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(scene)), scene))
        >>> try:
        ...     derive.inverse_dynamics(native, 0.0, [0, 0, 0], [0, 0, 0], [1, 0, 0], native.setup())
        ... except derive.MissingInputs as error:
        ...     print(str(error)[:44])
        free: no inputs give these accelerations; 3
    """


@dataclass(frozen=True)
class DrivingForces:
    """The forces that a motion of a scene needs, as `inverse_dynamics` returns them.

    Attributes:
        inputs: the values of the inputs that were sought, by their names.
        multipliers: the constraint reactions lambda (nlambda,).
        vdot: the accelerations (nv,), those that were not given as well.
        undetermined: the names of inputs and multipliers that have other values too; these inputs have the least norm.

    Examples:
        >>> import derive
        >>> derive.DrivingForces({"motor": 2.0}, [], [0.5], ()).inputs["motor"]
        2.0
    """

    inputs: dict[str, float]
    multipliers: Vector
    vdot: Vector
    undetermined: tuple[str, ...]


def inverse_dynamics(
    native: NativeScene,
    t: float,
    q: ArrayLike,
    v: ArrayLike,
    vdot: ArrayLike,
    k: ArrayLike,
    inputs: Sequence[str] | None = None,
) -> DrivingForces:
    """The inputs and the constraint reactions with which a scene has given accelerations.

    Arguments:
        native: the scene, as `load_scene` returns it.
        t: the time, s.
        q: the coordinates (nq,), which meet the constraints.
        v: the generalised velocities (nv,), which do as well.
        vdot: the accelerations (nv,). NaN stands for one that follows: in a scene with flexible bodies there are no
            inputs for the modes, and where fewer inputs act than there are degrees of freedom, others follow as well.
        k: the constants (nk,) of `setup`, with the values of the other inputs behind them.
        inputs: the names of the inputs to find; all by default but those that prescribe motions of drives, whose forces
            are among the multipliers.

    Raises:
        MissingInputs: if no inputs give these accelerations; the message says how many are missing.
        UnknownNameError: for a name that is not in `native.inputs`.
        ValueError: for an input in which the forces are not linear, and on a wrong length.

    Examples:
        >>> import derive
        >>> scene = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -10),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": 1, "markers": {"top": (0, 1)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ...     inputs={"motor": {"value": 0}},
        ...     torques={"drive": {"at": "rod.top", "value": {"input": "motor"}}},
        ... )
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(scene)), scene))
        >>> forces = derive.inverse_dynamics(native, 0.0, [0.5], [0], [3], native.setup())
        >>> round(forces.inputs["motor"], 4)  # 2 kg m^2 times 3 rad/s^2, and 10 N m times sin 0.5
        10.7943
    """
    names = _sought(native, inputs)
    given = checked_vector(native.nv, vdot, "vdot")
    follows = np.isnan(given)
    known = np.where(follows, 0.0, given)
    u = doubles(native.own(k), "k")[native.nk - len(native.inputs) :].copy()
    places = [native.inputs.index(name) for name in names]
    u[places] = 0.0
    values, h = native.mass_force(t, q, v, native.with_inputs(k, u))
    B = np.column_stack([np.zeros((native.nv, 0)), *(_column(native, t, q, v, k, u, j, h) for j in places)])
    M = native.mass_pattern.dense(values)
    G = native.constraint_pattern.dense(native.constraint_jacobian(t, q, k))
    gamma = native.constraint_bias(t, q, v, native.with_inputs(k, u)) if native.nlambda else np.zeros(0)
    nu, m = len(names), native.nlambda
    matrix = np.block([[B, -G.T, M[:, follows]], [np.zeros((m, nu + m)), G[:, follows]]])
    right = -np.concatenate([M @ known + h, G @ known - gamma])
    terms = np.concatenate([abs(M) @ abs(known) + abs(h), abs(G) @ abs(known) + abs(gamma)])
    solution, free = _solved(matrix, right)
    off = abs(matrix @ solution - right) > LARGEST * (terms + abs(matrix) @ abs(solution) + terms.max(initial=0.0))
    if off.any():
        raise MissingInputs(_text(native, off, int(follows.sum()), native.nv + m - np.linalg.matrix_rank(matrix)))
    if nu and free.size:  # of all solutions the one with the least inputs
        solution = solution - free @ np.linalg.lstsq(free[:nu], solution[:nu], rcond=RANK)[0]
    complete = known.copy()
    complete[follows] = solution[nu + m :]
    unknowns = (*names, *native.multipliers, *np.array(native.velocities)[follows])
    size = abs(free).max(axis=1, initial=0.0)
    undetermined = tuple(str(name) for name, x in zip(unknowns, size, strict=True) if x > np.sqrt(RANK))
    return DrivingForces(
        dict(zip(names, map(float, solution[:nu]), strict=True)), solution[nu : nu + m], complete, undetermined
    )


def _sought(native: NativeScene, inputs: Sequence[str] | None) -> tuple[str, ...]:
    """The names of the inputs to find."""
    if inputs is None:
        motions = {n for n in native.inputs if {f"{n}dot", f"{n}ddot"} <= {*native.inputs}}
        derived = {f"{n}{dots}" for n in motions for dots in ("", "dot", "ddot")}
        return tuple(name for name in native.inputs if name not in derived)
    for name in inputs:
        if name not in native.inputs:
            raise UnknownNameError(f"input of {native.name}", name, native.inputs)
    return tuple(dict.fromkeys(inputs))


def _column(
    native: NativeScene, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, u: Vector, j: int, h: Vector
) -> Vector:
    """The derivative of h by an input, in which it is linear. Raises ValueError if it is not."""

    def slope(step: float) -> Vector:
        changed = u.copy()
        changed[j] = step
        return (native.force(t, q, v, native.with_inputs(k, changed)) - h) / step

    first = slope(1.0)
    size = abs(first).max(initial=0.0)
    if size == 0.0:
        return first
    step = 2.0 ** frexp(max(abs(h).max() / size, 1.0))[1]  # so large that h does not round it away
    result = slope(step)
    if abs(result - first).max() > 1e-6 * size + 1e-12 * abs(h).max():
        raise ValueError(f"{native.name}: the forces are not linear in the input {native.inputs[j]}; give it a value")
    return result


def _solved(matrix: Matrix, right: Vector) -> tuple[Vector, Matrix]:
    """The solution of least squares, and a basis of what may be added to it, with rows and columns of one size."""
    rows = np.linalg.norm(matrix, axis=1)
    rows = np.where(rows > 0.0, rows, 1.0)
    columns = np.linalg.norm(matrix / rows[:, None], axis=0)
    columns = np.where(columns > 0.0, columns, 1.0)
    left, sizes, directions = np.linalg.svd(matrix / rows[:, None] / columns)
    rank = int((sizes > RANK * max(sizes, default=0.0)).sum())
    scaled = directions[:rank].T @ ((left[:, :rank].T @ (right / rows)) / sizes[:rank])
    return scaled / columns, directions[rank:].T / columns[:, None]


def _text(native: NativeScene, off: Vector, follow: int, lacking: int) -> str:
    """The message on equations that no inputs meet."""
    rows = [name for name, is_off in zip((*native.velocities, *native.multipliers), off, strict=True) if is_off]
    if off[native.nv :].any() and not follow:
        joints = ", ".join(name for name, is_off in zip(native.multipliers, off[native.nv :], strict=True) if is_off)
        return f"{native.name}: the accelerations contradict the constraints {joints}; write NaN for those that follow"
    shown = ", ".join(rows[:6]) + (", ..." if len(rows) > 6 else "")
    return (
        f"{native.name}: no inputs give these accelerations; {lacking} are missing (equations of {shown}): add inputs, "
        "or write NaN for accelerations that follow, such as those of modes"
    )
