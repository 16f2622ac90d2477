"""Rigid sets of nodes of finite-element bodies: computed modes have the constraint, and modes of files must meet it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import coo_array

import derive
from derive.reduction.body import prepare
from derive.reduction.eigen import MAX_DENSE_SIZE
from derive.reduction.frame_points import modal_frames
from derive.spec.toml.read import parse
from spring_lattice import lattice

SET = [0, 1, 2, 3]
MODES = 5


def scene(folder: Path, arrays: dict[str, np.ndarray], marker: str) -> str:
    np.savez(folder / "lattice.npz", **arrays)
    return f"""
name = "rigid_sets"
[ground.markers]
o = [0, 0, 0]
[bodies.truss]
nodes = "{folder}/lattice.npz"
units = "SI"
modes = {MODES}
[bodies.truss.markers]
face = {marker}
[joints.hinge]
kind = "revolute"
between = ["ground.o", "truss.face"]
"""


def constrained_frequencies(arrays: dict[str, np.ndarray]) -> np.ndarray:
    """omega^2 of the body whose set moves as a rigid body, from Lagrange multipliers of constant distances."""
    x, n = arrays["positions"], len(arrays["positions"])
    k = coo_array((arrays["stiffness_value"], (arrays["stiffness_row"], arrays["stiffness_col"]))).toarray()
    rows = []
    for a in range(len(SET)):
        for b in range(a):
            row = np.zeros((n, 3))
            row[SET[a]], row[SET[b]] = x[SET[a]] - x[SET[b]], x[SET[b]] - x[SET[a]]
            rows.append(row.ravel())
    # four nodes in a plane keep their distances also to first order out of it: the volume is a row of its own
    normal = np.cross(x[SET[1]] - x[SET[0]], x[SET[2]] - x[SET[0]])
    out = np.zeros((n, 3))
    out[SET[0]], out[SET[1]], out[SET[2]], out[SET[3]] = normal, -normal, -normal, normal
    rows.append(out.ravel())
    _, sizes, vt = np.linalg.svd(np.array(rows))
    free = vt[int(np.sum(sizes > 1e-9 * sizes[0])) :].T
    m = np.diag(np.repeat(arrays["mass"], 3))
    return eigh(free.T @ k @ free, free.T @ m @ free, eigvals_only=True)[6 : 6 + MODES]


@pytest.mark.parametrize("bays", [3, 80])
def test_computed_modes_have_the_constraint(tmp_path: Path, bays: int) -> None:
    arrays = lattice(bays)
    assert (3 * len(arrays["positions"]) > MAX_DENSE_SIZE) == (bays == 80), "both solvers are tested"
    rigid, mean = (
        parse(scene(tmp_path, arrays, f'{{ nodes = {SET}, motion = "{motion}" }}')).bodies[0]
        for motion in ("rigid", "mean")
    )
    shapes = prepare(rigid.body).shapes
    assert np.diag(shapes.stiffness) == pytest.approx(constrained_frequencies(arrays), rel=1e-7)
    if bays == 3:  # the end of a longer body hardly matters
        assert np.abs(np.diag(prepare(mean.body).shapes.stiffness) / np.diag(shapes.stiffness) - 1).max() > 1e-4
    (frame,) = modal_frames(rigid)
    levers = shapes.x[SET] - frame.point.position
    moved = frame.point.shapes[:, None] + np.cross(frame.twists[:, None], levers[None])
    assert shapes.phi[:, SET] == pytest.approx(moved, abs=1e-9 * np.abs(shapes.phi).max())


def test_given_modes_have_to_meet_the_constraint(tmp_path: Path) -> None:
    arrays = lattice(3)
    spec = parse(scene(tmp_path, arrays, f'{{ nodes = {SET}, motion = "rigid" }}')).bodies[0]
    shapes = prepare(spec.body).shapes
    own = {key: arrays[key] for key in ("positions", "mass")}
    given = {**own, "modes": shapes.phi, "modal_stiffness": np.diag(shapes.stiffness)}
    meets = scene(tmp_path, given, f'{{ nodes = {SET}, motion = "rigid" }}')
    expected, (frame,) = modal_frames(spec)[0], modal_frames(parse(meets).bodies[0])
    assert frame.twists == pytest.approx(expected.twists, abs=1e-9)
    given["modes"] = shapes.phi.copy()
    given["modes"][2, 0, 0] += 1e-3 * np.abs(shapes.phi[2]).max()
    deforms = scene(tmp_path, given, f'{{ nodes = {SET}, motion = "rigid" }}')
    with pytest.raises(derive.SpecError, match=r"mode 3 deforms this rigid set of nodes by 0.000\d+ of its largest"):
        derive.derive(parse(deforms))
    derive.derive(parse(deforms.replace('"rigid"', '"mean"')))


def test_faults_of_rigid_sets(tmp_path: Path) -> None:
    text = scene(tmp_path, lattice(3), '{ node = 3, motion = "rigid" }').replace("revolute", "spherical")
    with pytest.raises(derive.SpecError, match="a single node has no rotation"):
        parse(text)
    line = scene(tmp_path, lattice(3), '{ nodes = [0, 4, 8], motion = "rigid" }')
    with pytest.raises(derive.SpecError, match="lie on a line"):
        derive.derive(parse(line))
    twice = scene(tmp_path, lattice(3), '{ nodes = [0, 1, 2], motion = "rigid" }').replace(
        "[joints", 'other = { nodes = [2, 3, 4], motion = "rigid" }\n[joints'
    )
    with pytest.raises(derive.SpecError, match=r"node 2 is in the rigid set face as well"):
        parse(twice)
