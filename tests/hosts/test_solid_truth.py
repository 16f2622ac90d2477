"""Bodies of CalculiX beside theory: a cantilever, a plate and a cube, with the error that each theory leaves.

The meshes are of quadratic bricks with reduced integration (C3D20R), and CalculiX writes their matrices.
"""

from __future__ import annotations

import subprocess
import sys
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from programs import program
from scipy.linalg import eigh, expm
from scipy.optimize import brentq

import derive
from conftest import ROOT
from derive.fem.calculix.read import read_calculix
from derive.fem.imported_body import BodyOptions, imported_body
from derive.reduction import body_properties
from derive.reduction.body import prepare
from derive.spec.model.body import NodalBody
from derive.spec.model.mesh import ElementKind
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene

sys.path.append(str(ROOT / "tests/solids"))
from grid_meshes import box_mesh

pytestmark = pytest.mark.hosts

YOUNG, POISSON, DENSITY = 210e9, 0.3, 7800.0
SHEAR = YOUNG / (2 + 2 * POISSON)

LENGTH, WIDTH, HEIGHT, FORCE = 0.5, 0.03, 0.02, 10.0
SIDE = 0.1
AREA = WIDTH * HEIGHT
SHEAR_FACTOR = 10 * (1 + POISSON) / (12 + 11 * POISSON)
"""Cowper's, of a rectangular section."""


def run_box(folder: Path, sides: tuple[float, ...], bricks: tuple[int, ...], element: str = "C3D20R") -> Path:
    """Run CalculiX on a box, whose node sets are its end faces, and return the input beside the matrices."""
    x, mesh = box_mesh(ElementKind.HEX20, sides, bricks)
    x = x - np.array([0, *sides[1:]]) / 2
    (block,) = mesh.elements
    lines = ["*NODE, NSET=all", *(f"{i}, {a:.12g}, {b:.12g}, {c:.12g}" for i, (a, b, c) in enumerate(x, 1))]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=body")
    for number, nodes in enumerate(block.nodes + 1, 1):
        texts = [str(number), *map(str, nodes)]
        lines += [",".join(texts[:11]) + ",", ",".join(texts[11:])]
    for name, at in (("root", 0.0), ("tip", sides[0])):
        lines += [f"*NSET, NSET={name}", *(f"{i + 1}," for i in np.flatnonzero(np.abs(x[:, 0] - at) < 1e-9))]
    lines += ["*MATERIAL, NAME=steel", "*ELASTIC", f"{YOUNG}, {POISSON}", "*DENSITY", f"{DENSITY}"]
    lines += ["*SOLID SECTION, ELSET=body, MATERIAL=steel", "*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE"]
    path = folder / "box.inp"
    path.write_text("\n".join([*lines, "*END STEP", ""]))
    done = subprocess.run([program("ccx"), "box"], cwd=folder, capture_output=True, text=True, check=True)
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    return path


def imported(folder: Path, path: Path, options: BodyOptions) -> NodalBody:
    """The body as the command writes it."""
    made = imported_body(read_calculix(path), options, path.name, "")
    (folder / f"{made.name}.npz").write_bytes(made.archive)
    (folder / f"{made.name}.toml").write_text(made.text)
    body = derive.read(folder / f"{made.name}.toml")
    assert isinstance(body, NodalBody)
    return body


def cantilever(folder: Path, motion: str) -> SpatialScene:
    """A beam of bricks that is fixed at its root to the ground, with ten modes of the held body."""
    path = run_box(folder, (LENGTH, WIDTH, HEIGHT), (10, 2, 2))
    imported(folder, path, BodyOptions(("root", "tip")))
    markers = {"root": {"set": "root", "motion": motion}, "tip": {"set": "tip"}}
    beam = {"nodes": str(folder / "box.npz"), "units": "SI", "modes": 10, "interface": ["root"]}
    start = {"position": [LENGTH / 2, 0, 0], "rotation": [1, 0, 0, 0]}
    return derive.spatial_scene(
        "cantilever",
        start="equilibrium",
        gravity=[0, 0, -9.81],
        ground={"root": [0, 0, 0]},
        bodies={"beam": beam | {"markers": markers, "start": start}},
        joints={"clamp": {"kind": "fixed", "between": ["ground.root", "beam.root"]}},
        forces={"end": {"at": "beam.tip", "force": [0, FORCE, 0]}},
        outputs={"tip": {"kind": "position", "marker": "beam.tip"}},
        simulation={"duration": 1e-6, "output": 1e-6},
    )


def timoshenko(height: float, width: float, count: int) -> np.ndarray:
    """Frequencies (Hz) of Timoshenko's cantilever that bends in the direction of its height.

    The roots of the determinant of the transfer matrix of deflection, rotation, moment and shear force, of which the
    first two vanish at the clamp and the others at the tip.
    """
    second = width * height**3 / 12
    shear, bending = SHEAR_FACTOR * SHEAR * AREA, YOUNG * second
    line, turning = DENSITY * AREA, DENSITY * second

    def determinant(omega: float) -> float:
        slope = np.zeros((4, 4))  # of (w, phi, M, Q)
        slope[0, 1], slope[0, 3], slope[1, 2], slope[2, 3] = 1, 1 / shear, 1 / bending, -1
        slope[2, 1], slope[3, 0] = -turning * omega**2, -line * omega**2
        return float(np.linalg.det(expm(LENGTH * slope)[2:, 2:]))

    step = 0.1 * np.sqrt(bending / line) / LENGTH**2
    grid = step * np.arange(1, 1500)
    signs = np.sign([determinant(omega) for omega in grid])
    found = [brentq(determinant, grid[i], grid[i + 1]) for i in np.flatnonzero(np.diff(signs))[:count]]
    return np.array(found, dtype=np.float64) / (2 * np.pi)


def torsion_constant() -> float:
    """Saint-Venant's constant of the section, by its series."""
    odd = np.arange(1, 40, 2)
    rest = np.sum(np.tanh(odd * np.pi * WIDTH / (2 * HEIGHT)) / odd**5) * 192 * HEIGHT / (np.pi**5 * WIDTH)
    return float(WIDTH * HEIGHT**3 / 3 * (1 - rest))


def ritz(sides: tuple[float, float, float], degree: int, through: int, count: int) -> np.ndarray:
    """The first elastic frequencies (Hz) of a free box by monomials x^i y^j z^k, i + j + k <= degree, k <= through.

    The xyz algorithm of W. M. Visscher et al., J. Acoust. Soc. Am. 90 (1991) 2154, an upper bound of each frequency.
    """
    powers = np.array([p for p in product(range(degree + 1), repeat=3) if sum(p) <= degree and p[2] <= through])

    def integrals(more: np.ndarray) -> np.ndarray:
        """Of the products of monomials with the exponents changed, over the box with half sides of one."""
        total = powers[:, None] + powers[None] + more
        result: np.ndarray = np.prod(
            np.where((total >= 0) & (total % 2 == 0), 2 / (np.maximum(total, 0) + 1), 0.0), axis=2
        )
        return result

    n, half, unit = len(powers), np.array(sides) / 2, np.eye(3, dtype=int)
    gradients = np.empty((3, 3, n, n))  # of derivatives along two axes
    for i, j in product(range(3), repeat=2):
        factors = np.outer(powers[:, i], powers[:, j]) / (half[i] * half[j])
        gradients[i, j] = factors * integrals(-unit[i] - unit[j])
    lame = 2 * SHEAR * POISSON / (1 - 2 * POISSON)
    trace = sum(gradients[i, i] for i in range(3))
    stiffness = np.block(
        [[lame * gradients[i, j] + SHEAR * (gradients[j, i] + (i == j) * trace) for j in range(3)] for i in range(3)]
    )
    mass = DENSITY * np.kron(np.eye(3), integrals(np.zeros(3, dtype=int)))
    size = 1 / np.sqrt(np.diag(mass))
    squares = eigh(size[:, None] * stiffness * size, size[:, None] * mass * size, eigvals_only=True)
    result: np.ndarray = np.sqrt(squares[6 : 6 + count]) / (2 * np.pi)
    return result


def spinning(folder: Path) -> SpatialScene:
    imported(folder, run_box(folder, (SIDE, SIDE, SIDE), (3, 3, 3)), BodyOptions())
    start = {"position": [0, 0, 0], "velocity": [3, 0, 0], "angular_velocity": [2000, 500, -1000], "amplitudes": [1e-4]}
    return derive.spatial_scene(
        "spinning",
        bodies={"cube": {"nodes": str(folder / "box.npz"), "units": "SI", "modes": 6, "start": start}},
        outputs={"energy": {"kind": "energy"}},
        simulation={"duration": 1e-3, "output": 2e-5, "tolerance": 1e-10},
    )


def angular_momentum(body: NodalBody, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """About the inertial origin, kg m^2/s: the sum over the nodes with the mass matrix of the file."""
    own = prepare(body)
    e0, e = q[3], q[4:7]
    turn = np.eye(3) + 2 * e0 * cross_matrix(e) + 2 * cross_matrix(e) @ cross_matrix(e)
    place = own.shapes.x + np.tensordot(q[7:], own.shapes.phi, axes=1)
    rate = np.cross(v[3:6], place) + np.tensordot(v[6:], own.shapes.phi, axes=1)
    x, xdot = q[:3] + place @ turn.T, v[:3] + rate @ turn.T
    result: np.ndarray = np.cross(x, own.mass @ xdot).sum(axis=0)
    return result


def cross_matrix(a: np.ndarray) -> np.ndarray:
    return np.cross(np.eye(3), a)


def near(found: np.ndarray, expected: np.ndarray, part: float) -> bool:
    return bool(np.abs(np.asarray(found) / expected - 1).max() < part)


def test_a_clamp_that_is_the_mean_over_a_face_is_that_of_theory(tmp_path: Path) -> None:
    """Bending in both planes, torsion, extension, and deflections under gravity and under a force at the tip.

    Theory lets the section at the clamp warp and contract, and holds it by smooth stresses, as the mean over the area
    of the face does: the first frequencies agree to 6e-5, that of the seventh bending mode to 0.5 %, deflections to
    0.08 %. A rigid set of nodes is stiffer: by 0.2 % in extension and 0.4 % to 1.1 % in the other frequencies, and by
    0.7 % and 1.1 % in deflections.
    """
    line, second = DENSITY * AREA * 9.81, (HEIGHT * WIDTH**3 / 12, WIDTH * HEIGHT**3 / 12)
    shear = SHEAR_FACTOR * SHEAR * AREA
    by_force = FORCE * LENGTH**3 / (3 * YOUNG * second[0]) + FORCE * LENGTH / shear
    by_gravity = line * LENGTH**4 / (8 * YOUNG * second[1]) + line * LENGTH**2 / (2 * shear)
    bending = np.sort([*timoshenko(HEIGHT, WIDTH, 4), *timoshenko(WIDTH, HEIGHT, 3)])
    torsion = np.sqrt(SHEAR * torsion_constant() / (DENSITY * sum(second))) / (4 * LENGTH)
    extension = np.sqrt(YOUNG / DENSITY) / (4 * LENGTH)
    gaps = {}
    for motion in ("mean", "rigid"):
        scene = cantilever(tmp_path, motion)
        own, run = derive.modes(scene).frequencies[:9], derive.simulate(scene)
        # the sixth mode is that of torsion, and the ninth that of extension
        found = [*np.delete(own, [5, 8]) / bending, own[5] / torsion, own[8] / extension]
        gaps[motion] = np.array(found) - 1, np.array([run["tip_2"][0] / by_force, -run["tip_3"][0] / by_gravity]) - 1
    frequencies, deflections = zip(*gaps.values(), strict=True)
    assert np.all(np.abs(frequencies[0][:2]) < 2e-4) and np.all(np.abs(frequencies[0]) < 0.006), gaps
    assert np.all(frequencies[1] > np.abs(frequencies[0])) and np.all(frequencies[1] < 0.013), gaps
    assert np.all(np.abs(deflections[0]) < 0.0015), gaps
    assert np.all(deflections[1] < 0) and np.all(deflections[1] > -0.013), gaps


def test_a_free_plate(tmp_path: Path) -> None:
    """The first five frequencies of a free square plate with a thickness of one hundredth of its side.

    They are those of the solid by Rayleigh and Ritz to 0.2 %. The factors of A. W. Leissa, J. Sound Vib. 31 (1973) 257,
    for omega a^2 sqrt(rho h / D) are upper bounds of a thin plate, 0.2 %, 1.0 % and 0.7 % above the limit of Ritz at no
    thickness; the thickness takes off another 0.25 % of the first, where the plate twists.
    """
    side, thickness = 1.0, 0.01
    free = imported(tmp_path, run_box(tmp_path, (side, side, thickness), (8, 8, 1)), BodyOptions(modes=5))
    found = body_properties(free).frequencies
    assert near(found, ritz((side, side, thickness), 12, 3, 5), 2.5e-3)
    bending = YOUNG * thickness**3 / (12 * (1 - POISSON**2))
    published = np.array([13.489, 19.789, 24.432]) * np.sqrt(bending / (DENSITY * thickness)) / (2 * np.pi * side**2)
    thin = ritz((side, side, thickness / 10), 12, 3, 3) * 10
    assert near(thin, published, 0.011) and near(found[:3], published, 0.012)
    assert np.all(found[:3] < thin) and np.all(thin < published)


def test_a_free_cube(tmp_path: Path) -> None:
    """The 14 first frequencies are those of Rayleigh and Ritz to 0.42 %, and the first pair, of torsion, to 0.06 %.

    Both have the mode of Lame, whose frequency is sqrt(G / 2 rho) / side exactly: Ritz to 1e-6, the mesh to 0.1 %.
    """
    free = imported(tmp_path, run_box(tmp_path, (SIDE, SIDE, SIDE), (4, 4, 4)), BodyOptions(modes=14))
    found, expected = body_properties(free).frequencies, ritz((SIDE, SIDE, SIDE), 8, 8, 14)
    assert near(found[:2], expected[:2], 1e-3) and near(found, expected, 5e-3)
    lame = np.sqrt(SHEAR / (2 * DENSITY)) / SIDE
    assert near(expected[8:11], lame, 3e-6) and near(found[8:11], lame, 1e-3)


def test_a_spinning_cube_keeps_its_energy_and_its_angular_momentum(tmp_path: Path) -> None:
    """Over 14 periods of its torsion and a third of a turn, to 1e-12 and 1e-13 with a tolerance of 1e-10."""
    scene = spinning(tmp_path)
    run = derive.simulate(scene)
    (cube,) = scene.bodies
    assert isinstance(cube, FlexibleBody)
    momenta = np.array([angular_momentum(cube.body, q, v) for q, v in zip(run.q, run.v, strict=True)])
    assert np.linalg.norm(momenta[0]) == pytest.approx(29.785, rel=1e-3)
    assert np.abs(momenta - momenta[0]).max() < 1e-12 * np.linalg.norm(momenta[0])
    assert near(run["energy_total"], run["energy_total"][0], 1e-10)
    assert np.ptp(run["energy_strain"]) > 1e-3 * run["energy_total"][0]
