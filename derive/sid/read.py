"""`read`: a modal body from the text of a SID."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from derive.mechanics.bodies.modal_body import ModalBody
from derive.reduction.integrals import Integrals, omega_tensors
from derive.reduction.reasons import integral_entries
from derive.sid.blocks import Block, SidError, SidProblem, parse_blocks
from derive.sid.geometric_stiffness import (
    first_order_of_oe,
    given_stiffening,
    header_stiffening,
    of_one_order,
    omega_products,
    rotational_stiffness,
    without_forces,
)
from derive.sid.mapping import AGREEMENT, INERTIA_COLUMN, MATRICES, Array, Matrices, Taylor, symmetric_parts, with_axial
from derive.sid.matrices import read_matrix, real_number, whole_number
from derive.sid.nodes import header_names, mean_of_both, read_points, read_twists, symmetric_in_modes
from derive.sid.unused import SidWarning, unused

ZERO_REASON = "the SID file, where it is exactly zero"
"""The reason of the structural zeros of a body that `read` returns."""


@dataclass(frozen=True)
class StandardInput:
    """The contents of a SID: the body, the rotations (N, 3), rad/m, of its points by name, and what is not used."""

    body: ModalBody
    twists: dict[str, Array]
    notes: tuple[str, ...]


def read(text: str, name: str | None = None) -> ModalBody:
    """A modal body from the text of a SID, by the relations in `derive.sid.mapping`.

    name: the name of the body; by default that in the first line of the text, or "body". The points have the names in
    the first line, or node_1, node_2, ... with the numbers of the nodes. A SID with geometric stiffness gives a body of
    second order; where K0F is missing, points move to first order.

    Raises SidError with a list of all faults. Warns with SidWarning of what the body does not use, and of missing K0F.
    """
    result = read_with_rotations(text, name, used=())
    if result.notes:
        warnings.warn("\n".join(result.notes), SidWarning, stacklevel=2)
    return result.body


def read_with_rotations(text: str, name: str | None = None, used: tuple[str, ...] = ("psi",)) -> StandardInput:
    """The contents of a SID. used: the blocks of nodes that the caller uses besides those of `read`.

    Raises SidError with a list of all faults.
    """
    problems: list[SidProblem] = []
    first, root = parse_blocks(text, problems)
    modal = _modal(root, problems)
    mass, n = _refmod(modal, problems) if modal else (0.0, None)
    if modal is None or n is None:
        raise SidError(problems)
    matrices, lines = _matrices(modal, n, problems)
    points = read_points(first, modal, n, problems)
    names = tuple(point.name for point in points)
    twists = read_twists(modal, names, n, problems) if "psi" in used and not problems else {}
    if problems:
        raise SidError(problems)
    _unsupported(matrices, lines, problems)
    stiffening, declared = given_stiffening(matrices, points), header_stiffening(first)
    if stiffening and declared is False:
        problems.append(SidProblem(1, f"the first line says Geo_Stiff= no, but there is {', '.join(stiffening)}"))
    second_order = bool(stiffening or declared)
    known = _integrals(mass, matrices, lines, second_order, problems)
    if problems:
        raise SidError(problems)
    notes = (*unused(root, used), *(without_forces(points) if second_order else ()))
    stiffness = matrices["Ke"].m0
    damping = matrices["De"].m0 if "De" in matrices else np.zeros((n, n))
    c7 = known.c7
    with_geometric = f" and geometric stiffness ({', '.join(stiffening)})" if stiffening else ""
    body = ModalBody(
        name=name or next(iter(header_names(first, "name")), "body"),
        doc=f"body with {n} modes{with_geometric} from a SID file",
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
        points=of_one_order(points, second_order),
        zeros=_zeros(known, stiffness, damping),
        c9=known.c9,
        c10=known.c10,
    )
    return StandardInput(body, twists, notes)


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


def _unsupported(matrices: Matrices, lines: dict[str, int], problems: list[SidProblem]) -> None:
    """Add a fault for data that a modal body cannot represent."""
    if "ksigma" in matrices and (
        np.any(matrices["ksigma"].m0) or matrices["ksigma"].m1 is not None and np.any(matrices["ksigma"].m1)
    ):
        problems.append(SidProblem(lines["ksigma"], "ksigma is not zero: stresses of the reference are not supported"))
    for name in ("Me", "Ge", "Ke", "De"):
        taylor = matrices.get(name)
        if taylor is not None and taylor.m1 is not None and np.any(taylor.m1):
            problems.append(SidProblem(lines[name], f"{name} has a first order, which is not supported"))


def _integrals(
    mass: float,
    matrices: Matrices,
    lines: dict[str, int],
    second_order: bool,
    problems: list[SidProblem],
) -> Integrals:
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
        odd = (matrices["Cr"].m1 - np.swapaxes(matrices["Cr"].m1, 0, 1)) / 2
        agree("Cr", -odd, c7, size8, "has another first order than Ge")
    columns = omega_products(matrices["Oe"].m0, s4, size4)
    agree("Oe", omega_tensors(matrices["Oe"].m0, columns), s4, size4, "does not agree with Gr")
    s5 = first_order_of_oe(matrices, columns)
    if s5 is None:
        message = (
            "has no first order, which contains int rho {(Phi_i . Phi_j) I - Phi_i Phi_j}; export it with first order"
        )
        problems.append(SidProblem(lines["Oe"], f"Oe {message}"))
        s5 = np.zeros((n, n, 3, 3))
    else:
        agree("Oe", s5, np.swapaxes(s5, 0, 1), size8, "has a first order that is not symmetric in the modes")
        trace = s5[..., 0, 0] + s5[..., 1, 1] + s5[..., 2, 2]
        if not second_order:
            agree("Oe", trace, 2 * c8, size8, "has a first order that does not agree with Me")
    ct = matrices["Ct"].m1
    if ct is not None and not symmetric_in_modes(ct):
        problems.append(SidProblem(lines["Ct"], "the first order of Ct, K0t, is not symmetric in the modes"))
    integrals = Integrals(mass, c1.copy(), c2, c3, s4, s5, c6, c7, c8)
    if not second_order:
        return integrals
    c9 = np.zeros((n, n, 3)) if ct is None else mean_of_both(ct)
    return replace(integrals, c9=c9, c10=rotational_stiffness(matrices["Cr"].m1, c7))


def _inertia(inertia: Taylor) -> tuple[Array, Array | None]:
    """The integral C3 (3, 3), and the first order (N, 3, 3) of J, if there is one."""
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


def _zeros(known: Integrals, stiffness: Array, damping: Array) -> dict[str, str]:
    """The names of all entries that are exactly zero, with their reason."""
    tables = {"stiffness": stiffness, "damping": damping}
    zeros = {}
    for entry in integral_entries(len(known.c2), known.c9 is not None):
        table = tables.get(entry.table)
        if (getattr(known, entry.table) if table is None else table)[entry.index] == 0:
            zeros[entry.name] = ZERO_REASON
    return zeros
