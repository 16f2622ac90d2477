"""`read`: a modal body from the text of a SID."""

from __future__ import annotations

import re

import numpy as np

from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.reduction.integrals import OMEGA_PRODUCTS, Integrals, omega_tensors
from derive.reduction.reasons import integral_entries
from derive.sid.blocks import Block, SidError, SidProblem, parse_blocks
from derive.sid.mapping import (
    INERTIA_COLUMN,
    MATRICES,
    Array,
    Taylor,
    symmetric_parts,
    with_axial,
)
from derive.sid.matrices import read_matrix, real_number, whole_number

ZERO_REASON = "the SID file, where it is exactly zero"
"""The reason of the structural zeros of a body that `read` returns."""

AGREEMENT = 1e-4
"""Relative tolerance for quantities that a SID contains twice, since programs round their output."""

Matrices = dict[str, Taylor]


def read(text: str, name: str | None = None) -> ModalBody:
    """A modal body from the text of a SID, by the relations in `derive.sid.mapping`.

    name: the name of the body; by default that in the first line of the text, or "body". The points have the names in
    the first line, or node_1, node_2, ... with the numbers of the nodes.

    Raises SidError with a list of all faults.
    """
    problems: list[SidProblem] = []
    first, root = parse_blocks(text, problems)
    modal = _modal(root, problems)
    mass, n = _refmod(modal, problems) if modal else (0.0, None)
    if modal is None or n is None:
        raise SidError(problems)
    matrices, lines = _matrices(modal, n, problems)
    points = _points(first, modal, n, problems)
    if problems:
        raise SidError(problems)
    _refuse_stiffening(matrices, lines, problems)
    known = _integrals(mass, matrices, lines, problems)
    if problems:
        raise SidError(problems)
    stiffness = matrices["Ke"].m0
    damping = matrices["De"].m0 if "De" in matrices else np.zeros((n, n))
    c7 = known.c7
    return ModalBody(
        name=name or _header_value(first, "name") or "body",
        doc=f"body with {n} modes from a SID file",
        origin="the reference frame of the SID file",
        mass=mass,
        c1=known.c1,
        c2=known.c2,
        C3=known.C3,
        C4=with_axial(known.S4, -known.c6),
        C5=with_axial(known.S5, c7),
        c6=known.c6,
        c7=c7,
        c8=known.c8,
        stiffness=stiffness,
        damping=damping,
        points=points,
        zeros=_zeros(known, stiffness, damping),
    )


def _modal(root: Block, problems: list[SidProblem]) -> Block | None:
    """The block `modal` of the first part; None, and a fault, if it is missing."""
    part = root.find("part")
    modal = part.find("modal") if part else None
    if modal is None:
        problems.append(SidProblem(part.line if part else 1, "there is no `part` with a `new modal` in it"))
    return modal


def _refmod(modal: Block, problems: list[SidProblem]) -> tuple[float, int | None]:
    """The mass (kg) and the number of modes, None if it is not given."""
    refmod = modal.find("refmod")
    if refmod is None:
        problems.append(SidProblem(modal.line, "modal has no refmod, which contains mass and nelastq"))
        return 0.0, None
    mass, count = refmod.entry("mass"), refmod.entry("nelastq")
    for key, entry in (("mass", mass), ("nelastq", count)):
        if entry is None:
            problems.append(SidProblem(refmod.line, f"refmod has no {key}"))
    value = real_number(mass, problems) if mass else 0.0
    if mass and not value > 0:
        problems.append(SidProblem(mass.line, f"the mass has to be positive, not {value:g}"))
    return value, whole_number(count, problems) if count else None


def _matrices(modal: Block, n: int, problems: list[SidProblem]) -> tuple[Matrices, dict[str, int]]:
    """The matrices of the body by name, and the numbers of their first lines."""
    shapes = {
        "mdCM": ((3, 1),),
        "J": ((3, 3), (6, 1)),
        "Ct": ((n, 3),),
        "Cr": ((n, 3),),
        "Me": ((n, n),),
        "Gr": ((3, 3 * n),),
        "Ge": ((n, 3 * n),),
        "Oe": ((n, 6),),
        "ksigma": ((n, 1),),
        "Ke": ((n, n),),
        "De": ((n, n),),
    }
    matrices: Matrices = {}
    lines: dict[str, int] = {}
    for name in MATRICES:
        block = modal.find(name)
        if block is None:
            if name not in ("ksigma", "De"):
                problems.append(SidProblem(modal.line, f"modal has no {name}"))
            continue
        lines[name] = block.line
        value = read_matrix(block, shapes[name], n, problems)
        if value is not None:
            matrices[name] = value
    return matrices, lines


def _points(first: str, modal: Block, n: int, problems: list[SidProblem]) -> tuple[ModalPoint, ...]:
    """The nodes of the body as points, with the names in the first line of the text if they fit."""
    frame = modal.find("frame")
    nodes = [block for block in frame.blocks if block.name == "node"] if frame else []
    names = _header_value(first, "points").split()
    if len(names) != len(nodes) or len(set(names)) < len(names):
        names = [f"node_{re.sub(r'[^0-9A-Za-z_]', '_', node.label) or at}" for at, node in enumerate(nodes, 1)]
    points = []
    for name, node in zip(names, nodes, strict=True):
        parts: dict[str, Taylor] = {}
        for key, shape in (("origin", (3, 1)), ("phi", (3, n)), ("AP", (3, 3))):
            block = node.find(key)
            if block is not None and (value := read_matrix(block, (shape,), n, problems)) is not None:
                parts[key] = value
            elif block is None and key != "AP":
                problems.append(SidProblem(node.line, f"node {node.label} has no {key}"))
        if "AP" in parts and np.abs(parts["AP"].m0 - np.eye(3)).max() > AGREEMENT:
            problems.append(
                SidProblem(node.line, f"the frame of node {node.label} is rotated (AP), which is not supported")
            )
        if "phi" in parts and parts["phi"].m1 is not None and np.any(parts["phi"].m1):
            message = f"phi of node {node.label} has a first order: geometric stiffness is not supported"
            problems.append(SidProblem(node.line, message))
        if "origin" in parts and "phi" in parts:
            shapes = np.ascontiguousarray(parts["phi"].m0.T)
            points.append(ModalPoint(name, f"node {node.label}", parts["origin"].m0[:, 0].copy(), shapes))
    return tuple(points)


def _refuse_stiffening(matrices: Matrices, lines: dict[str, int], problems: list[SidProblem]) -> None:
    """Add a fault for data that a modal body cannot represent, such as geometric stiffening."""
    if "ksigma" in matrices and (
        np.any(matrices["ksigma"].m0) or matrices["ksigma"].m1 is not None and np.any(matrices["ksigma"].m1)
    ):
        problems.append(SidProblem(lines["ksigma"], "ksigma is not zero: stresses of the reference are not supported"))
    for name in ("Ct", "Me", "Ge", "Ke", "De"):
        taylor = matrices.get(name)
        if taylor is not None and taylor.m1 is not None and np.any(taylor.m1):
            message = (
                f"{name} has a first order: geometric stiffness is not supported; export without it (Geo_Stiff= no)"
            )
            problems.append(SidProblem(lines[name], message))


def _integrals(mass: float, matrices: Matrices, lines: dict[str, int], problems: list[SidProblem]) -> Integrals:
    """The shape integrals; adds a fault for each quantity that the file contains twice with different values."""
    n = len(matrices["Me"].m0)
    c1, c2, c6, c8 = matrices["mdCM"].m0[:, 0], matrices["Ct"].m0, matrices["Cr"].m0, matrices["Me"].m0
    c3, j1 = _inertia(matrices["J"])
    c7 = -matrices["Ge"].m0.reshape(n, n, 3) / 2 + 0.0
    c4 = matrices["Gr"].m0.reshape(3, n, 3).transpose(1, 0, 2) / 2
    s4 = symmetric_parts(c4, -c6)
    size8 = float(np.abs(c8).max(initial=0.0))
    size4 = max(float(np.abs(c4).max(initial=0.0)), float(np.sqrt(size8 * np.abs(c3).max())))

    def agree(name: str, value: Array, other: Array, size: float, message: str) -> None:
        if np.abs(value - other).max(initial=0.0) > AGREEMENT * size:
            problems.append(SidProblem(lines[name], f"{name} {message}"))

    agree("Gr", with_axial(s4, -c6), c4, size4, "does not agree with Cr: its antisymmetric part is Cr of the modes")
    if matrices["mdCM"].m1 is not None:
        agree("mdCM", matrices["mdCM"].m1[:, :, 0].T, c2, max(size4, size8), "has another first order than Ct")
    if j1 is not None:
        agree("J", j1, 2 * s4, size4, "has another first order than Gr")
    if matrices["Cr"].m1 is not None:
        agree("Cr", -matrices["Cr"].m1, c7, size8, "has another first order than Ge")
    columns = _omega_products(matrices["Oe"].m0, s4, size4)
    agree("Oe", omega_tensors(matrices["Oe"].m0, columns), s4, size4, "does not agree with Gr")
    s5 = _second_moments(matrices, columns)
    if s5 is None:
        message = (
            "has no first order, which contains int rho {(Phi_i . Phi_j) I - Phi_i Phi_j}; export it with first order"
        )
        problems.append(SidProblem(lines["Oe"], f"Oe {message}"))
        s5 = np.zeros((n, n, 3, 3))
    else:
        trace = s5[..., 0, 0] + s5[..., 1, 1] + s5[..., 2, 2]
        message = "has a first order that does not agree with Me; export without geometric stiffness (Geo_Stiff= no)"
        agree("Oe", trace, 2 * c8, size8, message)
    return Integrals(mass, c1.copy(), c2, c3, s4, s5, c6, c7, c8)


def _inertia(inertia: Taylor) -> tuple[Array, Array | None]:
    """C3 (3, 3), and the first order (N, 3, 3) of J, if there is one."""
    m1 = None if inertia.m1 is None else inertia.m1.transpose(1, 0, 2)  # mode first
    if inertia.m0.shape == (3, 3):
        return inertia.m0, m1
    return _tensor(inertia.m0[:, 0]), None if m1 is None else _tensor(m1[..., 0])


def _tensor(column: Array) -> Array:
    """The symmetric tensors (..., 3, 3) of columns (..., 6) of J."""
    matrices = np.zeros((*column.shape[:-1], 3, 3))
    for at, (a, b) in enumerate(INERTIA_COLUMN):
        matrices[..., a, b] = matrices[..., b, a] = column[..., at]
    return matrices


def _omega_products(oe: Array, s4: Array, size: float) -> tuple[tuple[int, int], ...]:
    """The order of the products in Omega: some programs write w1 w3 before w2 w3, which a comparison with Gr shows."""
    for products in (OMEGA_PRODUCTS, INERTIA_COLUMN):
        if np.abs(omega_tensors(oe, products) - s4).max(initial=0.0) <= AGREEMENT * size:
            return products
    return OMEGA_PRODUCTS


def _second_moments(matrices: Matrices, products: tuple[tuple[int, int], ...]) -> Array | None:
    """The symmetric parts (N, N, 3, 3) of C5 from the first order of Oe, or else of Gr; None if neither has one."""
    n = len(matrices["Me"].m0)
    if matrices["Oe"].m1 is not None:
        return omega_tensors(matrices["Oe"].m1, products)
    if matrices["Gr"].m1 is not None:
        c5 = matrices["Gr"].m1.reshape(3, n, n, 3).transpose(2, 1, 0, 3) / 2
        return np.asarray((c5 + np.swapaxes(c5, -1, -2)) / 2)
    return np.zeros((0, 0, 3, 3)) if n == 0 else None


def _zeros(known: Integrals, stiffness: Array, damping: Array) -> dict[str, str]:
    """The names of all entries that are exactly zero, with their reason."""
    tables = {"stiffness": stiffness, "damping": damping}
    zeros = {}
    for entry in integral_entries(len(known.c2)):
        table = tables.get(entry.table)
        if (getattr(known, entry.table) if table is None else table)[entry.index] == 0:
            zeros[entry.name] = ZERO_REASON
    return zeros


def _header_value(first: str, key: str) -> str:
    """The names after `key=` in the first line of a text that `write` has produced; empty if there are none."""
    match = re.search(rf"\b{key}= *([A-Za-z_]\w*(?: +[A-Za-z_]\w*)*)", first, re.ASCII)
    return match[1] if match else ""
