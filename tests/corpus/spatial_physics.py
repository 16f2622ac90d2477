"""Physics on a scene in space: accelerations and reactions against the oracle of material points, and constraints.

In some states of a motion, M vdot + h = G^T lambda and G vdot = gamma, with numbers of the oracle for all but vdot and
lambda; constraints and the lengths of quaternions are met along the motion.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import derive
from corpus.commands import Finding
from corpus.generator import CorpusScene
from derive.reduction.body import prepare
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import STEADY
from derive.spec.model.spatial_beam import SpatialBeam

sys.path.append(str(Path(__file__).parents[1] / "space"))
from decimal_vectors import array, floats, number, precise
from nodal_points import NodalFields
from space_oracle import SpaceOracle
from written_scene import tables

ROWS = 3
"""The states of a motion that are checked."""
LIMIT = 1e-10
"""The largest error of an equation, relative to the largest sum of magnitudes in one."""
AT_REST = 1e-3
"""Floors that are added to magnitudes, N and m/s^2, since nothing moves in some scenes."""
STAYS = 1e-6
"""The largest change of a distance of two markers in a steady rotation, relative to the largest distance."""
CLOSED = 1e-9
"""The largest constraint, relative to the size of the scene, m and rad."""

Vector = np.ndarray


def physics_in_space(scene: CorpusScene, path: Path) -> Iterator[Finding]:
    """Yield what the motion of a scene contradicts."""
    spec = derive.read(path)
    run = PreparedRun(spec, complete=False)
    motion = run.trajectory().motion
    native = motion.native
    if any(isinstance(body, SpatialBeam) and body.pieces > 1 for body in spec.bodies):
        return  # the oracle knows no pieces; their equations: tests/space/test_spatial_beam_pieces.py
    # The oracle has truncated beams alone; full ones are compared with points in tests/space/test_full_second_order.py.
    full = any(getattr(body, "order", None) is DisplacementOrder.FULL for body in spec.bodies)
    oracle = SpaceOracle(tables(path), native.coordinates, native.multipliers, folder=path.parent, fields=fields(spec))
    for i in np.unique(np.linspace(0, len(motion.t) - 1, ROWS).astype(int)):
        t, q, v = float(motion.t[i]), motion.q[i], motion.v[i]
        if not full:
            yield from _equations(oracle, native, motion.k, t, q, v)
        worst = np.abs(native.constraints(t, q, motion.k)).max(initial=0)
        if not worst < CLOSED:
            yield Finding("physics", "constraints are not met", f"t = {t:g}: {worst:.2g}")
        if spec.start == STEADY:
            yield from _rigid(oracle, t, q, float(motion.t[0]), motion.q[0])
        for j, name in enumerate(native.coordinates):
            if name.endswith("_e0") and not abs(np.linalg.norm(q[j : j + 4]) - 1) < 1e-14:
                yield Finding("physics", "a quaternion has not the length 1", f"t = {t:g}: {name}")


def _rigid(oracle: SpaceOracle, t: float, q: Vector, t0: float, q0: Vector) -> Iterator[Finding]:
    """A motion that began in a steady state leaves the distances of all markers as they are."""
    now, before = (_distances(oracle, *state) for state in ((t, q), (t0, q0)))
    worst = np.abs(now - before).max(initial=0) / (1e-3 + before.max(initial=0))
    if not worst < STAYS:
        yield Finding("physics", "a steady start does not stay steady", f"t = {t:g}: distances change by {worst:.2g}")


def _distances(oracle: SpaceOracle, t: float, q: Vector) -> Vector:
    state = oracle.columns.state(q)
    poses = oracle.poses(number(t), state)
    x = np.array([floats(oracle.frame(marker, state, poses)[0]) for marker in oracle.all_markers()])
    return np.asarray(np.linalg.norm(x[:, None] - x[None, :], axis=2))


def fields(spec: derive.Specification) -> dict[str, NodalFields]:
    """Nodes and modes of flexible bodies in their frames, as the reduction gives them."""
    result = {}
    for body in spec.bodies:
        nodal = getattr(body, "body", None)
        if nodal is not None:
            prepared = prepare(nodal)
            shapes = prepared.shapes
            with precise():
                result[body.name] = NodalFields(
                    array(shapes.x), array(prepared.mass.toarray()), array(shapes.phi), array(shapes.stiffness)
                )
    return result


def _equations(
    oracle: SpaceOracle, native: derive.NativeScene, k: Vector, t: float, q: Vector, v: Vector
) -> Iterator[Finding]:
    """The equations of motion and of the constraints, with the accelerations of the compiled code."""
    seen = oracle.see(t, q, v)
    vdot, lam = native.solve(t, q, v, k)
    rows = [seen.rows.index(name) for name in native.multipliers]
    M, h, G, gamma = floats(seen.M), floats(seen.h), floats(seen.G[rows]), floats(seen.gamma[rows])
    size = np.abs(M) @ np.abs(vdot) + floats(seen.force_sizes) + np.abs(G).T @ np.abs(lam)
    errors = {"motion": np.abs(M @ vdot + h - G.T @ lam).max(initial=0) / (size.max(initial=0) + AT_REST)}
    speeds = np.abs(G) @ np.abs(vdot) + np.abs(gamma)
    errors["constraints"] = np.abs(G @ vdot - gamma).max(initial=0) / (speeds.max(initial=0) + AT_REST)
    for name, error in errors.items():
        if not error < LIMIT:
            text = f"t = {t:g}: {error:.2g}"
            yield Finding("physics", f"the oracle contradicts the equations of {name}", text)
