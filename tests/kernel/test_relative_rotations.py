"""Rotations relative to each other: the changes of a system solve it, and which joints of a scene take part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

import derive
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.model import Model
from derive.ir.patterns import pattern
from derive.lowering.flat.context import Context
from derive.lowering.flat.joint_turns import joint_turns
from derive.lowering.ldlt import backward, factorise, forward
from derive.lowering.relative_rotations import InertialRotations, RelativeElimination, RelativeTurn

Array = np.ndarray[Any, np.dtype[np.float64]]
NODES = ((0, 1, 2), (3, 4, 5), (6, 7, 8))
CRANK = 9
"""A coordinate that turns what the first body is joined to."""
COORDINATES = 10
TWO, THREE, ONE, LOOP = (10, 11), (12, 13, 14), (15,), (16,)
"""Multipliers: of a hinge on the crank, of a weld, of a universal joint, and of a constraint that closes a loop."""
SIZE = 17


@dataclass(frozen=True)
class Example:
    """Rotation tensors of three bodies, the inertial axes of the rows of joints, that of the crank, and the matrix."""

    tensors: list[Array]
    axes: dict[int, Array]
    crank: Array
    matrix: Array

    @property
    def turns(self) -> tuple[RelativeTurn, ...]:
        """The joints from the last body on."""
        crank = ((CRANK, vector(self.crank)),)
        return (
            RelativeTurn(NODES[2], NODES[1], (), ONE),
            RelativeTurn(NODES[1], NODES[0], (), THREE),
            RelativeTurn(NODES[0], None, crank, TWO),
        )


def vector(values: Array) -> list[ca.SX]:
    return [ca.SX(float(x)) for x in values]


@pytest.fixture(name="example")
def _example() -> Example:
    rng = np.random.default_rng(3)
    tensors = [q * np.linalg.det(q) for q in (np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in NODES)]
    axes = {m: rng.normal(size=3) for m in (*TWO, *THREE, *ONE)}
    crank = rng.normal(size=3)
    half = rng.normal(size=(COORDINATES, COORDINATES))
    G = np.zeros((SIZE - COORDINATES, COORDINATES))
    ends = {**dict.fromkeys(TWO, (0, None)), **dict.fromkeys(THREE, (1, 0)), **dict.fromkeys(ONE, (2, 1))}
    for m, (child, parent) in ends.items():
        G[m - COORDINATES, list(NODES[child])] = tensors[child].T @ axes[m]
        if parent is None:
            G[m - COORDINATES, CRANK] = -axes[m] @ crank
        else:
            G[m - COORDINATES, list(NODES[parent])] = -tensors[parent].T @ axes[m]
    G[LOOP[0] - COORDINATES] = rng.normal(size=COORDINATES)
    none = np.zeros((len(G), len(G)))
    return Example(tensors, axes, crank, np.block([[half @ half.T + np.eye(COORDINATES), -G.T], [-G, none]]))


def test_the_changes_and_the_rest_solve_the_system(example: Example) -> None:
    """One rotation stays of the hinge, none of the weld, three of the universal joint; the rest is a KKT matrix."""
    matrix = example.matrix
    entries = {(i, j): ca.SX(x) for i, row in enumerate(matrix.tolist()) for j, x in enumerate(row[: i + 1]) if x}
    Q = {rows: [vector(row) for row in of] for rows, of in zip(NODES, example.tensors, strict=True)}
    inertial = InertialRotations(Q, {})
    inertial.change(entries)
    relative = RelativeElimination(entries, example.turns)
    assert {*relative.gone} == {0, 1, *TWO, 3, 4, 5, *THREE}
    assert {j for i, j in entries if i == ONE[0]} == {*NODES[2]}, "a joint turns what it carries alone"
    assert not any(i == j >= COORDINATES for i, j in entries)
    left = pattern(SIZE, SIZE, set(entries), symmetric=True)
    order = tuple(i for i in range(SIZE) if i not in relative.gone)
    factors = factorise(left, entries, order, COORDINATES)
    right = np.arange(1.0, 1 + SIZE)
    eliminated = forward(factors, relative.forward(inertial.forward(vector(right))))
    solution = backward(factors, eliminated)
    turned = relative.backward(eliminated, {i: solution[i] for i in order})
    x = np.array([float(value) for value in inertial.backward(turned)])
    assert np.allclose(matrix @ x, right, rtol=1e-11, atol=1e-11)
    assert all(float(p) > 0 if j < COORDINATES else float(p) < 0 for p, j in zip(factors.pivots, order, strict=True))


HEAD = """
name = "mixed"
[scene]
gravity = [0, 1, -9.81]
[ground.markers]
base = { at = [0.1, 0, 0], rotation = { axis = [1, 2, 0], angle = 0.4 } }
wall = [1, 1, 0]
"""
BODY = """
[bodies.{name}]
mass = 1.5
inertia = [0.2, 0.3, 0.4, 0.02, 0.01, -0.03]
keep_coordinates = {keep}
markers.near = {{ at = [-0.3, 0.1, 0], rotation = {{ axis = [0, 1, 1], angle = 0.3 }} }}
markers.far = {{ at = [0.4, 0, 0.2], rotation = {{ axis = [1, 0, 1], angle = -0.6 }} }}
"""
JOINT = '\n[joints.{name}]\nkind = "{kind}"\nbetween = ["{first}", "{second}"]\n'


def scene(bodies: dict[str, bool], joints: dict[str, tuple[str, str, str]], folder: Path) -> derive.Mechanism:
    """The mechanism of a scene; bodies: whether each keeps all of its coordinates."""
    path = folder / "mixed.toml"
    parts = [BODY.format(name=name, keep=str(keep).lower()) for name, keep in bodies.items()]
    parts += [JOINT.format(name=n, kind=k, first=a, second=b) for n, (k, a, b) in joints.items()]
    path.write_text(HEAD + "".join(parts))
    return derive.derive(derive.read(path))


CASES = {
    "a chain on a crank, with a loop": (
        {"crank": False, "one": True, "two": True, "three": True},
        {
            "bearing": ("revolute", "ground.base", "crank.near"),
            "pin": ("revolute", "one.near", "crank.far"),
            "slide": ("prismatic", "one.far", "two.near"),
            "cross": ("universal", "three.near", "two.far"),
            "end": ("point_on_line", "ground.wall", "three.far"),
        },
    ),
    "bodies that nothing holds": (
        {"one": True, "two": True, "three": True},
        {"weld": ("fixed", "one.far", "two.near"), "tube": ("cylindrical", "three.far", "two.far")},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_accelerations_solve_the_equations_of_a_scene(case: str, tmp_path: Path) -> None:
    """M vdot + h = G^T lambda and G vdot = gamma, in random states, with M, h, G and gamma of the other functions."""
    model = derive.lower(scene(*CASES[case], tmp_path), explicit=True)
    assert "relative" in next(s.doc for s in model.kernel("solve").sections if s.name == "pivots")
    for seed in range(3):
        M, h, G, gamma, vdot, lam = values(model, seed)
        condition = np.linalg.cond(np.block([[M, G.T], [G, np.zeros((len(G), len(G)))]]))
        size = condition * 1e-13 * max(1.0, *np.abs(vdot), *np.abs(lam))
        assert np.abs(M @ vdot + h - G.T @ lam).max() < size * np.abs(M).max() and condition < 1e5
        assert np.abs(G @ vdot - gamma).max() < size * np.abs(G).max()


def values(model: Model, seed: int) -> Iterator[Array]:
    """M, h, G, gamma, vdot and lambda in a random state."""
    rng = np.random.default_rng(seed)
    q, v = rng.normal(size=len(model.coordinates)), rng.normal(size=len(model.equations))
    k = [0.0] * 400
    if any(kernel.name == "setup" for kernel in model.kernels):
        k = interpret(model.kernel("setup"), {"p": list(model.defaults)}).get("k", k)
    for i, c in enumerate(model.coordinates):
        if c.name.endswith("e0"):
            q[i : i + 4] /= np.linalg.norm(q[i : i + 4])
    known = {"t": 0.3, "q": q, "v": v, "k": k, "u": []}

    def result(name: str) -> dict[str, Any]:
        kernel = model.kernel(name)
        return interpret(kernel, {a.name: known[a.name] for a in kernel.arguments})

    yield model.pattern("mass", "M").dense(np.array(result("mass")["M"]))
    yield np.array(result("force")["h"])
    yield model.pattern("constraint_jacobian", "G").dense(np.array(result("constraint_jacobian")["G"]))
    yield np.array(result("constraint_bias")["gamma"])
    solved = result("solve")
    yield np.array(solved["vdot"])
    yield np.array(solved["lam"])


def test_the_joints_are_a_forest(tmp_path: Path) -> None:
    """Joints that remove more come first; one that closes a loop stays, and one of points turns nothing."""
    joints = {
        "a": ("universal", "ground.base", "one.near"),
        "b": ("revolute", "two.near", "one.far"),
        "c": ("fixed", "ground.wall", "two.far"),
        "d": ("spherical", "three.near", "two.far"),
    }
    equations = scene(dict.fromkeys(("one", "two", "three"), True), joints, tmp_path).expanded()
    context = Context(equations)
    found = joint_turns(context, context.symbols(context.t, context.q))
    assert found is not None
    names = (*context.rows, *context.multipliers)
    turns = [([names[m] for m in turn.multipliers], names[turn.rows[0]], turn.parent) for turn in found.turns]
    two = tuple(context.rows.index(f"two_pi{i}") for i in (1, 2, 3))
    assert turns == [(["b_rx", "b_ry"], "one_pi1", two), (["c_rx", "c_ry", "c_rz"], "two_pi1", None)]
    assert joint_turns(Context(equations, proximal=True), context.symbols(context.t, context.q)) is None


def test_dependent_axes_are_found(tmp_path: Path) -> None:
    """Where z of the second marker is normal to z of the first, the axes that a hinge removes are parallel."""
    model = derive.lower(scene({"one": True}, {"pin": ("revolute", "ground.wall", "one.near")}, tmp_path))
    kernel = model.kernel("accel")
    q, angle = np.zeros(7), np.pi / 4
    near = np.array([np.cos(0.15), 0, np.sin(0.15) / np.sqrt(2), np.sin(0.15) / np.sqrt(2)])
    turn = np.array([np.cos(angle), np.sin(angle), 0, 0])
    w, x = near[0], -near[1:]
    q[3:] = [turn[0] * w - turn[1:] @ x, *(turn[0] * x + w * turn[1:] + np.cross(turn[1:], x))]
    arguments = {"t": 0.0, "q": q, "v": np.ones(6), "k": [], "u": []}
    with pytest.raises(RequirementError, match="the axes of pin_rx, pin_ry became dependent"):
        interpret(kernel, {a.name: arguments[a.name] for a in kernel.arguments})
