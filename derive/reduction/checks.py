"""Checks of a finite-element body, which collect all faults that can be reported together."""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csr_array, identity
from scipy.sparse.linalg import splu

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array, eigh, symmetric, total
from derive.reduction.eigen import modal_stiffness, most_modes
from derive.reduction.frames import Shapes, centred, holds, neighbours
from derive.reduction.mass import canonical, products
from derive.reduction.rigid import rigid_basis, rigid_fields, without
from derive.spec.model.body import NodalBody

DEPENDENT = 1e-5
"""Modes whose part without rigid motion has a singular value below this part of the largest are dependent."""

TIED = 1e-2
"""A rigid motion with more than this part of the lowest elastic frequency is resisted by something outside the body."""

ASYMMETRIC = 1e-9
"""Matrices are symmetric up to this part of their largest entry."""

DIFFERENT = 1e-6
"""A modal stiffness agrees with Phi^T K Phi up to this part of its largest entry."""


def check_body(body: NodalBody) -> None:
    """Refuse a body whose nodes, mass, stiffness or frame cannot be used, whatever its modes."""
    problems = [*_shapes(body)]
    if not problems:
        problems = [*_mass(body), *_stiffness(body), *_frame(body), *_markers(body)]
    if not problems:
        problems = _count(body)
    if problems:
        raise SpecError(tuple(problems))


def check_modes(body: NodalBody, mass: csr_array, raw: Shapes) -> None:
    """Refuse modes that hold a rigid motion or depend on each other, and a stiffness that is not of a free body."""
    x = centred(mass, raw.x)
    problems = rigid_problems(mass, x, raw.phi)
    if not problems:
        problems = [*_negative(body, mass, raw), *_tied(body, mass, x, raw), *_disagree(body, raw)]
    if problems:
        raise SpecError(tuple(problems))


def _shapes(body: NodalBody) -> list[Problem]:
    """Arrays that do not fit each other."""
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
            problem("body.nodes", f"{name} holds values that are not finite")
    return result


def _mass(body: NodalBody) -> list[Problem]:
    mass = canonical(body.data.mass)
    if _asymmetry(mass) > ASYMMETRIC:
        return [Problem("body.nodes", "the mass matrix is not symmetric; give both of its halves")]
    sum_ = float(total(mass.data))
    if not sum_ > 0:
        return [Problem("body.nodes", f"the mass of all nodes is {sum_:.6g} kg; it has to be positive")]
    if (message := indefinite(mass)) is not None:
        return [Problem("body.nodes", message)]
    x = centred(mass, body.data.positions)
    inertia, _ = eigh(products(mass, rigid_fields(x)[3:], rigid_fields(x)[3:]))
    size = sum_ * float(np.abs(x).max(initial=0.0)) ** 2
    where = "all mass is in one point" if inertia[-1] <= 1e-12 * size or not size else "all mass is on one line"
    if not size or inertia[0] <= 1e-12 * inertia[-1]:
        message = "there is no moment of inertia about it, so that its rotation has no equation"
        return [Problem("body.nodes", f"{where}: {message}; give nodes beside it some mass")]
    return []


def indefinite(mass: csr_array) -> str | None:
    """What makes a mass matrix negative somewhere, by its pivots; nodes without mass are allowed."""
    diagonal = mass.diagonal()
    if diagonal.min() < 0:
        node = int(np.argmin(diagonal))
        hint = "if masses are row sums of a consistent mass matrix, give that matrix itself"
        return f"the mass of node {node} is negative ({diagonal[node]:.3g} kg); {hint}"
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
        f"the mass matrix is indefinite: with its diagonal scaled to 1, a pivot is {pivots[worst]:.3g} (node {node}), "
        "so that some motion has a negative kinetic energy; check its entries"
    )


def _stiffness(body: NodalBody) -> list[Problem]:
    data, result = body.data, []
    if data.stiffness is not None and _asymmetry(canonical(data.stiffness)) > ASYMMETRIC:
        result.append(Problem("body.nodes", "the stiffness matrix is not symmetric; give both of its halves"))
    k = data.modal_stiffness
    if k is not None and np.abs(k - k.T).max(initial=0.0) > ASYMMETRIC * np.abs(k).max(initial=0.0):
        result.append(Problem("body.nodes", "modal_stiffness is not symmetric"))
    if data.modes is not None and k is None and data.stiffness is None and len(data.modes):
        result.append(Problem("body.nodes", "modes need modal_stiffness, or the stiffness matrix of the nodes"))
    if data.modes is None and data.stiffness is None and body.modes != 0:
        result.append(Problem("body.nodes", "give modes with modal_stiffness, or a stiffness to compute them from"))
    return result


def _frame(body: NodalBody) -> list[Problem]:
    frame, x = body.frame, body.data.positions
    if frame.kind != "point":
        return []
    if frame.node is None or not 0 <= frame.node < len(x):
        return [Problem("body.frame", f"there is no node {frame.node}; nodes are 0 .. {len(x) - 1}")]
    outside = [i for i in frame.around if not 0 <= i < len(x)]
    if outside:
        return [Problem("body.frame", f"there is no node {outside[0]}; nodes are 0 .. {len(x) - 1}")]
    around = frame.around or neighbours(x, frame.node)
    if not holds(x, frame.node, around):
        which = f"nodes {', '.join(map(str, around))}" if frame.around else "all nodes"
        message = f"{which} are on one line with node {frame.node}: they do not see a rotation about it"
        return [Problem("body.frame", f"{message}; name a node beside that line in `around`")]
    return []


def _markers(body: NodalBody) -> list[Problem]:
    n = len(body.data.positions)
    return [
        Problem(f"body.markers.{m.name}", f"there is no node {m.node}; nodes are 0 .. {n - 1}")
        for m in body.markers
        if not 0 <= m.node < n
    ]


def _count(body: NodalBody) -> list[Problem]:
    data = body.data
    if body.modes is not None and body.modes < 0:
        return [Problem("body.modes", "a number of modes is 0 or more")]
    if data.modes is None and body.modes is None:
        return [Problem("body.modes", "say how many modes are to be computed: modes = 6")]
    if data.modes is not None and body.modes is not None and body.modes > len(data.modes):
        return [Problem("body.modes", f"{body.modes} modes are asked for, but {len(data.modes)} are given")]
    asked = len(data.modes) if data.modes is not None and body.modes is None else body.modes or 0
    most = most_modes(canonical(data.mass), 6)
    if asked > most:
        message = f"{asked} modes are too many: nodes with mass allow {most} elastic modes and 6 rigid motions"
        return [Problem("body.modes", message)]
    return []


def rigid_problems(mass: csr_array, x: Array, phi: Array) -> list[Problem]:
    """Combinations of modes that are rigid motions, or nothing at all."""
    before = np.diag(products(mass, phi, phi))
    if np.any(before <= 0):
        still = ", ".join(str(i) for i in np.flatnonzero(before <= 0) + 1)
        return [Problem("body.modes", f"modes that move no mass: {still}; leave them out")]
    scale = 1 / np.sqrt(before)
    scaled = phi * scale[:, None, None]
    elastic = without(mass, rigid_basis(mass, x), scaled)
    left, vectors = eigh(symmetric(products(mass, elastic, elastic)))
    result = []
    for value, vector in zip(left, vectors, strict=True):
        if value > DEPENDENT**2 * max(float(left[-1]), 1.0):
            break
        weights = vector * scale
        weights = weights / np.abs(weights).max()
        named = " ".join(f"{w:+.3g} mode {i}" for i, w in enumerate(weights, 1) if abs(w) > 1e-6)
        motion = (vector[:, None, None] * scaled).sum(axis=0)[None]
        size = float(products(mass, motion, motion)[0, 0])
        what = "rigid motion is left in the modes" if size > 1e-12 else "the modes are dependent"
        singular = f"(singular value {math.sqrt(max(float(value), 0.0)):.1e})"
        result.append(Problem("body.modes", f"{what} {singular}: {named}; take one out"))
    return result


def _negative(body: NodalBody, mass: csr_array, raw: Shapes) -> list[Problem]:
    """A stiffness that pushes instead of pulling back."""
    sizes = np.sqrt(np.maximum(np.diag(products(mass, raw.phi, raw.phi)), np.finfo(float).tiny))
    values, vectors = eigh(raw.stiffness / np.multiply.outer(sizes, sizes))
    if not len(values) or values[0] >= -max(1e-9 * float(values[-1]), _noise(body, mass)):
        return []
    mode = int(np.argmax(np.abs(vectors[0]))) + 1
    message = f"the stiffness has a negative eigenvalue in the modes ({values[0]:.3g} 1/s^2, mostly mode {mode})"
    return [Problem("body.nodes", f"{message}; check its sign")]


def _tied(body: NodalBody, mass: csr_array, x: Array, raw: Shapes) -> list[Problem]:
    """A stiffness that resists rigid motion."""
    if body.data.stiffness is None or not len(raw.phi):
        return []
    rigid = rigid_basis(mass, x)
    lowest = float((np.diag(raw.stiffness) / np.diag(products(mass, raw.phi, raw.phi))).min())
    values, vectors = eigh(modal_stiffness(body.data.stiffness, rigid))
    if values[-1] <= max(TIED**2 * lowest, _noise(body, mass)):
        return []
    names = ("translation e1", "translation e2", "translation e3", "rotation 1", "rotation 2", "rotation 3")
    motion = names[int(np.argmax(np.abs(vectors[-1])))]
    message = f"the stiffness resists rigid motion ({motion}, {math.sqrt(values[-1]):.3g} rad/s)"
    return [Problem("body.nodes", f"{message}: the body is tied to the ground; export it without supports")]


def _noise(body: NodalBody, mass: csr_array) -> float:
    """What rounding of the stiffness matrix may leave of an omega^2 that is zero."""
    if body.data.stiffness is None:
        return 0.0
    return 1e-12 * float(np.abs(body.data.stiffness.diagonal()).sum() / mass.diagonal().sum())


def _disagree(body: NodalBody, raw: Shapes) -> list[Problem]:
    """Faults of a modal stiffness that disagrees with the stiffness matrix."""
    data = body.data
    if data.modes is None or data.modal_stiffness is None or data.stiffness is None or not len(raw.phi):
        return []
    expected = modal_stiffness(data.stiffness, raw.phi)
    difference = float(np.abs(expected - raw.stiffness).max()) / float(np.abs(expected).max() or 1.0)
    if difference <= DIFFERENT:
        return []
    message = f"modal_stiffness is not Phi^T K Phi of the modes and the stiffness (they differ by {difference:.1e})"
    return [Problem("body.nodes", f"{message}; check units and the order of the modes")]


def _asymmetry(matrix: csr_array) -> float:
    largest = float(np.abs(matrix.data).max(initial=0.0))
    return float(np.abs((matrix - matrix.T).data).max(initial=0.0)) / (largest or 1.0)
