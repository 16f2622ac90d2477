"""Stresses at nodes, and the geometric stiffness of preloads, are those of CalculiX for the same meshes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import program
from scipy.linalg import eigh
from scipy.sparse import csr_array, identity, kron
from scipy.sparse.linalg import eigsh

import derive
from clamped_response import clamped_response
from conftest import ROOT
from derive.reduction.mesh_stiffening import geometric_stiffness_tables
from derive.simulation.observables.fields import field_bodies, field_instants
from derive.solids.face_areas import area_products
from derive.solids.stresses import IntegratedMesh, nodal_stresses, von_mises
from derive.spec.model.mesh import ElementKind

sys.path.append(str(ROOT / "tests/solids"))
from assembled import assembled, consistent_mass
from cantilever_run import FORCE, cantilever, scene_file
from grid_meshes import STEEL, box_mesh
from nonlinear_elements import Held, nodes_held

pytestmark = pytest.mark.hosts

SIDES, PULL, SPIN = (1.0, 0.04, 0.02), 2e5, 300.0
NAMES = {"tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8", "wedge6": "C3D6", "wedge15": "C3D15"}
CASES = [("C3D20R", ElementKind.HEX20, False), ("C3D20", ElementKind.HEX20, True)]
CASES += [(name, ElementKind(kind), False) for kind, name in NAMES.items()]


def job(solid: IntegratedMesh, element: str, loads: list[str], steps: str = "") -> str:
    """The input of a job of a cantilever that is held at x = 0 and loaded in a static step."""
    (block,) = solid.mesh.elements
    held = np.flatnonzero(solid.x[:, 0] < 1e-9)
    lines = ["*NODE, NSET=ALL", *(f"{i}, {a:.12g}, {b:.12g}, {c:.12g}" for i, (a, b, c) in enumerate(solid.x, 1))]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=BODY")
    for number, nodes in enumerate(block.nodes + 1, 1):
        texts = [str(number), *map(str, nodes)]
        lines += [
            ",".join(texts[:11]) + ("," if len(texts) > 11 else ""),
            *([",".join(texts[11:])] * (len(texts) > 11)),
        ]
    lines += ["*NSET, NSET=HELD", *(f"{node + 1}," for node in held)]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{STEEL.young}, {STEEL.poisson}", "*DENSITY", f"{STEEL.density}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "*BOUNDARY", "HELD, 1, 3", "*STEP", "*STATIC", *loads]
    return "\n".join([*lines, "*NODE FILE", "U", "*EL FILE", "S", "*END STEP", steps, ""])


def run(folder: Path, text: str) -> None:
    (folder / "job.inp").write_text(text)
    subprocess.run([program("ccx"), "job"], cwd=folder, check=True, capture_output=True)


def nodal_values(folder: Path, name: str, count: int) -> np.ndarray:
    """The values of a block of the .frd file by nodes, six digits each."""
    values, inside = [], False
    for line in (folder / "job.frd").read_text().splitlines():
        if line.startswith(" -4"):
            inside = line.split()[1] == name
        elif line.startswith(" -3"):
            inside = False
        elif line.startswith(" -1") and inside:
            values.append([float(line[13 + 12 * i : 25 + 12 * i]) for i in range(count)])
    return np.array(values)


@pytest.mark.parametrize(("element", "kind", "full"), [case for case in CASES if case[0] != "C3D6"])
def test_stresses_at_nodes_are_those_of_calculix(tmp_path: Path, element: str, kind: ElementKind, full: bool) -> None:
    """To the six digits of its displacements.

    C3D6 is left out: CalculiX 2.20 extrapolates its stresses along the wedge by 1.29 in place of 1.73, and to the other
    triangle at some nodes; at the points of integration they agree.
    """
    x, mesh = box_mesh(kind, (1.0, 0.2, 0.1), (5, 2, 2), crooked=0.15)
    solid, tip = IntegratedMesh(mesh, x, full), np.flatnonzero(x[:, 0] > 1 - 1e-9) + 1
    forces = [f"{node}, {axis}, {force / len(tip)}" for node in tip for axis, force in ((2, 700.0), (3, -1000.0))]
    run(tmp_path, job(solid, element, ["*CLOAD", *forces]))
    u, expected = nodal_values(tmp_path, "DISP", 3), nodal_values(tmp_path, "STRESS", 6)
    assert np.abs(nodal_stresses(solid, u[None])[0] - expected).max() < 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize(("element", "kind", "full"), [case for case in CASES if case[0] not in ("C3D4", "C3D6")])
def test_preloads_stiffen_as_in_calculix(tmp_path: Path, element: str, kind: ElementKind, full: bool) -> None:
    """A static step, and the frequencies of its perturbation: a pull at the tip, and a spin about the third axis.

    25 clamped modes, of which the first five change by up to a factor of ten; omega^2 within 0.2 %. Reduced integration
    of the mass of C3D20R accounts for 0.12 % of the fifth.
    """
    x, mesh = box_mesh(kind, SIDES, (8, 2, 2) if kind is ElementKind.HEX20 else (8, 1, 1))
    x = x - np.array([0, SIDES[1] / 2, SIDES[2] / 2])
    solid = IntegratedMesh(mesh, x, full)
    held, tip = np.flatnonzero(x[:, 0] < 1e-9), np.flatnonzero(x[:, 0] > SIDES[0] - 1e-9)
    m, k = assembled(solid)
    fixed = (3 * held[:, None] + np.arange(3)).ravel()
    moving, mass = np.setdiff1d(np.arange(x.size), fixed), csr_array(kron(m, identity(3)))
    own = k[moving][:, moving].tocsc(), mass[moving][:, moving].tocsc()
    squares, vectors = eigsh(own[0], 25, own[1], sigma=0, v0=np.ones(len(moving)))
    phi = np.zeros((25, x.size))
    phi[:, moving] = vectors.T
    shapes = phi.reshape(25, -1, 3)
    tables = geometric_stiffness_tables(solid, m, shapes, tip.tolist(), clamped_response(k, fixed))
    across = shapes * np.array([1, 0, 1])
    softening = across.reshape(25, -1) @ (mass @ across.reshape(25, -1).T)
    pulled = tables["K0F"].sum(axis=0)[0] * PULL / len(tip)
    spun = SPIN**2 * (tables["K0omega"][1] - softening)
    loads = {
        "pull": (["*CLOAD", *(f"{node + 1}, 1, {PULL / len(tip)}" for node in tip)], pulled),
        "spin": (["*DLOAD", f"BODY, CENTRIF, {SPIN**2}, 0., 0., 0., 0., 1., 0."], spun),
    }
    steps = "*STEP, PERTURBATION\n*FREQUENCY\n5\n*END STEP"
    for name, (lines, stiffening) in loads.items():
        run(tmp_path, job(solid, element, lines, steps))
        table = (tmp_path / "job.dat").read_text().split("E I G E N V A L U E   O U T P U T")[1]
        rows = [row for row in (line.split() for line in table.splitlines()) if len(row) == 5 and row[0].isdigit()]
        expected = np.array([float(row[1]) for row in rows[:5]])
        found = eigh(np.diag(squares) + stiffening, eigvals_only=True)[:5]
        assert np.abs(found / expected - 1).max() < 2e-3, (name, found / expected - 1)


def test_large_displacements_of_the_tests_are_those_of_calculix(tmp_path: Path) -> None:
    """A bar that bends by a tenth of its length, by the equilibrium with which tests of second order are compared."""
    x, mesh = box_mesh(ElementKind.HEX20, (1.0, 0.04, 0.02), (6, 1, 1))
    solid, tip = IntegratedMesh(mesh, x, full=True), np.flatnonzero(x[:, 0] > 1 - 1e-9)
    forces = np.zeros_like(x)
    forces[tip] = np.array([1500.0, -2000.0, 3000.0]) / len(tip)
    lines = [f"{node + 1}, {axis + 1}, {force}" for (node, axis), force in np.ndenumerate(forces) if force]
    run(tmp_path, job(solid, "C3D20", ["*CLOAD", *lines]).replace("*STEP", "*STEP, NLGEOM"))
    held = nodes_held(x, np.flatnonzero(x[:, 0] < 1e-9).tolist(), "rigid")
    u, expected = Held(solid, held, consistent_mass(solid)).displacements(forces), nodal_values(tmp_path, "DISP", 3)
    assert np.abs(expected).max() > 0.1
    assert np.abs(u - expected).max() < 1e-5 * np.abs(expected).max()


def test_the_stress_of_a_run_is_that_of_calculix(tmp_path: Path) -> None:
    """A cantilever in static equilibrium: static modes of its ends contain the response to the force.

    The root moves as a rigid body in the scene and does not move at all in CalculiX. Stresses agree to 2e-4 of the
    largest.
    """
    beam = cantilever(0.3)
    path = scene_file(beam, tmp_path)
    trajectory = derive.simulate(derive.read(path))
    (body,) = field_bodies(trajectory.spec, ["beam"])
    (fields,) = field_instants(body, trajectory, np.array([0]))
    area = area_products(beam.solid.mesh.elements, beam.solid.x, tuple(beam.tip))
    assert area is not None
    shares = area.sum(axis=0) / area.sum()  # the force is spread evenly over the face
    forces = [f"{node + 1}, 3, {FORCE * share}" for node, share in zip(beam.tip, shares, strict=True)]
    run(
        tmp_path, job(beam.solid, "C3D20R", ["*CLOAD", *forces]).replace(f"{STEEL.young}, {STEEL.poisson}", "70e9, 0.3")
    )
    expected = nodal_values(tmp_path, "STRESS", 6)
    assert fields.stresses is not None
    assert np.abs(fields.stresses - expected).max() < 1e-3 * np.abs(expected).max()
    assert trajectory["beam_stress"][0] == pytest.approx(von_mises(expected).max(), rel=1e-3)
