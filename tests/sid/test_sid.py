"""A SID holds all that a modal body does, its matrices make the equations of motion, and faults have their lines."""

from __future__ import annotations

import sys
from dataclasses import fields, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.derivation import reduced_bodies
from derive.mechanics.bodies.modal_body import ModalBody
from derive.reduction import reduce
from derive.reduction.body import prepare
from derive.reduction.integrals import OMEGA_PRODUCTS
from derive.sid import SidError, read, write
from derive.sid.mapping import to_matrices
from derive.sid.unused import SidWarning
from derive.sid.write import fortran_number
from derive.spec.model.body import BodyFrame, Damping, NodalBody
from derive.spec.model.node_markers import NodeMarker

sys.path.insert(0, str(Path(__file__).parents[1] / "reduction"))
import bodies_of_nodes as bodies

SMALL = Path(__file__).with_name("small.sid").read_text()
FIRST_LINE = SMALL.splitlines()[0]
POINTS = (NodeMarker("tip", 3), NodeMarker("root", 0))
GIVEN = bodies.nodal(bodies.cloud(4), bodies.GIVEN, orthonormal=False, markers=POINTS, damping=Damping(Fraction(1, 50)))


@pytest.mark.parametrize(
    "body",
    [
        GIVEN,
        bodies.nodal(bodies.cloud(0)),
        bodies.nodal(bodies.cloud(1), markers=()),
        bodies.nodal(bodies.truss(), modes=7, markers=POINTS),
        bodies.nodal(
            bodies.consistent(bodies.cloud(9, 20)), BodyFrame("point", 2), damping=Damping(mass=Fraction(1, 3))
        ),
    ],
)
@pytest.mark.parametrize("inertia", ["matrix", "vector"])
def test_round_trip_to_the_last_bit(body: NodalBody, inertia: str) -> None:
    first = reduce(body)
    text = write(first, inertia=inertia)
    second = read(text)
    for name in (f.name for f in fields(ModalBody)):
        value = getattr(first, name)
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(second, name)), name
    assert first.mass == second.mass and first.name == second.name
    assert [p.name for p in first.points] == [p.name for p in second.points]
    for one, other in zip(first.points, second.points, strict=True):
        assert np.array_equal(one.position, other.position) and np.array_equal(one.shapes, other.shapes)
    assert set(first.zeros) <= set(second.zeros) and write(second, inertia=inertia) == text
    assert set(second.zeros.values()) <= {"the SID file, where it is exactly zero"}


def skew(v: np.ndarray) -> np.ndarray:
    return np.cross(np.eye(3), v)


@pytest.mark.parametrize("deformed", [False, True])
def test_matrices_make_the_equations_of_motion(deformed: bool) -> None:
    """Against sums over the nodes of {1, r x, Phi_i .} xddot; deformed, all but J and Gr, which lack second order."""
    body = reduce(GIVEN)
    prepared = prepare(GIVEN)
    m, x, phi = prepared.mass.diagonal(), prepared.shapes.x, prepared.shapes.phi
    rng = np.random.default_rng(3)
    g, w, wdot = rng.normal(size=(3, 3))
    a = rng.normal(size=4) * (0.3 if deformed else 0.0)
    adot, addot = rng.normal(size=(2, 4))
    r, rdot, rddot = x + np.tensordot(a, phi, 1), np.tensordot(adot, phi, 1), np.tensordot(addot, phi, 1)
    xddot = g + np.cross(wdot, r) + np.cross(w, np.cross(w, r)) + 2 * np.cross(w, rdot) + rddot
    forces, moments = m @ xddot, m @ np.cross(r, xddot)
    modal = np.einsum("n,ink,nk->i", m, phi, xddot) + body.stiffness @ a + body.damping @ adot
    matrices = to_matrices(body)

    def at(name: str) -> np.ndarray:
        matrix = matrices[name]
        return matrix.m0 + (0 if matrix.m1 is None else np.einsum("ikj,k->ij", matrix.m1, a))

    md, inertia, ct, cr = at("mdCM")[:, 0], at("J"), at("Ct"), at("Cr")
    gr, ge = (at(name).reshape(-1, 4, 3) @ w for name in ("Gr", "Ge"))
    products = np.array([w[i] * w[j] for i, j in OMEGA_PRODUCTS])
    found = body.mass * g + skew(md).T @ wdot + ct.T @ addot + 2 * skew(w) @ ct.T @ adot + skew(w) @ skew(w) @ md
    assert np.allclose(found, forces, rtol=1e-12)
    found = ct @ g + cr @ wdot + at("Me") @ addot + ge @ adot + at("Oe") @ products + at("Ke") @ a + at("De") @ adot
    assert np.allclose(found, modal, rtol=1e-12)
    second = np.einsum("i,j,ijab->ab", a, a, body.C5)
    gr_second = 2 * np.einsum("k,lkab,b,l->a", a, body.C5, w, adot)
    inertia = inertia + second
    found = skew(md) @ g + inertia @ wdot + cr.T @ addot + gr @ adot + gr_second + skew(w) @ inertia @ w
    assert np.allclose(found, moments, rtol=1e-12)
    assert np.any(second) == deformed


def test_layout() -> None:
    text = write(reduce(GIVEN))
    lines = [line.strip() for line in text.splitlines()]
    assert lines[0] == "2 4 : nodes, modes; Geo_Stiff= no ; name= test ; points= tip root"
    assert lines[1:4] == ["part", "new modal", "refmod"] and lines[-2:] == ["end modal", "end part"]
    order = [line.split()[1] for line in lines if line.startswith("end ")]
    matrices = ["mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De"]
    assert order == ["refmod", *["origin", "phi", "psi", "AP", "node"] * 2, "frame", *matrices, "modal", "part"]
    assert lines.count("new node = 2") == 1 and "ielastq( 4) = Eigen Mode 4 :" in text
    me = lines[lines.index("Me") : lines.index("end Me")]
    assert me[1:7] == ["order = 0", "nrow = 4", "ncol = 4", "nq = 4", "nqn = 0", "structure = 2"]
    assert len(me) == 7 + 10 and me[8].startswith("m0( 2, 1) = ") and "D" in me[8]


def test_a_file_by_hand() -> None:
    """Two masses of 1 at X = (+-1/2, 0, 0); the mode moves the first along e2."""
    body = read(SMALL)
    assert body.name == "body" and body.mass == 2 and body.modes == 1
    assert not np.any(body.c1) and body.c2.tolist() == [[0, 1, 0]] and body.c6.tolist() == [[0, 0, 0.5]]
    assert np.array_equal(body.C3, np.diag([0, 0.5, 0.5])) and body.c8.tolist() == [[1]]
    assert body.C4.tolist() == [[[0, 0, 0], [-0.5, 0, 0], [0, 0, 0]]]
    assert np.array_equal(body.C5[0, 0], np.diag([1, 0, 1])) and not np.any(body.c7)
    assert body.stiffness.tolist() == [[100]] and body.damping.tolist() == [[0]]
    (point,) = body.points
    assert point.name == "node_7" and point.position.tolist() == [0.5, 0, 0] and point.shapes.tolist() == [[0, 1, 0]]
    assert "C4_1_12" not in body.zeros and body.zeros["C4_1_13"] == "the SID file, where it is exactly zero"
    assert read(SMALL, "bar").name == "bar" and read(SMALL.split("\n", 1)[1]).mass == 2


def faults(text: str) -> list[str]:
    with pytest.raises(SidError) as caught:
        read(text)
    assert isinstance(caught.value, ValueError)
    return str(caught.value).splitlines()


@pytest.mark.parametrize(
    ("old", "new", "where", "fault"),
    [
        ("2.0D+00", "heavy", "mass    = heavy", 'mass: "heavy" is not a number'),
        ("2.0D+00", "-1", "mass    = -1", "the mass has to be positive, not -1"),
        ("nelastq = 1", "nelastq = 1.5", "nelastq = 1.5", 'nelastq: "1.5" is not a number from 0 to 10000'),
        ("m0( 1, 1) = 100", "m0( 2, 1) = 100", "m0( 2, 1) = 100", "m0( 2, 1) is outside of 1 x 1"),
        ("m0( 1, 1) = 100", "m0(1) = 100", "m0(1) = 100", "m0(1) is not of the form m0( row, column)"),
        ("m0( 1, 1) = 100", "m1( 1, 1, 1) = 9", "m1( 1, 1, 1) = 9", "m1 in Ke of order 0"),
        ("m0( 1, 1) = 100", "m0( 1, 1) = 1e999", "m0( 1, 1) = 1e999", 'm0: "1e999" is not a number'),
        ("m1( 4, 1, 1)", "m1( 4, 2, 1)", "m1( 4, 2, 1) = -0.5D+00", "m1( 4, 2, 1) is outside of 6 x 1 x 1"),
        (
            "m1( 1, 1, 3)",
            "m1( 1, 3, 1)",
            "m1( 1, 3, 1) = -1",
            "m1( 1, 3, 1) is outside of 1 x 1 x 6; the mode is the se",
        ),
        ("m1( 1, 1, 3)", "m1( 1, 1, 1)", "m1( 1, 1, 1) = -1", "m1( 1, 1, 1) is already on line "),
        ("      Ge\n", "", "end Ge", "`end Ge` where no Ge has begun"),
        ("      end Ge\n", "", "Ge", "Ge has no `end Ge` before line "),
        ("      m0( 1, 4) = .5", "      ?", "?", '"?" is neither a name, nor an `end`, nor `key = value`'),
        ("m0( 1, 4) = .5", "m0( 1, 4) = .4", "Oe", "Oe does not agree with Gr"),
        (
            "m1( 1, 1, 3) = -1",
            "m1( 1, 1, 3) = -3",
            FIRST_LINE,
            "the first line says Geo_Stiff= no, but there is K0omega",
        ),
        ("m1( 4, 1, 1) = -0.5D+00", "m1( 4, 1, 1) = 0.5D+00", "J", "J has another first order than Gr"),
        ("m0( 1, 3) = 5.D-1", "m0( 1, 3) = -5.D-1", "Gr", "Gr does not agree with Cr"),
        ("m1( 2, 1, 1) = 1.0E+00", "m1( 2, 1, 1) = 2", "mdCM", "mdCM has another first order than Ct"),
        ("end modal", "end model", "end model", "`end model` where no model has begun"),
    ],
)
def test_faults(old: str, new: str, where: str, fault: str) -> None:
    assert SMALL.count(old) == 1
    text = SMALL.replace(old, new)
    at = len(lines) - lines[::-1].index(where) if (lines := [line.strip() for line in text.splitlines()]) else 0
    found = faults(text)
    assert any(line.startswith(f"{at}: {fault}") for line in found), (at, found)


def test_faults_come_together() -> None:
    text = SMALL.replace("2.0D+00", "x").replace("ncol = 6", "ncol = 5").replace("      Ke\n", "      Kf\n")
    found = faults(text)
    assert [line.split(":")[0] for line in found] == sorted((line.split(":")[0] for line in found), key=int)
    assert any("mass" in line for line in found) and any("Oe is 1 x 5; 1 x 6 is expected" in line for line in found)
    assert any("modal has no Ke" in line for line in found) and any("`end Ke` where no Ke" in line for line in found)


@pytest.mark.parametrize("text", ["", "part", "1 1\npart\nend part", "\n" * 9, "part\nnew modal\nend modal\nend part"])
def test_texts_that_are_no_sid(text: str) -> None:
    assert faults(text)


def test_what_has_no_place_in_a_modal_body() -> None:
    zero = "nqn = 0\n         structure = 0\n      end ksigma"
    stressed = SMALL.replace(zero, "nqn = 0\n         structure = 3\n         m0( 1, 1) = 4\n      end ksigma")
    assert any("ksigma is not zero" in line for line in faults(stressed))
    constant = SMALL.replace("      Oe\n         order = 1", "      Oe\n         order = 0")
    constant = constant.replace("         m1( 1, 1, 1) = -1\n         m1( 1, 1, 3) = -1\n", "")
    assert any("Oe has no first order, which contains" in line for line in faults(constant))
    first = "\n".join(["", *(f"         m1( {i}, 1, {i}) = 2" for i in (1, 3))])
    with_first = constant.replace("      Gr\n         order = 0", "      Gr\n         order = 1")
    with_first = with_first.replace("         m0( 2, 1) = -1", "         m0( 2, 1) = -1" + first)
    assert np.array_equal(read(with_first).C5, read(SMALL).C5)


def test_second_moments_from_the_first_order_of_gr() -> None:
    """The second moments follow from Gr where Oe is constant; Gr_l has 2 C5_lk there."""
    body = reduce(GIVEN)
    text = write(body)
    start, end = text.index("      Oe\n"), text.index("      end Oe\n")
    constant = [line for line in text[start:end].replace("order = 1", "order = 0").splitlines() if "m1(" not in line]
    text = text[:start] + "\n".join([*constant, ""]) + text[end:]
    first = [
        f"         m1( {a + 1}, {k + 1}, {3 * i + b + 1}) = {float(2 * body.C5[i, k, a, b])!r}"
        for i, k, a, b in np.ndindex(4, 4, 3, 3)
    ]
    start, end = text.index("      Gr\n"), text.index("      end Gr\n")
    text = text[:start] + text[start:end].replace("order = 0", "order = 1") + "\n".join([*first, ""]) + text[end:]
    assert np.allclose(read(text).C5, body.C5, rtol=1e-14)


def test_the_other_order_of_products_is_noticed() -> None:
    """Some programs write w1 w3 before w2 w3; Gr shows which it is."""
    body = reduce(GIVEN)
    matrices = to_matrices(body)
    text = write(body)
    lines = text.splitlines()
    start, end = lines.index("      Oe"), lines.index("      end Oe")
    swap = {"5": "6", "6": "5"}

    def swapped(line: str) -> str:
        head, _, tail = line.partition(")")
        return head[:-1] + swap.get(head[-1], head[-1]) + ")" + tail if "m" in head else line

    lines[start:end] = [swapped(line) if "=" in line and "(" in line else line for line in lines[start:end]]
    found = read("\n".join(lines))
    assert not np.array_equal(matrices["Oe"].m0[:, 4], matrices["Oe"].m0[:, 5])
    assert np.array_equal(found.C4, body.C4) and np.array_equal(found.C5, body.C5)


def test_numbers_rounded_by_another_program_are_accepted() -> None:
    body = reduce(GIVEN)
    lines = [
        f"{line.split('=')[0]}= {float(line.split('=')[1].replace('D', 'e')):.6E}"
        if line.strip()[:2] in ("m0", "m1")
        else line
        for line in write(body).splitlines()
    ]
    found = read("\n".join(lines))
    assert np.allclose(found.C5, body.C5, rtol=0, atol=1e-5 * np.abs(body.C5).max())
    assert np.array_equal(found.c7, -found.c7.transpose(1, 0, 2))


def test_a_body_without_names() -> None:
    body = replace(reduce(GIVEN), name="")
    assert read(write(body)).name == "body"


@pytest.mark.parametrize("name", ["Me", "Ge", "Ke", "De"])
def test_a_first_order_that_a_body_cannot_have_is_refused(name: str) -> None:
    text = write(reduce(GIVEN))
    start, end = text.index(f"      {name}\n"), text.index(f"      end {name}\n")
    first = text[start:end].replace("order = 0", "order = 1") + "         m1( 1, 2, 1) = 1\n"
    found = faults(text[:start] + first + text[end:])
    line = text[:start].count("\n") + 1
    assert any(fault.startswith(f"{line}: {name} has a first order, which is not") for fault in found), found


def test_frequencies_are_those_of_the_generalised_eigenvalue_problem() -> None:
    data = bodies.truss()
    text = write(reduce(bodies.nodal(data, modes=4)))
    masses = np.repeat(data.mass.diagonal(), 3)
    values = np.linalg.eigvalsh(data.stiffness.toarray() / np.sqrt(np.outer(masses, masses)))[6:10]
    written = [float(line.split()[-2]) for line in text.splitlines() if line.strip().startswith("ielastq(")]
    assert written == pytest.approx(np.sqrt(values) / (2 * np.pi), rel=1e-6)


@pytest.mark.parametrize(("change", "accepted"), [(3e-5, True), (1e-3, False)])
def test_quantities_that_a_file_contains_twice_agree_to_four_digits(change: float, accepted: bool) -> None:
    old = "m1( 2, 1, 1) = 1.0E+00"  # of mdCM, which is Ct once more
    text = SMALL.replace(old, f"m1( 2, 1, 1) = {1 + change!r}")
    if accepted:
        assert read(text).c2.tolist() == [[0, 1, 0]]
    else:
        assert any("mdCM has another first order than Ct" in fault for fault in faults(text))


def test_component_modes_of_a_scene_have_a_sid_with_the_rotations_of_their_markers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`sid` of a scene prints its body with Craig-Bampton modes: what `read` returns of it, and psi in the text."""
    scene = (
        (ROOT / "examples/spatial_crank_slider.toml")
        .read_text()
        .replace("spatial_rod.npz", f"{ROOT}/examples/spatial_rod.npz")
    )
    path = tmp_path / "scene.toml"
    path.write_text(scene.replace("modes = 4", 'modes = 7\ninterface = ["ball", "yoke"]'))
    assert main(["sid", str(path)]) == 0
    text = capsys.readouterr().out
    reduced = reduced_bodies(derive.read(path))["rod"]
    with pytest.warns(SidWarning, match="psi"):
        again = read(text)
    assert np.array_equal(again.stiffness, reduced.body.stiffness) and np.array_equal(again.C5, reduced.body.C5)
    assert [point.name for point in again.points] == ["ball", "middle", "yoke"]
    twists = reduced.frames[2].twists
    assert (
        f") = {fortran_number(twists.flat[np.abs(twists).argmax()])}"
        in text.partition("node = 3")[2].partition("psi")[2]
    )
    assert main(["sid", str(path), "--body", "rad"]) == 2
    assert 'did you mean "rod"?' in capsys.readouterr().err
