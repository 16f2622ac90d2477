"""A SID with geometric stiffness: to the last bit, in the equations of motion, in parts, and what is reported."""

from __future__ import annotations

import re
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from derive.mechanics.bodies.modal_body import ModalBody, ModalFrame
from derive.reduction import reduce
from derive.reduction.body import prepare
from derive.sid import SidError, SidWarning, read, write
from derive.sid.mapping import to_matrices
from derive.sid.write import fortran_number
from derive.spec.model.body import BodyFrame, DisplacementOrder

sys.path.insert(0, str(Path(__file__).parents[1] / "reduction"))
import bodies_of_nodes as bodies
import second_order_bodies as stiff

GIVEN, PSI = stiff.stiffened(3, bodies.GIVEN, orthonormal=False)
BODY = reduce(GIVEN)
TEXT = write(BODY)


@pytest.mark.parametrize("frame", [bodies.GIVEN, bodies.MEAN, BodyFrame("point", 2, (5, 7, 9))], ids=lambda f: f.kind)
def test_round_trip(frame: BodyFrame) -> None:
    first = reduce(stiff.stiffened(4, frame)[0])
    text = write(first)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        second = read(text)
    assert write(second) == text and "Geo_Stiff= yes" in text
    for name in ("c1", "c2", "C3", "C4", "C5", "c6", "c7", "c8", "c9"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), name
    assert np.allclose(first.c10, second.c10, rtol=0, atol=1e-15 * np.abs(first.c10).max())
    for one, other in zip(first.points, second.points, strict=True):
        assert np.array_equal(one.second, other.second)
    assert set(first.zeros) <= set(second.zeros) and "c9_1_1_1" in first.zeros or frame.kind != "mean"
    assert second.doc == (
        "body with 4 modes and geometric stiffness (K0t, K0r, K0omega, K0F) from a SID file"
        if frame.kind != "mean"
        else "body with 4 modes and geometric stiffness (K0omega, K0F) from a SID file"
    )


def test_rotations_of_second_order_are_the_first_order_of_psi() -> None:
    point, rng = BODY.points[0], np.random.default_rng(6)
    second = rng.normal(size=(4, 4, 3))
    frame = ModalFrame(point, rng.normal(size=(4, 3)), second + second.swapaxes(0, 1))
    text = write(BODY, frames={point.name: frame}).partition("psi")[2].partition("end psi")[0]
    for i, j, k in np.ndindex(4, 4, 3):
        assert f"m1( {k + 1}, {j + 1}, {i + 1}) = {fortran_number(frame.second_twists[i, j, k])}" in text


def test_matrices_make_the_row_of_a_mode() -> None:
    """Against the derivative by a of sums over the nodes of (Phi_i + a_k Psi_ik) . xddot, at a = 0."""
    prepared = prepare(GIVEN)
    m, x, phi = prepared.mass.diagonal(), prepared.shapes.x, prepared.shapes.phi
    g, w, wdot = np.random.default_rng(5).normal(size=(3, 3))

    def row(a: np.ndarray) -> np.ndarray:
        r = x + np.tensordot(a, phi, 1) + np.einsum("i,j,ijnk->nk", a, a, PSI) / 2
        xddot = g + np.cross(wdot, r) + np.cross(w, np.cross(w, r))
        return np.einsum("n,ink,nk->i", m, phi + np.einsum("k,iknl->inl", a, PSI), xddot)

    h = 1e-4
    expected = np.array([(row(h * e) - row(-h * e)) / (2 * h) for e in np.eye(3)])
    first = {name: to_matrices(BODY)[name].m1 for name in ("Ct", "Cr", "Oe")}
    squares = np.array([w[a] * w[b] for a, b in stiff.OMEGA_PRODUCTS])
    found = first["Ct"] @ g + first["Cr"] @ wdot + first["Oe"] @ squares
    assert np.allclose(found.T, expected, atol=1e-6 * np.abs(expected).max())
    for k, point in enumerate(BODY.points):
        node = TEXT.split("new node")[k + 1].split("phi")[1]
        value = re.search(r"m1\( 2, 1, 3\) = (\S+)", node)[1].replace("D", "e")
        assert float(value) == pytest.approx(PSI[2, 0, k, 1], rel=1e-14) and point.second is not None


def without(text: str, key: str) -> str:
    """A text without the first orders of its matrices `key`."""
    kept, inside = [], False
    for line in text.splitlines():
        word = line.strip()
        inside = inside or word == key
        if not inside or not word.startswith("m1("):
            kept.append(line.replace("order = 1", "order = 0") if inside else line)
        inside = inside and word != f"end {key}"
    return "\n".join(kept)


def noted(text: str) -> tuple[ModalBody, list[str]]:
    with pytest.warns(SidWarning) as caught:
        body = read(text)
    return body, str(caught[0].message).splitlines()


def test_a_part_of_it_is_used_as_it_is() -> None:
    """K0omega alone, as from a program that exports no more, without a word about it in the first line."""
    text = without(without(TEXT, "Ct"), "phi").replace("Geo_Stiff= yes ; ", "")
    found, notes = noted(text)
    assert not found.c9.any() and np.array_equal(found.C5, BODY.C5) and not found.points[3].second.any()
    assert "geometric stiffness (K0r, K0omega)" in found.doc
    names = ", ".join(f"at{k}" for k in range(4))
    assert notes == [
        f"1: there is no K0F (first order of phi) of {names} and 6 more: these points move to first order in the "
        "amplitudes"
    ]


def test_forces_alone() -> None:
    plain = write(reduce(replace(GIVEN, order=DisplacementOrder.FIRST_ORDER)))
    start, end = (TEXT.index(word) for word in ("      frame\n", "      end frame\n"))
    first, last = (plain.index(word) for word in ("      frame\n", "      end frame\n"))
    found = read(plain[:first].replace("Geo_Stiff= no", "by hand") + TEXT[start:end] + plain[last:])
    assert not found.c9.any() and not found.c10.any() and np.array_equal(found.points[2].second, BODY.points[2].second)
    assert found.doc.endswith("geometric stiffness (K0F) from a SID file")


def faults(text: str) -> list[str]:
    with pytest.raises(SidError) as caught:
        read(text)
    return str(caught.value).splitlines()


def changed(text: str, block: str, number: str, value: float) -> tuple[str, int]:
    """A text with an entry of the first such block replaced, and the line of the block."""
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if line.strip() == block)
    entry = next(k for k, line in enumerate(lines) if k > at and line.strip().startswith(number))
    lines[entry] = f"{number} = {value!r}"
    return "\n".join(lines), at + 1


@pytest.mark.parametrize(
    ("block", "number", "fault"),
    [
        ("Ct", "m1( 1, 2, 3)", "the first order of Ct, K0t, is not symmetric in the modes"),
        ("Oe", "m1( 1, 2, 3)", "Oe has a first order that is not symmetric in the modes"),
        ("Cr", "m1( 1, 2, 3)", "Cr has another first order than Ge"),
    ],
)
def test_matrices_that_are_not_symmetric(block: str, number: str, fault: str) -> None:
    text, line = changed(TEXT, block, number, 77.0)
    assert faults(text) == [f"{line}: {fault}"]


def test_displacements_of_nodes_that_contradict_each_other() -> None:
    text, line = changed(TEXT, "phi", "m1( 1, 2, 3)", 77.0)
    assert f"{line - 14}: the first order of phi of node 1, -K0F, is not symmetric in the modes" in [
        re.sub(r"^\d+", str(line - 14), fault) for fault in faults(text)
    ]
    text, _ = changed(TEXT, "origin", "m1( 1, 2, 1)", 77.0)
    assert any("the origin of node 1 has another first order than phi" in fault for fault in faults(text))


def test_a_first_line_that_says_no() -> None:
    said = "1: the first line says Geo_Stiff= no, but there is K0t, K0r, K0omega, K0F"
    assert faults(TEXT.replace("Geo_Stiff= yes", "Geo_Stiff= no")) == [said]


def test_what_is_not_used_is_reported() -> None:
    """Each kind once, with the first of its lines; zeros are no data."""
    turned = TEXT.replace("            end psi", "               m0( 1, 2) = 1.D-1\n            end psi")
    extra = turned.replace("      mdCM\n", "      Kg\n         m0( 1, 1) = 2\n      end Kg\n      mdCM\n")
    extra = extra.replace("         nelastq", "         stamp = 7\n         nelastq")
    extra = extra.replace("rframe = body ref", "rframe = node 3", 1)
    found, notes = noted(extra)
    lines = extra.splitlines()

    def line(text: str) -> int:
        return 1 + next(k for k, line in enumerate(lines) if line.strip() == text)

    assert notes == [
        f"{line('stamp = 7')}: stamp in refmod is not used: a modal body has no such data",
        f"{line('rframe = node 3')}: rframe = node 3 is not used: positions are taken in the frame of the body",
        f"{line('psi')}: psi of a node and in 9 more places is not used: points of a modal body do not rotate, and "
        "moments (K0M) do not act on them",
        f"{line('Kg')}: Kg is not used: a modal body has no such data",
    ]
    assert write(found) == TEXT
