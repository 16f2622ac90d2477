"""Checks of the data of a finite-element body. Each check collects all faults before it raises an error."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array, identity
from scipy.sparse.linalg import splu

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array, eigh, pairwise_sum, symmetric_part
from derive.reduction.eigen import max_elastic_modes, modal_stiffness
from derive.reduction.frames import (
    ModeShapes,
    determine_rotation,
    from_centre_of_mass,
    nearest_nodes,
    projected_out,
    rigid_basis,
    rigid_fields,
)
from derive.reduction.integrals import canonical_csr, mass_products
from derive.reduction.second_order import stiffening_faults
from derive.spec.model.body import NodalBody
from derive.spec.model.mode_selection import ModeSelection

DEPENDENCE_TOLERANCE = 1e-5
"""Modes are dependent if, without rigid motions, they have a singular value below this fraction of the largest."""

SUPPORT_TOLERANCE = 1e-2
"""A body has supports if a rigid motion has a frequency above this fraction of the lowest elastic frequency."""

SYMMETRY_TOLERANCE = 1e-9
"""The largest asymmetry of a symmetric matrix, relative to its largest entry."""

STIFFNESS_TOLERANCE = 1e-6
"""The largest difference between a modal stiffness and Phi^T K Phi, relative to the largest entry."""


def check_body(body: NodalBody) -> None:
    """Check everything but the modes: nodes, mass, stiffness, frame, markers. Raises SpecError with all faults."""
    problems = _array_faults(body)
    if not problems:
        problems = [*_mass_faults(body), *_stiffness_faults(body), *_frame_faults(body), *_marker_faults(body)]
    if not problems and body.second_order and not body.computes_geometric_stiffness:
        problems = stiffening_faults(body)
    if not problems:
        problems = _mode_count_faults(body)
    if problems:
        raise SpecError(tuple(problems))


def check_modes(body: NodalBody, mass: csr_array, raw: ModeShapes) -> None:
    """Check the modes and their stiffness. Raises SpecError with all faults.

    mass: the canonical mass matrix. raw: the modes and their stiffness, before the transformation to the body frame.
    Faults are modes that contain a rigid motion or depend on each other, and a stiffness that is not positive
    semidefinite, resists rigid motions, or disagrees with the stiffness matrix.
    """
    x = from_centre_of_mass(mass, raw.x)
    problems = rigid_problems(mass, x, raw.phi)
    if not problems:
        problems = [
            *_negative_stiffness(body, mass, raw),
            *_supports(body, mass, x, raw),
            *_inconsistent_stiffness(body, raw),
        ]
    if problems:
        raise SpecError(tuple(problems))


def _array_faults(body: NodalBody) -> list[Problem]:
    """Faults of arrays: shapes that do not match, and values that are not finite."""
    data, result = body.data, []
    n = len(data.positions)

    def problem(path: str, message: str) -> None:
        result.append(Problem(path, message))

    if data.positions.shape != (n, 3) or not n:
        problem("body.nodes", f"positions are (nodes, 3), not {data.positions.shape}")
    if data.mass.shape != (n, n):
        problem("body.nodes", f"the mass of {n} nodes is ({n}, {n}), not {data.mass.shape}")
    if data.stiffness is not None and data.stiffness.shape != (3 * n, 3 * n):
        problem("body.nodes", f"the stiffness of {n} nodes is ({3 * n}, {3 * n}), not {data.stiffness.shape}")
    if data.modes is not None and data.modes.shape[1:] != (n, 3):
        problem("body.nodes", f"modes of {n} nodes are (N, {n}, 3), not {data.modes.shape}")
    count = 0 if data.modes is None else len(data.modes)
    if data.modal_stiffness is not None and data.modal_stiffness.shape != (count, count):
        problem(
            "body.nodes", f"modal_stiffness of {count} modes is ({count}, {count}), not {data.modal_stiffness.shape}"
        )
    arrays = {
        "positions": data.positions,
        "mass": data.mass.data,
        "stiffness": None if data.stiffness is None else data.stiffness.data,
        "modes": data.modes,
        "modal_stiffness": data.modal_stiffness,
    }
    for name, values in arrays.items():
        if values is not None and not np.all(np.isfinite(values)):
            problem("body.nodes", f"{name} contains values that are not finite")
    return result


def _mass_faults(body: NodalBody) -> list[Problem]:
    """Faults of the mass matrix: asymmetric, not positive semidefinite, or without a moment of inertia."""
    mass = canonical_csr(body.data.mass)
    if _asymmetry(mass) > SYMMETRY_TOLERANCE:
        return [Problem("body.nodes", "the mass matrix is not symmetric; give both of its halves")]
    sum_ = float(pairwise_sum(mass.data))
    if not sum_ > 0:
        return [Problem("body.nodes", f"the mass of all nodes is {sum_:.6g} kg; it has to be positive")]
    if body.data.moments is None and (message := indefinite(mass)) is not None:
        return [Problem("body.nodes", message)]
    x = from_centre_of_mass(mass, body.data.positions)
    inertia, _ = eigh(mass_products(mass, rigid_fields(x)[3:], rigid_fields(x)[3:]))
    size = sum_ * float(np.abs(x).max(initial=0.0)) ** 2
    where = "all mass is in one point" if inertia[-1] <= 1e-12 * size or not size else "all mass is on one line"
    if not size or inertia[0] <= 1e-12 * inertia[-1]:
        message = "there is no moment of inertia about it, so that its rotation has no equation"
        return [Problem("body.nodes", f"{where}: {message}; give nodes beside it some mass")]
    return []


def indefinite(mass: csr_array, name_of: Callable[[int], object] = str) -> str | None:
    """The reason why a mass matrix is not positive semidefinite, or None; nodes without mass are allowed.

    name_of: what a node is called.
    """
    diagonal = mass.diagonal()
    if diagonal.min() < 0:
        node = int(np.argmin(diagonal))
        hint = "if masses are row sums of a consistent mass matrix, give that matrix itself"
        return f"the mass of node {name_of(node)} is negative ({diagonal[node]:.3g} kg); {hint}"
    rows = np.flatnonzero(diagonal > 0)
    if np.count_nonzero(np.abs(mass).sum(axis=1)) > rows.size:
        return "a node without mass is coupled to others in the mass matrix, which then is negative for some motion"
    if mass.nnz == rows.size:
        return None
    scale = 1 / np.sqrt(diagonal[rows])
    scaled = mass[rows][:, rows].multiply(scale[:, None]).multiply(scale[None, :])
    shifted = (scaled + 1e-10 * identity(rows.size)).tocsc()
    try:
        factors = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        return "the mass matrix is singular and not positive anywhere around; check its entries"
    pivots = factors.U.diagonal()
    if np.array_equal(factors.perm_r, factors.perm_c) and pivots.min() > 0:
        return None
    worst = int(np.argmin(pivots))
    node = int(rows[np.flatnonzero(factors.perm_c == worst)[0]])
    return (
        f"the mass matrix is indefinite: with its diagonal scaled to 1, a pivot is {pivots[worst]:.3g} (node "
        f"{name_of(node)}), so that some motion has a negative kinetic energy; check its entries"
    )


def _stiffness_faults(body: NodalBody) -> list[Problem]:
    """Faults of the stiffness: asymmetric, or missing."""
    data, result = body.data, []
    if data.stiffness is not None and _asymmetry(canonical_csr(data.stiffness)) > SYMMETRY_TOLERANCE:
        result.append(Problem("body.nodes", "the stiffness matrix is not symmetric; give both of its halves"))
    k = data.modal_stiffness
    if k is not None and np.abs(k - k.T).max(initial=0.0) > SYMMETRY_TOLERANCE * np.abs(k).max(initial=0.0):
        result.append(Problem("body.nodes", "modal_stiffness is not symmetric"))
    if data.modes is not None and k is None and data.stiffness is None and len(data.modes):
        result.append(Problem("body.nodes", "modes need modal_stiffness, or the stiffness matrix of the nodes"))
    if data.modes is None and data.stiffness is None and body.modes != 0:
        result.append(Problem("body.nodes", "give modes with modal_stiffness, or a stiffness to compute them from"))
    return result


def _frame_faults(body: NodalBody) -> list[Problem]:
    """Faults of a frame at a node: unknown nodes, or nodes that do not determine its rotation."""
    frame, x = body.frame, body.data.positions
    if frame.kind != "point":
        return []
    if frame.node is None or not 0 <= frame.node < len(x):
        return [Problem("body.frame", f"there is no node {frame.node}; nodes are 0 .. {len(x) - 1}")]
    outside = [i for i in frame.around if not 0 <= i < len(x)]
    if outside:
        return [Problem("body.frame", f"there is no node {outside[0]}; nodes are 0 .. {len(x) - 1}")]
    around = frame.around or nearest_nodes(x, frame.node)
    if not determine_rotation(x, frame.node, around):
        which = f"nodes {', '.join(map(str, around))}" if frame.around else "all nodes"
        message = f"{which} are on one line with node {frame.node}: they do not determine a rotation about it"
        return [Problem("body.frame", f"{message}; name a node beside that line in `around`")]
    return []


def _marker_faults(body: NodalBody) -> list[Problem]:
    """Faults of markers: unknown nodes."""
    n = len(body.data.positions)
    return [
        Problem(f"body.markers.{m.name}", f"there is no node {m.node}; nodes are 0 .. {n - 1}")
        for m in body.markers
        if not 0 <= m.node < n
    ]


def _mode_count_faults(body: NodalBody) -> list[Problem]:
    """Faults of the requested number of modes; where modes are selected, their number is not known yet."""
    data = body.data
    if isinstance(body.modes, ModeSelection):
        return []
    if body.modes is not None and body.modes < 0:
        return [Problem("body.modes", "a number of modes is 0 or more")]
    if data.modes is None and body.modes is None:
        return [Problem("body.modes", "give the number of modes to compute, for example modes = 6")]
    if data.modes is not None and body.modes is not None and body.modes > len(data.modes):
        return [Problem("body.modes", f"{body.modes} modes are requested, but {len(data.modes)} are given")]
    requested = len(data.modes) if data.modes is not None and body.modes is None else body.modes or 0
    most = max_elastic_modes(canonical_csr(data.mass), 6, body.rigid_sets if data.modes is None else ())
    if requested > most:
        message = f"{requested} modes are too many: nodes with mass allow {most} elastic modes and 6 rigid motions"
        return [Problem("body.modes", message)]
    return []


def rigid_problems(mass: csr_array, x: Array, phi: Array) -> list[Problem]:
    """Faults of modes phi (N, nodes, 3) that move no mass, contain a rigid motion, or are dependent."""
    before = np.diag(mass_products(mass, phi, phi))
    if np.any(before <= 0):
        still = ", ".join(str(i) for i in np.flatnonzero(before <= 0) + 1)
        return [Problem("body.modes", f"modes that move no mass: {still}; remove them")]
    scale = 1 / np.sqrt(before)
    scaled = phi * scale[:, None, None]
    elastic = projected_out(mass, rigid_basis(mass, x), scaled)
    remaining, vectors = eigh(symmetric_part(mass_products(mass, elastic, elastic)))
    result = []
    for value, vector in zip(remaining, vectors, strict=True):
        if value > DEPENDENCE_TOLERANCE**2 * max(float(remaining[-1]), 1.0):
            break
        weights = vector * scale
        weights = weights / np.abs(weights).max()
        named = " ".join(f"{w:+.3g} mode {i}" for i, w in enumerate(weights, 1) if abs(w) > 1e-6)
        motion = (vector[:, None, None] * scaled).sum(axis=0)[None]
        size = float(mass_products(mass, motion, motion)[0, 0])
        what = "rigid motion is left in the modes" if size > 1e-12 else "the modes are dependent"
        singular = f"(singular value {math.sqrt(max(float(value), 0.0)):.1e})"
        result.append(Problem("body.modes", f"{what} {singular}: {named}; remove one of them"))
    return result


def _negative_stiffness(body: NodalBody, mass: csr_array, raw: ModeShapes) -> list[Problem]:
    """A fault if the modal stiffness has a negative eigenvalue."""
    sizes = np.sqrt(np.maximum(np.diag(mass_products(mass, raw.phi, raw.phi)), np.finfo(float).tiny))
    values, vectors = eigh(raw.stiffness / np.multiply.outer(sizes, sizes))
    if not len(values) or values[0] >= -max(1e-9 * float(values[-1]), _noise(body, mass)):
        return []
    mode = int(np.argmax(np.abs(vectors[0]))) + 1
    message = f"the stiffness has a negative eigenvalue in the modes ({values[0]:.3g} 1/s^2, mostly mode {mode})"
    return [Problem("body.nodes", f"{message}; check its sign")]


def _supports(body: NodalBody, mass: csr_array, x: Array, raw: ModeShapes) -> list[Problem]:
    """A fault if the stiffness matrix resists a rigid motion, as that of a supported body does."""
    if body.data.stiffness is None or not len(raw.phi):
        return []
    rigid = rigid_basis(mass, x)
    lowest = float((np.diag(raw.stiffness) / np.diag(mass_products(mass, raw.phi, raw.phi))).min())
    values, vectors = eigh(modal_stiffness(body.data.stiffness, rigid))
    if values[-1] <= max(SUPPORT_TOLERANCE**2 * lowest, _noise(body, mass)):
        return []
    names = ("translation e1", "translation e2", "translation e3", "rotation 1", "rotation 2", "rotation 3")
    motion = names[int(np.argmax(np.abs(vectors[-1])))]
    message = f"the stiffness resists rigid motion ({motion}, {math.sqrt(values[-1]):.3g} rad/s)"
    why = "the body is tied to the ground, or equations tie nodes at different places"
    return [Problem("body.nodes", f"{message}: {why}; export it without these")]


def _noise(body: NodalBody, mass: csr_array) -> float:
    """The largest omega^2 (1/s^2) of a rigid motion that rounding errors of the stiffness matrix explain."""
    if body.data.stiffness is None:
        return 0.0
    return 1e-12 * float(np.abs(body.data.stiffness.diagonal()).sum() / mass.diagonal().sum())


def _inconsistent_stiffness(body: NodalBody, raw: ModeShapes) -> list[Problem]:
    """A fault if the modal stiffness disagrees with the stiffness matrix."""
    data = body.data
    if data.modes is None or data.modal_stiffness is None or data.stiffness is None or not len(raw.phi):
        return []
    expected = modal_stiffness(data.stiffness, raw.phi)
    difference = float(np.abs(expected - raw.stiffness).max()) / float(np.abs(expected).max() or 1.0)
    if difference <= STIFFNESS_TOLERANCE:
        return []
    message = f"modal_stiffness is not Phi^T K Phi of the modes and the stiffness (they differ by {difference:.1e})"
    return [Problem("body.nodes", f"{message}; check units and the order of the modes")]


def _asymmetry(matrix: csr_array) -> float:
    """The largest entry of A - A^T, relative to the largest entry of A."""
    largest = float(np.abs(matrix.data).max(initial=0.0))
    return float(np.abs((matrix - matrix.T).data).max(initial=0.0)) / (largest or 1.0)
