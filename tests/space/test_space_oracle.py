"""The oracle of spatial scenes against what is known already: lone bodies in space, and planar mechanisms."""

from __future__ import annotations

import tomllib
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np
import pytest
from decimal_vectors import about, array, floats, identity, of_quaternion, precise
from mass_points import inertia_tensor, rigid_points
from nodal_points import NodalFields
from space_oracle import SpaceOracle, apart
from written_scene import rotation

import derive
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.generated_models import generated
from derive.runtime.compiled_model import Native
from derive.runtime.loading import load_scene
from derive.spec.toml.read import parse

MODES, NODES = 3, 8
GRAVITY = (0.7, -0.3, -9.81)
MARKERS = {"first": 0, "last": 7}


def nodes() -> dict[str, np.ndarray]:
    """A cloud of nodes with a mass matrix that couples them, and modes that hold rigid motion."""
    rng = np.random.default_rng(5)
    root, half = rng.uniform(-1, 1, (NODES, NODES)), rng.uniform(-1, 1, (MODES, MODES))
    mass = np.diag(rng.uniform(1, 2, NODES)) + 0.1 * root @ root.T
    rows, columns = np.nonzero(mass)
    return {
        "positions": rng.uniform(-1, 1, (NODES, 3)),
        "mass_row": rows,
        "mass_col": columns,
        "mass_value": mass[rows, columns],
        "modes": rng.uniform(-1, 1, (MODES, NODES, 3)),
        "modal_stiffness": half @ half.T * 50,
    }


@cache
def lone() -> tuple[Native, SpaceOracle]:
    """The compiled code of a body alone, and the oracle of the same body in a scene."""
    damping = {"mass": 0.1, "stiffness": 0.01}
    given = nodes()
    body = derive.nodal_body(
        "cloud", given, units="SI", frame="given", modes=MODES, orthonormal=False, damping=damping, markers=MARKERS
    )
    gravity = derive.symbolic_body("g", 1, gravity=list(GRAVITY)).gravity
    model = derive.lower(derive.derive_modal(derive.modal(body), gravity, "flat"))
    native = derive.load(CBackend().files(model, "test"), QUICK)
    mass = np.zeros((NODES, NODES))
    mass[given["mass_row"], given["mass_col"]] = given["mass_value"]
    scene = {
        "scene": {"gravity": GRAVITY},
        "bodies": {"cloud": {"nodes": "", "damping": damping, "markers": MARKERS}},
    }
    names = [f"cloud_{x}" for x in ("c1", "c2", "c3", "e0", "e1", "e2", "e3", "alpha1", "alpha2", "alpha3")]
    with precise():
        fields = NodalFields(*(array(x) for x in (given["positions"], mass, given["modes"], given["modal_stiffness"])))
        return native, SpaceOracle(scene, names, fields={"cloud": fields})


@pytest.mark.parametrize("seed", [1, 2])
def test_a_lone_body(seed: int) -> None:
    native, oracle = lone()
    rng = np.random.default_rng(seed)
    e = rng.normal(size=4)
    q = np.concatenate([rng.uniform(-2, 2, 3), e / np.linalg.norm(e), rng.uniform(-0.5, 0.5, MODES)])
    v, k = rng.uniform(-2, 2, 6 + MODES), native.setup()
    seen = oracle.see(0.0, q, v)
    values, h = native.mass_force(0.0, q, v, k)
    assert apart(native.mass_pattern.dense(values), seen.M, seen.mass_sizes) < 1e-15
    assert apart(h, seen.h, seen.force_sizes) < 1e-15
    kinetic, strain, gravity = native.energy(q, v, k)
    assert [kinetic, strain, gravity] == pytest.approx([float(x) for x in seen.energy.values()], rel=1e-13)
    assert native.momentum(q, v, k) == pytest.approx(floats(seen.momentum), rel=1e-12, abs=1e-13)
    for name in MARKERS:
        for found, expected in zip(native.marker(name, q, v, k)[:2], seen.markers[f"cloud.{name}"][:2], strict=True):
            assert found == pytest.approx(floats(expected), abs=1e-14)


def test_six_points_have_the_mass_and_the_inertia_of_a_body() -> None:
    """Also where all mass lies in a plane or on a line."""
    for six in ((3, 4, 5, 1, -1, 0.5), (1, 2, 3, 0, 0, 0), (0, 2, 2, 0, 0, 0)):
        with precise():
            mass, centre, J = Decimal(2), array([1, -2, 3]), inertia_tensor(array(six))
            masses, points = rigid_points(mass, centre, J)
            first = sum(m * x for m, x in zip(masses, points, strict=True)) / mass
            arms = points - centre
            second = sum(m * ((r @ r) * identity(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True))
            assert abs(sum(masses) - mass) < Decimal("1e-50") and max(abs(first - centre)) < Decimal("1e-50")
            assert max(abs(second - J).ravel()) < Decimal("1e-50")


def test_forms_of_a_rotation() -> None:
    """A quaternion, an axis with an angle, two axes, and three angles of the turning frame."""
    with precise():
        quarter = rotation({"axis": [0, 0, 2], "angle": Decimal("0.5")})
        half = Decimal("0.25")
        e = array([float(np.cos(0.25)), 0, 0, float(np.sin(0.25))])
        assert max(abs(rotation(e) - quarter).ravel()) < Decimal("1e-16")
        assert max(abs(of_quaternion(3 * e) - quarter).ravel()) < Decimal("1e-16")
        axes = rotation({"x": [0, 3, 0], "z": [0, 0, 2]})
        assert [[int(x) for x in row] for row in axes] == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        turned = rotation({"angles": [half, 2 * half, -half], "sequence": "xyx"})
        x, y = array([half, 0, 0]), array([0, 2 * half, 0])
        assert max(abs(turned - about(x) @ about(y) @ about(-x)).ravel()) < Decimal("1e-50")
        assert max(abs(about(x) @ array([0, 1, 0]) - array([0, np.cos(0.25), np.sin(0.25)]))) < Decimal("1e-15")


PLANAR = """
name = "planar_arms"
[scene]
gravity = [0.5, -9.81]
[ground.markers]
base = [0.1, 0.2]
post = [2, 1]
[bodies.arm]
mass = 2
inertia = 0.3
centre = [0.4, 0.1]
keep_coordinates = true
markers = { root = [0, 0], tip = [0.9, 0] }
[bodies.fore]
mass = 1.5
inertia = 0.2
centre = [0.3, -0.1]
keep_coordinates = true
markers = { root = [0, 0.05], tip = [0.7, 0] }
[joints.shoulder]
kind = "revolute"
between = ["ground.base", "arm.root"]
[joints.elbow]
kind = "revolute"
between = ["arm.tip", "fore.root"]
[forces.push]
at = "fore.tip"
components = ["1+t", "2*sin(t)"]
frame = "body"
[torques.motor]
at = "arm.root"
value = 3
[springs.strut]
between = ["ground.post", "fore.tip"]
stiffness = 40
damping = 2
rest = 0.5
[simulation]
duration = 1
output = 1
"""


def in_space(tables: dict[str, Any]) -> dict[str, Any]:
    """The planar scene in space, where it moves in a plane because its joints turn about z."""
    bodies = {
        name: {
            "mass": table["mass"],
            "centre": [*table["centre"], 0],
            "inertia": [table["inertia"] / 2, table["inertia"] / 2, table["inertia"], 0, 0, 0],
            "markers": {marker: [*x, 0] for marker, x in table["markers"].items()},
        }
        for name, table in tables["bodies"].items()
    }
    ground = {marker: [*x, 0] for marker, x in tables["ground"]["markers"].items()}
    return {
        **tables,
        "scene": {"gravity": [*tables["scene"]["gravity"], 0]},
        "ground": {"markers": ground},
        "bodies": bodies,
        "forces": {name: {**f, "force": [*f["components"], 0]} for name, f in tables["forces"].items()},
        "torques": {name: {"on": f["at"], "torque": [0, 0, f["value"]]} for name, f in tables["torques"].items()},
    }


def test_a_planar_mechanism_in_space() -> None:
    """Two arms on hinges move as the compiled planar scene does."""
    _, files = generated(parse(PLANAR))
    native = load_scene(files, QUICK)
    k, names = native.setup(), list(native.coordinates)
    q, v, t = np.zeros(6), np.zeros(6), 0.3
    tables = tomllib.loads(PLANAR)
    angles, rates = {"arm": 0.4, "fore": 1.3}, {"arm": 1.5, "fore": -2.0}
    origin, velocity = np.array([0.1, 0.2]), np.zeros(2)
    coordinates: list[str] = []
    qs: list[float] = []
    vs: list[float] = []
    for name, table in tables["bodies"].items():
        phi, omega = angles[name], rates[name]
        Q = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
        root, tip, centre = (np.array(x) for x in (*table["markers"].values(), table["centre"]))

        def rate(r: np.ndarray, Q: np.ndarray = Q, omega: float = omega) -> np.ndarray:
            x, y = Q @ r
            return omega * np.array([-y, x])

        origin, velocity = origin - Q @ root, velocity - rate(root)
        c, cdot = origin + Q @ centre, velocity + rate(centre)
        for values, of in ((q, (*c, phi)), (v, (*cdot, omega))):
            values[[names.index(f"{name}_{x}") for x in ("c1", "c2", "phi")]] = of
        coordinates += [f"{name}_{x}" for x in ("c1", "c2", "c3", "e0", "e1", "e2", "e3")]
        qs += [*c, 0, np.cos(phi / 2), 0, 0, np.sin(phi / 2)]
        vs += [*cdot, 0, 0, 0, omega]
        origin, velocity = origin + Q @ tip, velocity + rate(tip)
    assert np.max(np.abs(native.constraints(t, q, k))) < 1e-15
    oracle = SpaceOracle(in_space(tables), coordinates)
    seen = oracle.see(t, np.array(qs), np.array(vs))
    assert np.max(np.abs(floats(seen.g))) < 1e-15 and np.max(np.abs(floats(seen.gdot))) < 1e-14
    vdot, lam = (floats(x) for x in seen.accelerations())
    planar, multipliers = native.solve(t, q, v, k)
    assert np.allclose(vdot.reshape(2, 6)[:, 5], planar[[2, 5]], rtol=1e-13)
    assert np.allclose(vdot.reshape(2, 6)[:, 2:5], 0, atol=1e-13)
    named = dict(zip(native.multipliers, multipliers, strict=True))
    for joint in ("shoulder", "elbow"):
        force = [lam[seen.rows.index(f"{joint}_{x}")] for x in "xyz"]
        assert np.allclose(force, [named[f"{joint}_1"], named[f"{joint}_2"], 0], rtol=1e-12, atol=1e-12)
