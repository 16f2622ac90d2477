"""A mass with inertia at the tip of a beam, attached to it or a rigid body that is welded there: one and the same."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from made import close, make
from scipy.optimize import brentq

import derive
from derive.simulation.compiled_scene import constraint_matrix
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

MASS, INERTIA = 0.8, 0.03

ROD = """
name = "tip_mass"
ground.markers = {{ wall = [0, 0] }}
[bodies.rod]
frame = {frame}
ansatz = {shapes}
orthogonal = true
mass = 1
length = 1
bending_stiffness = 1
pieces = {pieces}
markers = {{ root = -1, inside = 0.4, tip = 1 }}
"""
FRAMES = ['"mean"', '"chord"', '{ kind = "tangent", at = -1 }', '{ kind = "point", at = 0.5 }']
WELDED = f"""
[bodies.weight]
mass = {MASS}
inertia = {INERTIA}
markers = {{ centre = [0, 0] }}
[joints.weld]
kind = "weld"
between = ["rod.tip", "weight.centre"]
"""
ATTACHED = f"""
[bodies.rod.masses.weight]
at = 1
mass = {{ symbol = "mt", default = {MASS} }}
inertia = {{ symbol = "Jt", default = {INERTIA} }}
"""
CLAMP = """
[joints.clamp]
kind = "fixed"
between = ["ground.wall", "rod.root"]
"""


def rod(mass: str, frame: str = FRAMES[0], pieces: int = 1, more: str = "", shapes: int = 6) -> Scene:
    ansatz = [f"xi^{n}" for n in range(shapes + 2)]
    return parse(ROD.format(frame=frame, pieces=pieces, shapes=ansatz) + mass + more)


def exact(b: float) -> float:
    """Zero at b = (m l^3 w^2/EI)^(1/4): w'' = J w^2 w' and w''' = - M w^2 w at the tip of w(x), clamped at 0."""
    c, s, ch, sh = np.cos(b), np.sin(b), np.cosh(b), np.sinh(b)
    first = ((ch + c) - INERTIA * b**3 * (sh + s), (sh + s) - INERTIA * b**3 * (ch - c))
    second = ((sh - s) + MASS * b * (ch - c), (ch + c) + MASS * b * (sh - s))
    return first[0] * second[1] - first[1] * second[0]


@pytest.mark.long
@pytest.mark.parametrize(
    ("mass", "frame"),
    [
        pytest.param(WELDED, FRAMES[2], marks=pytest.mark.long),
        (ATTACHED, FRAMES[2]),
        pytest.param(ATTACHED, FRAMES[0], marks=pytest.mark.long),
    ],
)
def test_the_frequencies_are_those_of_a_cantilever_with_a_mass_at_its_tip(mass: str, frame: str) -> None:
    made = make(rod(mass, frame, more=CLAMP), complete=True)
    native, (k, start) = made.native, made.start()
    n, rest = native.nq, np.concatenate([start.q, np.zeros(native.nv + native.nlambda)])
    dae = native.dae["index3"]
    still, moving = (dae.pattern.dense(dae.jacobian(0.0, rest, 0 * rest, cj, k)) for cj in (0.0, 1.0))
    free = scipy.linalg.null_space(constraint_matrix(native, 0.0, start.q, k))
    M = free.T @ (moving - still)[n : 2 * n, n : 2 * n] @ free
    K = free.T @ still[n : 2 * n, :n] @ free
    found = np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True))
    expected = [brentq(exact, low, high) ** 2 for low, high in ((0.5, 2.0), (2.0, 4.5))]
    np.testing.assert_allclose(found[:2], expected, rtol=1e-5)


ENERGY = """
[scene]
gravity = [1.5, -9.81]
[outputs]
energy = { kind = "energy" }
"""
OUTPUTS = f"""{ENERGY}
tension = {{ kind = "axial_force", section = "rod.inside" }}
shear = {{ kind = "shear_force", section = "rod.inside" }}
moment = {{ kind = "bending_moment", section = "rod.inside" }}
tip_tension = {{ kind = "axial_force", section = "rod.tip" }}
tip_shear = {{ kind = "shear_force", section = "rod.tip" }}
tip_moment = {{ kind = "bending_moment", section = "rod.tip" }}
"""


STRETCHING = 'axial = { ansatz = ["xi", "xi^2"], stiffness = 50 }\n'


def both(frame: str, pieces: int, bent: float, terms: str = "", keys: str = "") -> list[tuple[np.ndarray, np.ndarray]]:
    """Accelerations of the rod, outputs and momentum with an attached and with a welded mass.

    In a random state of a free rod that spins; bent: the size of its amplitudes; terms: those of a rod of order 2;
    keys: more keys of the rod.
    """
    more, outputs, shapes = (f'order = 2\nterms = "{terms}"\n{keys}', ENERGY, 2) if terms else ("", OUTPUTS, 3)
    one, other = (make(rod(more + mass, frame, pieces, outputs, shapes)).native for mass in (ATTACHED, WELDED))
    rng = np.random.default_rng(pieces)
    q, v = rng.uniform(-1, 1, one.nq), rng.uniform(-3, 3, one.nv)
    of_shapes = np.array(["alpha" in name for name in one.coordinates])
    q[of_shapes] *= bent
    v[of_shapes] *= min(1.0, 20 * bent)
    k, k_welded = one.setup(), other.setup()
    # The rigid body is where the section is: its position, and the rotation of the tip by the slopes of the shapes.
    assert other.coordinates[: one.nq] == one.coordinates and other.nq == one.nq + 3
    tip, tipdot = (np.append(x, 0.0) for x in one.marker("rod_tip", q, v, k)[:2])
    q_welded, v_welded = np.append(q, tip), np.append(v, tipdot)
    weld = [name.startswith("weld") for name in other.multipliers]
    turn = np.flatnonzero(weld)[-1]
    q_welded[-1] = -other.constraints(0.0, q_welded, k_welded)[turn]
    v_welded[-1] = -other.constraint_rates(0.0, q_welded, v_welded, k_welded)[turn]
    assert np.abs(other.constraints(0.0, q_welded, k_welded)[weld]).max() < 1e-14
    vdot, lam = one.solve(0.0, q, v, k)
    vdot_welded, lam_welded = other.solve(0.0, q_welded, v_welded, k_welded)
    found = one.evaluate_outputs(0.0, q, v, vdot, lam, k)
    expected = other.evaluate_outputs(0.0, q_welded, v_welded, vdot_welded, lam_welded, k_welded)
    momentum = one.momentum(q, v, k), other.momentum(q_welded, v_welded, k_welded)
    return [(vdot, vdot_welded[: one.nv]), (found, expected), momentum]


@pytest.mark.parametrize(
    ("frame", "pieces"),
    [
        (FRAMES[0], 2),
        *(pytest.param(frame, 1, marks=pytest.mark.long) for frame in FRAMES[1:]),
    ],
)
def test_an_attached_mass_moves_like_a_welded_one(frame: str, pieces: int) -> None:
    accelerations, outputs, momentum = both(frame, pieces, 0.05)
    close(*accelerations, 1e-11)
    close(*outputs, 1e-11)
    close(*momentum, 1e-13)


@pytest.mark.long
def test_an_attached_mass_moves_like_a_welded_one_at_second_order() -> None:
    """Exactly if nothing is truncated."""
    accelerations, energies, momentum = both(FRAMES[2], 1, 0.05, "full")
    close(*accelerations, 1e-10)
    close(*energies, 1e-12)
    close(*momentum, 1e-12)


@pytest.mark.long
def test_a_truncated_mass_on_a_rod_that_stretches_has_energy_and_momentum_to_second_order() -> None:
    """The tip turns by -v' u' as well, with the inertia of the mass: what is truncated falls with the third power.

    Accelerations need not agree: from a state out of equilibrium the rod stretches with an acceleration that is not
    small, as truncated equations take it to be.
    """
    large, small = (both(FRAMES[0], 1, bent, "truncated", STRETCHING) for bent in (1e-2, 1e-3))
    for of_large, of_small in zip(large[1:], small[1:], strict=True):
        errors = [np.abs(found - expected).max() for found, expected in (of_large, of_small)]
        assert 0 < errors[1] < 0.0015 * errors[0]


def test_a_truncated_mass_is_right_to_second_order() -> None:
    """A welded body has the whole displacement of the tip; what is truncated falls with the square of the bending."""
    large, small = (both(FRAMES[0], 1, bent, "truncated") for bent in (1e-2, 1e-3))
    for of_large, of_small in zip(large, small, strict=True):
        errors = [np.abs(found - expected).max() for found, expected in (of_large, of_small)]
        assert 0 < errors[1] < 0.015 * errors[0]


def test_a_mass_at_a_cut_belongs_to_one_piece_and_equal_pieces_share_their_constants() -> None:
    scene = rod(ATTACHED.replace("at = 1", "at = 0"), pieces=3)
    assert [name for name in constants(scene) if name.endswith("_c8_1_1")] == ["rod_c8_1_1", "rod_2_c8_1_1"]
    with_cut = constants(rod(ATTACHED.replace("at = 1", "at = 0"), pieces=2))
    assert (with_cut["rod_1_mass"], with_cut["rod_mass"]) == ("mt + 1/2", "1/2")


def constants(scene: Scene) -> dict[str, str]:
    """The constants of the bodies, by their printed names."""
    return {str(c.symbol): str(c.value) for c in derive.derive(scene).expanded().coefficients}


def test_zeros_that_masses_leave_have_a_reason_and_those_that_they_fill_have_none() -> None:
    """In the mean frame P2, P3 and a mass at their zeros, at the middle, or at the end."""
    shapes = {"ansatz": ["1", "xi", "xi^2", "xi^3"], "mass": 1, "length": 2, "bending_stiffness": 1}

    def zeros(at: float, inertia: float = 0) -> dict[str, str | None]:
        mass = {"at": at, "mass": {"symbol": "mt", "default": 1}, "inertia": inertia}
        equations = derive.derive(derive.planar_beam("b", masses={"one": mass}, **shapes)).expanded()
        return {str(c.symbol): c.zero for c in equations.coefficients}

    bare = derive.derive(derive.planar_beam("b", **shapes)).expanded()
    diagonal = {str(c.symbol) for c in bare.coefficients if c.zero}
    assert {"c1_1", "c2_1_2", "c2_2_2", "c6_1", "c6_2", "c8_1_2"} < diagonal
    assert not any(zeros(1)[name] for name in ("c1_1", "c2_1_2", "c2_2_2", "c6_1", "c6_2", "c8_1_2"))
    middle = zeros(0)  # P2 is -1/2 there, and P3 and the slope of P2 vanish
    assert middle["c2_1_2"] is None
    assert (
        middle["c2_2_2"] == "condition (17) (no mean displacement) and a zero of the integrand at the attached masses"
    )
    assert middle["c1_1"] and middle["c6_1"] and middle["c8_1_2"]
    assert not any(name.startswith("R_") for name in middle)
    turning = zeros(0, inertia=1)
    assert turning["R_1_1"] == turning["R_1_2"] == "these shapes (no slope at the attached masses)"
    assert turning["R_2_2"] is None and turning["c6_2"] is None


WRONG = {
    "at = 2": "bodies.rod.masses.weight.at: xi = 2 is not on the beam",
    "at = 1\nmas = 2": 'bodies.rod.masses.weight.mas: unknown key; did you mean "mass"',
    "inertia = 2": "bodies.rod.masses.weight.at: this key is missing; write at = 1",
    "at = 1": "bodies.rod.masses.weight.mass: this key is missing; write mass = 0.5",
    "at = 1\nmass = 0": "bodies.rod.masses.weight.mass: a positive number is needed, not 0",
    "at = 1\nmass = 1\ninertia = -1": "bodies.rod.masses.weight.inertia: zero or a positive number is needed",
    'at = 1\nmass = { symbol = "EI", default = 2 }\n[bodies.rod.damping]\nstiffness = { symbol = "EI", default = 3 }': (
        '"EI" is the symbol of stiffness in the damping of the body rod, with the unit s, not kg'
    ),
}


@pytest.mark.parametrize("text", WRONG)
def test_masses_that_cannot_be_are_refused(text: str) -> None:
    with pytest.raises(derive.SpecError) as caught:
        rod(f"[bodies.rod.masses.weight]\n{text}\n")
    assert WRONG[text] in str(caught.value)
