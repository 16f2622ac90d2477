"""Constraints in space through the frames on which they act, beside the entries of G, which know no frames."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

import derive
from conftest import ROOT
from derive.ir.expressions import Number
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.lowering.flat.frame_loads import acceleration_residual, reactions
from derive.lowering.flat.kkt_matrix import jacobian_entries

Array = NDArray[np.float64]

LIMIT = 1e-13
"""The largest difference, relative to the sum of the magnitudes of the terms."""
ROD = f"""
[bodies.NAME]
nodes = "{ROOT}/examples/spatial_rod.npz"
units = "SI"
[bodies.NAME.markers]
left = {{ nodes = [0, 1, 2, 3, 4, 5, 6, 7, 8] }}
right = {{ nodes = [108, 109, 110, 111, 112, 113, 114, 115, 116], rotation = {{ axis = [1, 2, 3], angle = 0.4 }} }}
"""
SCENE = f"""
name = "frames"
[scene]
gravity = [1, 2, -9]
[ground.markers]
base = {{ at = [0.1, -0.2, 0.3], rotation = {{ axis = [1, 2, 3], angle = 0.7 }} }}
{ROD.replace("NAME", "a")}
{ROD.replace("NAME", "b")}
[bodies.c]
mass = 2
inertia = [0.3, 0.4, 0.5, 0, 0, 0]
keep_coordinates = true
markers = {{ top = [0.1, 0.2, 0.3], end = [-0.2, 0.1, 0] }}
[joints.weld]
kind = "fixed"
between = ["a.right", "b.left"]
[joints.bearing]
kind = "revolute"
between = ["a.right", "c.top"]
[joints.slot]
kind = "cylindrical"
between = ["ground.base", "a.left"]
[joints.rod]
kind = "distance"
between = ["b.right", "c.end"]
distance = 0.3
[joints.slide]
kind = "prismatic"
between = ["ground.base", "c.end"]
[gears.teeth]
joints = ["bearing", "slot"]
ratio = 2
"""
"""Frames with several joints, first and second in these, and a constraint without frames."""


@pytest.fixture(scope="module")
def context(tmp_path_factory: pytest.TempPathFactory) -> Context:
    path: Path = tmp_path_factory.mktemp("frames") / "frames.toml"
    path.write_text(SCENE)
    return Context(derive.derive(derive.read(path)).expanded())


def values(symbols: Symbols, expressions: list[ca.SX]) -> Array:
    """The values in a random state, whose quaternions are no unit quaternions, and with the numbers of the model."""
    random = np.random.default_rng(1).uniform(-1.5, 1.5, len(symbols.inputs))
    numbers = [float(s.value) if isinstance(s, Number) else x for s, x in zip(symbols.leaves, random, strict=True)]
    function = ca.Function("values", [ca.vertcat(*symbols.inputs)], [ca.densify(ca.vertcat(*expressions))])
    result: Array = function(numbers).full().ravel()
    return result


def dense(context: Context, entries: dict[tuple[int, int], float]) -> Array:
    G = np.zeros((len(context.multipliers), len(context.rows)))
    for (i, j), value in entries.items():
        G[i, j] = value
    return G


def test_reactions_are_those_of_the_entries_of_g(context: Context) -> None:
    symbols = context.symbols(context.t, context.q, context.v, context.lam)
    entries = jacobian_entries(context, symbols)
    found = reactions(context, symbols, context.forces)
    every = values(symbols, [*found, *entries.values(), *symbols.values_of(context.forces)])
    size, count = len(found), len(entries)
    G = dense(context, dict(zip(entries, every[size : size + count], strict=True)))
    loads = every[size + count :]
    assert np.all(abs(every[:size] - loads @ G) <= LIMIT * (abs(loads) @ abs(G)))
    assert np.all(abs(loads) @ abs(G) > 0)


def test_accelerations_of_frames_are_those_of_the_entries_of_g(context: Context) -> None:
    symbols = context.symbols(context.t, context.q, context.v, context.vdot)
    eq = context.equations
    entries = jacobian_entries(context, symbols)
    found = [acceleration_residual(c, context, symbols) for c in eq.constraints]
    bias = [symbols(c.bias) for c in eq.constraints]
    every = values(symbols, [*found, *bias, *entries.values(), *symbols.values_of(context.vdot.symbols)])
    size, count = len(found), len(entries)
    gammas = every[size : 2 * size]
    G = dense(context, dict(zip(entries, every[2 * size : 2 * size + count], strict=True)))
    vdot = every[2 * size + count :]
    sizes = abs(gammas) + abs(G) @ abs(vdot)
    assert np.all(abs(every[:size] - G @ vdot - gammas) <= LIMIT * sizes)
    assert np.any(gammas)
