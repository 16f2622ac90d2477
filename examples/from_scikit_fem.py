"""A part that scikit-fem meshes and assembles, as a flexible body of a mechanism.

An L-shaped bracket of steel is meshed with quadratic tetrahedra. Its matrices, its elements and the sets of nodes at
both ends are arrays, which a body takes as they are. Twelve Craig-Bampton modes represent it in a scene in which its
upper end is welded to the ground. The number is the largest relative difference of its first three frequencies there
from those that SciPy computes from all displacements of the mesh, with the nodes at this end held.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from skfem import Basis, ElementTetP2, ElementVector, MeshTet
from skfem.models.elasticity import lame_parameters, linear_elasticity
from skfem.models.poisson import mass

import derive

LEG, WIDTH, THICKNESS = 0.2, 0.04, 0.02  # m
YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0  # Pa, 1, kg/m^3


def bracket() -> dict[str, np.ndarray]:
    """Return the arrays of the part: those that a file of nodes has, under the same names."""
    along, across = np.concatenate([[0], np.linspace(THICKNESS, LEG, 5)]), np.linspace(0, WIDTH, 2)
    whole = MeshTet.init_tensor(along, across, along)
    outside = whole.p[:, whole.t].mean(axis=1).min(axis=0, initial=1, where=[[True], [False], [True]]) > THICKNESS
    mesh = whole.remove_elements(np.flatnonzero(outside)).oriented()
    scalar, vector = (Basis(mesh, e, intorder=4) for e in (ElementTetP2(), ElementVector(ElementTetP2())))
    x = scalar.doflocs.T
    return {
        "positions": x,
        "mass": DENSITY * mass.assemble(scalar),  # the displacements of a node are together in the stiffness
        "stiffness": linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(vector),
        "elements_tet10": scalar.element_dofs.T,  # the order of nodes is that of VTK
        "elements_tet10_material": np.zeros(mesh.nelements, dtype=int),
        "materials": np.array([[YOUNG, POISSON, DENSITY]]),
        "set_top": np.flatnonzero(np.isclose(x[:, 2], LEG)),
        "set_end": np.flatnonzero(np.isclose(x[:, 0], LEG)),
    }


def scene(part: dict[str, np.ndarray]) -> derive.SpatialScene:
    """Return the scene in which the bracket is welded to the ground at its top, as a rigid set of nodes."""
    body = {
        "nodes": part,
        "units": "SI",
        "interface": ["top", "end"],
        "modes": 12,
        "markers": {"top": {"set": "top", "motion": "rigid"}, "end": {"set": "end"}},
    }
    return derive.spatial_scene(
        "bracket",
        gravity=(0, 0, "-9.81"),
        bodies={"bracket": body},
        ground={"wall": part["positions"][part["set_top"]].mean(axis=0).tolist()},
        joints={"weld": {"kind": "fixed", "between": ["ground.wall", "bracket.top"]}},
        outputs={"sag": {"kind": "position", "marker": "bracket.end"}},
        simulation={"duration": 0.05, "output": 2e-4},
    )


def held_frequencies(part: dict[str, np.ndarray], count: int) -> np.ndarray:
    """Return the lowest frequencies, Hz, with the nodes at the top held."""
    held = (3 * part["set_top"][:, None] + np.arange(3)).ravel()
    free = np.setdiff1d(np.arange(part["positions"].size), held)
    k = scipy.sparse.csc_array(part["stiffness"])[free][:, free]
    m = scipy.sparse.kron(part["mass"], scipy.sparse.eye_array(3)).tocsc()[free][:, free]
    squares = scipy.sparse.linalg.eigsh(k, count, m, sigma=0, v0=np.ones(len(free)), return_eigenvectors=False)
    return np.sqrt(np.sort(squares)) / (2 * np.pi)


def main(folder: str | None = None) -> float:
    """Return the largest relative difference of the first three frequencies."""
    part = bracket()
    held = scene(part)
    own, full = derive.modes(held).frequencies[:3], held_frequencies(part, 3)
    print("frequencies, Hz:", ", ".join(f"{f:.2f}" for f in own), "of", ", ".join(f"{f:.2f}" for f in full))
    if folder is not None:
        run = derive.simulate(held)
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(run.t, 1e6 * (run["sag_3"] - run["sag_3"][0]))
        axes.set(xlabel="t, s", ylabel="displacement of the free end, µm")
        figure.savefig(Path(folder) / "from_scikit_fem.svg")
        plt.close(figure)
    return float(np.abs(own / full - 1).max())


if __name__ == "__main__":
    main(*sys.argv[1:])
