"""Spatial scenes through all stages, beside the oracle of the same file, and their comparison in random states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
from decimal_vectors import STEP, Array, floats, number, precise
from random_scenes import FIRST_BEAM
from space_oracle import Mechanics, SpaceOracle, apart
from written_functions import sampled
from written_scene import tables

import derive
from beams import run_module
from conftest import QUICK
from derive.backends.model_files import explicit_files
from derive.derivation import derive as equations
from derive.generated_models import generated
from derive.model_lowering import lower
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix

LIMIT = 1e-12
"""The largest difference, relative to the sum of the magnitudes of what a number is the sum of."""
QUICK_SEEDS, COMPLETE_SEED = (25, 71), 105
LONG_SEEDS, FURTHER_SEEDS = range(10), range(10, 100)
BEAM_SEEDS = range(FIRST_BEAM, FIRST_BEAM + 60)
RANDOM_SEEDS = (*QUICK_SEEDS, COMPLETE_SEED, *LONG_SEEDS, *FURTHER_SEEDS, *BEAM_SEEDS)
"""The seeds of the random scenes that tests compare."""
RATES = ("", "dot", "ddot")
"""The ends of the names of inputs and their derivatives."""
VARIED = 0.02
"""The part of its default by which a parameter differs from it."""
CONDITION = 1e9
"""The largest condition of constraints whose multipliers are compared."""


@dataclass(frozen=True, eq=False)
class SpaceModel:
    """A scene with its compiled C, the generated Python if the model is complete, and the oracle."""

    native: NativeScene
    python: dict[str, Any] | None
    oracle: SpaceOracle
    p: Array

    def constants(self, t: float) -> Array:
        """k with the values of the inputs at a time, of those that prescribe motions with their derivatives."""
        k, names = self.native.setup(self.p), self.native.inputs
        if not names:
            return k
        functions = self.oracle.value.functions
        with precise():
            of = {name: floats(sampled(functions, name, number(t), STEP)) for name in functions.inputs}
        values = {f"{name}{end}": x for name, u in of.items() for end, x in zip(RATES, u, strict=True)}
        return self.native.with_inputs(k, [values[name] for name in names])


def space_model(path: Path, complete: bool = True) -> SpaceModel:
    """A scene of a file. complete: with all kernels and the Python, which takes twice the time."""
    spec = derive.read(path)
    files = generated(spec)[1] if complete else explicit_files(lower(equations(spec), explicit=True), spec)
    native = load_scene(files, QUICK)
    p = native.defaults * (1 + VARIED * np.random.default_rng(1).uniform(-1, 1, len(native.defaults)))
    given = dict(zip(native.parameters, p.tolist(), strict=True))
    oracle = SpaceOracle(tables(path), native.coordinates, native.multipliers, folder=path.parent, p=given)
    return SpaceModel(native, run_module(files) if complete else None, oracle, p)


def random_state(native: NativeScene, seed: int) -> tuple[float, Array, Array]:
    """t, q, v: any attitude, moderately deformed, and far from meeting the constraints."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.5, 1.5, native.nq)
    names = list(native.coordinates)
    for i, name in enumerate(names):
        if name.endswith("e0"):
            q[i : i + 4] = rng.normal(size=4)
            q[i : i + 4] /= np.linalg.norm(q[i : i + 4])
        if "alpha" in name:
            q[i] *= 0.2
    return rng.uniform(0.2, 1.5), q, rng.uniform(-2, 2, native.nv)


def differences(model: SpaceModel, t: float, q: Array, v: Array) -> Iterator[tuple[str, float]]:
    """Yield what differs, with its relative size, of each function of a scene."""
    native, oracle, k = model.native, model.oracle, model.constants(t)
    seen = oracle.see(t, q, v)
    yield "mass", apart(mass_matrix(native, q, k), seen.M, seen.mass_sizes)
    yield "force", apart(native.force(t, q, v, k), seen.h, seen.force_sizes)
    rows = [seen.rows.index(name) for name in native.multipliers]
    assert len(rows) == len(seen.rows), (native.multipliers, seen.rows)
    g, gdot, gamma, G = (x[rows] for x in (seen.g, seen.gdot, seen.gamma, seen.G))
    speeds = 1 + np.abs(floats(G)).max(initial=0)
    yield "g", apart(native.constraints(t, q, k), g, 1 + abs(g))
    yield "G", apart(constraint_matrix(native, t, q, k), G, 1 + abs(G))
    yield "gdot", apart(native.constraint_rates(t, q, v, k), gdot, speeds * np.abs(v).sum() + abs(floats(gdot)))
    size = speeds * (1 + np.abs(v).sum() ** 2) + abs(floats(gamma))
    yield "gamma", apart(native.constraint_bias(t, q, v, k), gamma, size)
    flat = _with_positive_masses(model, t, q)
    yield from _solution(model, seen if flat is q else oracle.see(t, flat, v), rows, t, flat, v)
    yield from _motion(model, seen, t, q, v)
    if model.python is not None:
        yield from _by_python(native, model.python, t, q, v, k)


def _solution(
    model: SpaceModel, seen: Mechanics, rows: list[int], t: float, q: Array, v: Array
) -> Iterator[tuple[str, float]]:
    """Accelerations and multipliers, if they are well determined."""
    native, k = model.native, model.constants(t)
    M, G = floats(seen.M), floats(seen.G)
    matrix = np.block([[M, G.T], [G, np.zeros((len(G), len(G)))]])
    if len(matrix) == 0:
        return
    if model.oracle.scene.get("scene", {}).get("redundant") == "resolve":
        yield from _residuals(model, seen, rows, t, q, v)
        return
    if np.linalg.cond(matrix) > CONDITION:
        return
    vdot, lam = (floats(x) for x in seen.accelerations())
    found, multipliers = native.solve(t, q, v, k)
    condition = np.linalg.cond(matrix)
    size = np.full(len(vdot) + len(lam), max(1.0, np.abs(np.concatenate([vdot, lam])).max()) * condition / 100)
    yield "solve", apart(np.concatenate([found, multipliers]), np.concatenate([vdot, lam[rows]]), size)


def _residuals(
    model: SpaceModel, seen: Mechanics, rows: list[int], t: float, q: Array, v: Array
) -> Iterator[tuple[str, float]]:
    """The equations of motion and of constraints, of which some are there twice, with the results of the code.

    Nothing is compared where joints contradict each other in a random state.
    """
    M, h, G, gamma = floats(seen.M), floats(seen.h), floats(seen.G[rows]), floats(seen.gamma[rows])
    if np.linalg.matrix_rank(np.column_stack([G, gamma]), 1e-9) > np.linalg.matrix_rank(G, 1e-9):
        return
    vdot, lam = model.native.solve(t, q, v, model.constants(t))
    size = np.abs(M) @ np.abs(vdot) + floats(seen.force_sizes) + np.abs(G).T @ np.abs(lam)
    yield "residual of motion", float(np.abs(M @ vdot + h - G.T @ lam).max(initial=0) / size.max(initial=1))
    size = np.abs(G) @ np.abs(vdot) + np.abs(gamma)
    yield "residual of constraints", float(np.abs(G @ vdot - gamma).max(initial=0) / size.max(initial=1))


def _motion(model: SpaceModel, seen: Mechanics, t: float, q: Array, v: Array) -> Iterator[tuple[str, float]]:
    """Energies, momenta, markers."""
    native, k = model.native, model.constants(t)
    if not model.oracle.drives:  # bodies that are carried are not counted
        kinetic, strain, gravity = (float(x) for x in seen.energy.values())
        energy = native.energy(q, v, k)
        expected = np.array([kinetic, strain, gravity][: len(energy)])
        size = 1 + np.abs(expected) + np.abs(floats(seen.M)).max(initial=0)
        yield "energy", apart(energy, expected, size)
        momentum = native.momentum(q, v, k)
        yield "momentum", apart(momentum, seen.momentum, 1 + np.abs(floats(seen.momentum)).max() * np.ones(6))
    for name in native.markers:
        reference = next(m for m in model.oracle.all_markers() if m.replace(".", "_") == name)
        x, xdot, J = seen.markers[reference]
        of = native.marker(name, q, v, k)
        yield f"marker {name}", apart(of[0], x, 1 + abs(x))
        yield f"velocity of {name}", apart(of[1], xdot, 10 + abs(xdot))
        yield f"Jacobian of {name}", apart(native.marker_pattern(name).dense(of[2]), J, 1 + abs(J))


def _by_python(
    native: NativeScene, python: dict[str, Any], t: float, q: Array, v: Array, k: Array
) -> Iterator[tuple[str, float]]:
    """The generated Python against the compiled C."""

    def apart_of(found: Array, expected: Array) -> float:
        size = max(1.0, float(np.abs(expected).max(initial=0)))
        return float(np.abs(np.broadcast_to(found, expected.shape) - expected).max(initial=0)) / size

    u = k[native.nk - len(native.inputs) :]
    given = {"t": t, "q": q, "v": v, "u": u, "k": k[: native.nk - len(u)]}

    def called(name: str) -> Array:
        return python[name](*(given[of] for of in signature(python[name]).parameters))

    yield "Python: mass", apart_of(called("mass"), native.mass(q, k))
    yield "Python: force", apart_of(called("force"), native.force(t, q, v, k))
    if native.nlambda:
        yield "Python: g", apart_of(called("constraints"), native.constraints(t, q, k))
        yield "Python: G", apart_of(called("constraint_jacobian"), native.constraint_jacobian(t, q, k))
        yield "Python: gdot", apart_of(called("constraint_rates"), native.constraint_rates(t, q, v, k))
        yield "Python: gamma", apart_of(called("constraint_bias"), native.constraint_bias(t, q, v, k))


def disagreements(model: SpaceModel, seed: int, limit: float = LIMIT) -> list[str]:
    """Functions that differ by more than the limit in a random state."""
    return [
        f"{name}: {size:.2e}"
        for name, size in differences(model, *random_state(model.native, seed))
        if not size < limit
    ]


def _with_positive_masses(model: SpaceModel, t: float, q: Array) -> Array:
    """q with amplitudes halved until masses are positive, which order 2 does not promise far from the undeformed body.

    Accelerations are compared there; all other functions are compared with the given amplitudes.
    """
    amplitudes = np.array(["alpha" in name for name in model.native.coordinates])
    while np.linalg.eigvalsh(mass_matrix(model.native, q, model.constants(t)))[0] <= 0 and np.any(q[amplitudes]):
        q = np.where(amplitudes, q / 2, q)
    return q
