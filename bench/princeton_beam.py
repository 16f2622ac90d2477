"""A slender beam under an end load that bends it in both planes and twists it: how far second order reaches.

    python bench/princeton_beam.py [--elements 40]

The beam is that of the experiments at Princeton (Dowell and Traybar, 1975): 508 mm of 7075 aluminium, with a section
of 12.3777 mm by 3.2024 mm, E = 71.7 GPa and a Poisson ratio of 0.31, with loads of 4.448, 8.896 and 13.345 N at its
end, at angles between 0 (in the stiff plane) and 90 degrees. The reference is computed: geometrically exact beam
elements of Exudyn with the same stiffnesses and next to no shear. The measured deflections are not used: no source of
them as numbers is at hand. For 8.896 N those of beam and of solid elements of ANSYS are published. Each row has the
deflections of the end (m) in its stiff and in its soft direction and the rotation about the axis (rad), for Exudyn and
for a beam of second order, and the largest errors in %; NaN where the beam of second order has no equilibrium that is
found; the errors (%) of its deflections against the published ones of beams and of solids; and the largest part of the
load up to which it has an equilibrium, if that is less than all of it: from there on the branch of the unloaded beam
goes back to smaller loads, with a stiffness that is no longer positive.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from importlib import import_module
from itertools import pairwise, product
from typing import Any

import numpy as np

import derive
from derive.errors import TisserandError
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.configurations import rotation_matrix
from derive.simulation.space.beam_frames import beam_frames
from derive.simulation.space.initial_state import spatial_scene_state
from derive.spec.model.beam_pieces import in_pieces

LENGTH, HEIGHT, WIDTH = 0.508, 12.3777e-3, 3.2024e-3
E, POISSON, DENSITY = 71.7e9, 0.31, 2810.0
STIFF, SOFT = E * WIDTH * HEIGHT**3 / 12, E * HEIGHT * WIDTH**3 / 12
STEP = 0.03
"""Of the arc length of a branch of equilibria, on which the part of the load counts as much as the deformation."""
LOADS, ANGLES = (4.448, 8.896, 13.345), (0, 15, 30, 45, 60, 75, 90)
PUBLISHED_LOAD = 8.896
PUBLISHED = {
    0: ((0.0107142, 0.0), (0.0106975, 0.0)),
    15: ((0.0106133, 0.0420823), (0.0105718, 0.0410117)),
    30: ((0.0101117, 0.0793948), (0.0099383, 0.0769675)),
    45: ((0.0088372, 0.1089879), (0.0086868, 0.1059763)),
    60: ((0.0066047, 0.1298876), (0.0065000, 0.1272513)),
    75: ((0.0035389, 0.1421944), (0.0034820, 0.1395947)),
    90: ((0.0, 0.1462460), (0.0, 0.1438487)),
}
"""Deflections of the end (m) in the stiff and in the soft direction by angle, of beams and of 4 x 12 x 500 solid
elements of ANSYS: Obrezkov, Matikainen and others, Nonlinear Dynamics 109 (2022), as the tests of Exudyn quote them
(main/pythonDev/TestModels/ANCFBeamTest.py)."""


def torsional_stiffness() -> float:
    """GJ (N m^2) of the rectangle, by its series."""
    ratio = WIDTH / HEIGHT
    odd = np.arange(1, 40, 2)
    J = HEIGHT * WIDTH**3 * (1 / 3 - 64 / np.pi**5 * ratio * np.sum(np.tanh(odd * np.pi / 2 / ratio) / odd**5))
    return float(E / (2 + 2 * POISSON) * J)


def exact(elements: int, force: Any) -> Any:
    """The displacement of the end (m) and its rotation vector (rad), by geometrically exact beams of Exudyn."""
    exu, items = import_module("exudyn"), import_module("exudyn.itemInterface")
    mbs = exu.SystemContainer().AddSystem()
    area = HEIGHT * WIDTH
    section = exu.BeamSection()
    shear = 10 * E * area  # next to none
    section.stiffnessMatrix = np.diag([E * area, shear, shear, torsional_stiffness(), SOFT, STIFF])
    section.massPerLength = DENSITY * area
    section.inertia = DENSITY * np.diag([WIDTH * HEIGHT**3 / 12 + HEIGHT * WIDTH**3 / 12, 1e-12, 1e-12])
    zero = [0.0, 0.0, 0.0]
    nodes = [
        mbs.AddNode(items.NodeRigidBodyRotVecLG(referenceCoordinates=[x, 0, 0, *zero]))
        for x in np.linspace(0, LENGTH, elements + 1)
    ]
    for pair in pairwise(nodes):
        mbs.AddObject(
            items.ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=LENGTH / elements, sectionData=section)
        )
    ground = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=mbs.AddObject(items.ObjectGround()), localPosition=zero))
    mbs.AddObject(items.GenericJoint(markerNumbers=[ground, mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))]))
    end = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[-1]))
    mbs.AddLoad(items.LoadForceVector(markerNumber=end, loadVector=list(force)))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = 10
    settings.staticSolver.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.staticSolver.newton.relativeTolerance = 1e-7
    settings.staticSolver.newton.numericalDifferentiation.relativeEpsilon = 1e-7
    mbs.SolveStatic(settings)
    kind = exu.OutputVariableType
    u = mbs.GetNodeOutput(nodes[-1], kind.Displacement)
    R = np.array(mbs.GetNodeOutput(nodes[-1], kind.RotationMatrix)).reshape(3, 3)
    return np.r_[u, rotation_vector(R)]


def rotation_vector(R: Any) -> Any:
    """The rotation vector (rad) of a rotation matrix."""
    axial = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sine, cosine = float(np.linalg.norm(axial)), (np.trace(R) - 1) / 2
    return axial * (np.arctan2(sine, cosine) / sine if sine > 1e-15 else 1.0)


class SecondOrder:
    """The beam of second order in some pieces, for all loads: one model with the load as a parameter."""

    def __init__(self, shapes: int, pieces: int = 1) -> None:
        powers = range(shapes + 2)
        mass = DENSITY * HEIGHT * WIDTH * LENGTH
        beam = {
            "length": LENGTH,
            "mass": mass,
            "bending_stiffness": STIFF,
            "lateral": {"bending_stiffness": SOFT},
            "torsion": {"ansatz": ["xi", "xi^2", "xi^3"][:shapes], "stiffness": torsional_stiffness()},
            "rotary_inertia": mass * (HEIGHT**2 + WIDTH**2) / 12,
            "ansatz": [f"xi^{power}" for power in powers],
            "frame": {"kind": "tangent", "at": -1} if pieces == 1 else "mean",
            "order": 2,
            "pieces": pieces,
            "markers": {"left": -1, "right": 1},
        }
        whole = derive.spatial_scene(
            "princeton",
            ground={"wall": (0, 0, 0)},
            bodies={"beam": beam},
            joints={"clamp": {"kind": "fixed", "between": ["ground.wall", "beam.left"]}},
            parameters={"F2": {"default": 0, "unit": "N"}, "F3": {"default": 0, "unit": "N"}},
            forces={"load": {"at": "beam.right", "force": [0, "F2", "F3"]}},
            start="equilibrium",
        )
        self.scene, self.pieces = in_pieces(whole), pieces
        self.frame = beam_frames(self.scene.bodies[-1])["right"]
        self.native = InterpretedScene(derive.lower(derive.derive(self.scene)))

    def end(self, force: Any) -> Any:
        """The displacement of the end (m), and its rotation vector (rad) of one piece; NaN where there is none."""
        k = self.native.setup([float(x) for x in force[1:]])
        try:
            q = spatial_scene_state(self.scene, self.native, k).q
        except TisserandError:
            return np.full(6, np.nan)
        frame, last = self.frame, q[-len(q) // self.pieces :]
        alpha = last[7:]
        bent = alpha @ frame.point.shapes + np.einsum("i,j,ijk->k", alpha, alpha, frame.point.second) / 2
        turned = alpha @ frame.twists + np.einsum("i,j,ijk->k", alpha, alpha, frame.second_twists) / 2
        at = last[:3] + rotation_matrix(last[3:7]) @ (np.array([LENGTH / self.pieces / 2, 0, 0]) + bent)
        return np.r_[at - np.array([LENGTH, 0, 0]), turned if self.pieces == 1 else np.full(3, np.nan)]

    def branch(self, force: Any) -> Iterator[tuple[float, float]]:
        """Parts of a force with an equilibrium, and the least stiffness there, relative to that of the straight beam.

        They follow the branch of the unloaded beam by its arc length, to the whole force or past the largest part.
        """
        native, count = self.native, len(self.native.velocities) - 6
        unit = np.eye(count)

        def forces(a: Any, part: float) -> Any:
            q, k = np.r_[LENGTH / 2, 0, 0, 1, 0, 0, 0, a], native.setup([float(part * x) for x in force[1:]])
            return np.asarray(native.force(0.0, q, np.zeros(len(native.velocities)), k))[6:]

        def stiffness(a: Any, part: float) -> Any:
            return np.array([(forces(a + x, part) - forces(a - x, part)) / 2e-6 for x in 1e-6 * unit]).T

        straight, load = stiffness(0 * unit[0], 0.0), forces(0 * unit[0], 1.0)
        size = np.abs(np.linalg.solve(straight, load)).max()
        scale = np.sqrt(np.diag(straight))
        x, ahead, largest = np.zeros(count + 1), np.r_[np.zeros(count), 1.0], 0.0
        while x[-1] < 1 and x[-1] > largest - 0.02:
            gradient = np.column_stack([stiffness(size * x[:-1], x[-1]) * size, load])
            along = np.linalg.svd(gradient)[2][-1]
            ahead = along * np.sign(along @ ahead)
            begin, x = x, x + STEP * ahead
            for _ in range(10):
                off = np.r_[forces(size * x[:-1], x[-1]), load @ load * (ahead @ (x - begin) - STEP)]
                gradient = np.column_stack([stiffness(size * x[:-1], x[-1]) * size, load])
                x = x - np.linalg.solve(np.vstack([gradient, load @ load * ahead]), off)
            largest = max(largest, x[-1])
            at = stiffness(size * x[:-1], x[-1])
            yield float(x[-1]), float(np.linalg.eigvalsh((at + at.T) / 2 / np.outer(scale, scale))[0])


def relative(own: Any, known: Any) -> tuple[float, float]:
    """The largest error of a displacement over the largest displacement, and that of the rotation vector, in %."""
    parts = ((own[:3], known[:3]), (own[3:], known[3:]))
    first, second = (100 * float(np.abs(a - b).max() / np.abs(b).max()) for a, b in parts)
    return first, second


def off_published(load: float, angle: int, own: Any) -> tuple[float, float]:
    """The largest error (%) of the deflections of the end against those published of beams and of solids."""
    if load != PUBLISHED_LOAD:
        return np.nan, np.nan
    beams, solids = (100 * np.abs(own[1:3] - known).max() / np.hypot(*known) for known in PUBLISHED[angle])
    return float(beams), float(solids)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--elements", type=int, default=40)
    parser.add_argument("--shapes", type=int, default=3)
    arguments = parser.parse_args()
    beam = SecondOrder(arguments.shapes)
    heads = (
        "load N",
        "angle",
        *(f"{of} {k}" for of, k in product(("exact", "ours"), ("u2", "u3", "twist"))),
        "u %",
        "rot %",
        "beam %",
        "solid %",
        "limit",
    )
    print(("{:>9s}" * len(heads)).format(*heads))
    for load, angle in product(LOADS, ANGLES):
        phi = np.deg2rad(angle)
        force = np.array([0, load * np.cos(phi), load * np.sin(phi)])
        known, own = exact(arguments.elements, force), beam.end(force)
        row = (load, angle, *known[1:4], *own[1:4], *relative(own, known), *off_published(load, angle, own))
        limit = max(part for part, _ in beam.branch(force)) if np.isnan(own).any() else np.nan
        print(("{:9.3f}{:9.0f}" + 6 * "{:9.5f}" + 4 * "{:9.2f}" + "{:9.3f}").format(*row, limit))
