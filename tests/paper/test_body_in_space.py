"""(1), (5), (6), (14), and (16)-(19) as the tool uses them in space, against the printed ones."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array

from derive.mechanics.bodies.beam_functions import polynomial
from derive.mechanics.bodies.reference_conditions import conditions
from derive.mechanics.motion.kinematics import PHI, RDDOT, RDOT, R, add
from derive.mechanics.motion.material_points import MaterialPoint, marker, vector_at
from derive.mechanics.motion.spatial import rotation_of, spatial_motion, symbols_of_rotation
from derive.reduction.frames import modes_in_frame, rigid_fields
from derive.spec.model.beam_parts import Frame
from derive.spec.model.body import BodyFrame
from paper import printed, printed_continuum
from plain_symbols import plain, vector

Q = plain(symbols_of_rotation())
MOTION = spatial_motion(2)
AT = {R: vector("r"), RDOT: vector("rdot"), RDDOT: vector("rddot"), PHI: vector("Phi")}
OMEGA, OMEGADOT = sp.Matrix(sp.symbols("omega1:4")), sp.Matrix(sp.symbols("omega1dot omega2dot omega3dot"))
C, CDDOT = sp.Matrix(sp.symbols("c1:4")), sp.Matrix(sp.symbols("c1ddot c2ddot c3ddot"))
NOTHING = sp.zeros(3, 1)


def test_place_of_a_material_point_is_1_with_14() -> None:
    X, shapes = vector("X"), (vector("Phi1"), vector("Phi2"))
    point = MaterialPoint("P", "", sp.ImmutableMatrix(X), tuple(map(sp.ImmutableMatrix, shapes)))
    found = marker(MOTION, point)
    local = {d.symbol: d.expr for d in found.definitions}
    u = printed_continuum.displacement_14(sp.symbols("alpha1:3"), shapes)
    assert (plain(found.position.xreplace(local)) - printed_continuum.position_1(C, Q, X, u)).expand() == NOTHING


def test_acceleration_in_space_is_5() -> None:
    found = plain(vector_at(MOTION, MOTION.acceleration, AT))
    stated = printed.acceleration_5(CDDOT, Q, OMEGA, OMEGADOT, AT[R], AT[RDOT], AT[RDDOT])
    assert (found - stated).expand() == NOTHING


def test_virtual_displacement_in_space_is_6() -> None:
    delta_c, delta_pi, delta_alpha = vector("delta_c"), vector("delta_pi"), sp.Symbol("delta_alpha")
    amounts = (*delta_c, *delta_pi, delta_alpha)
    units = (*MOTION.translations, *MOTION.frame.rotations(), MOTION.frame.deformation())
    field = add(*({f: t * a for f, t in unit.items()} for a, unit in zip(amounts, units, strict=True)))
    stated = printed.virtual_displacement_6(delta_c, Q, delta_pi, AT[R], delta_alpha * AT[PHI])
    assert (plain(vector_at(MOTION, field, AT)) - stated).expand() == NOTHING


def test_18_is_a_small_turn_of_the_rotation_tensor() -> None:
    chi, e, X = sp.Symbol("chi"), vector("e"), vector("X")
    turn = rotation_of((sp.cos(chi / 2), *(sp.sin(chi / 2) * e)))
    small = chi * (turn * X).diff(chi).subs(chi, 0)
    assert (small - printed_continuum.rotation_18(chi, e, X)).expand() == NOTHING


# A body of nodes: what the frames make of modes that were thrown together.


def cloud(seed: int = 16) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Masses, positions and two fields of displacements."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 2, 7), rng.uniform(-1, 1, (7, 3)), rng.uniform(-1, 1, (2, 7, 3))


def as_matrices(rows: np.ndarray) -> list[sp.Matrix]:
    return [sp.Matrix([sp.Float(float(x), 20) for x in row]) for row in rows]


def size(vector: sp.Matrix) -> float:
    return max(abs(float(x)) for x in vector)


def held(kind: str, node: int | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Masses, positions from O and the fields of the cloud, brought to a frame."""
    masses, x, phi = cloud()
    shapes = modes_in_frame(csr_array(diags_array(masses)), x, phi, np.eye(2), BodyFrame(kind, node))
    return masses, shapes.x, shapes.phi


def test_rigid_fields_of_nodes_are_18() -> None:
    _, x, _ = cloud()
    for axis, fields in zip(as_matrices(np.eye(3)), rigid_fields(x)[3:], strict=True):
        for place, displacement in zip(as_matrices(x), as_matrices(fields), strict=True):
            assert size(printed_continuum.rotation_18(1, axis, place) - displacement) < 1e-15


def test_a_node_that_holds_the_frame_meets_16() -> None:
    _, _, phi = held("point", 4)
    _, _, loose = cloud()
    for mode, before in zip(phi, loose, strict=True):
        assert size(printed_continuum.held_16(as_matrices(mode)[4])) < 1e-15
        assert size(printed_continuum.held_16(as_matrices(before)[4])) > 0.01


@pytest.mark.parametrize("at", [Fraction(0), Fraction(1, 2), Fraction(-1)])
def test_a_point_of_the_beam_meets_16(at: Fraction) -> None:
    """The first condition of a point frame is the value of each power of xi there."""
    first, _ = conditions(Frame("point", at))
    for n in range(5):
        shape = sp.Matrix([0, sp.Rational(at) ** n, 0])
        assert first.on(polynomial([0] * n + [1])) == printed_continuum.held_16(shape)[1]


def test_modes_in_the_mean_frame_meet_17_and_19() -> None:
    """The modes of the cloud do not meet them before; fields that do are left as they are."""
    masses, x, phi = held("mean")
    weights, places = [sp.Float(float(m), 20) for m in masses], as_matrices(x)
    for mode, before in zip(phi, cloud()[2], strict=True):
        for rows, small in ((mode, True), (before, False)):
            field = as_matrices(rows)
            left = printed_continuum.mean_displacement_17(weights, field)
            turned = printed_continuum.mean_rotation_19(weights, places, field)
            assert (size(left) < 1e-14, size(turned) < 1e-14) == (small, small)
    again = modes_in_frame(csr_array(diags_array(masses)), x, phi, np.eye(2), BodyFrame("mean"))
    assert np.abs(again.phi - phi).max() < 1e-14


def test_mean_conditions_of_the_beam_are_17_and_19() -> None:
    """int rho dOmega = m/2 int dxi: each condition on a power of xi is the mean of it, up to a factor, by Gauss."""
    displacement, rotation = conditions(Frame("mean"))
    nodes, weights = np.polynomial.legendre.leggauss(6)
    mass = 3
    masses = [sp.Float(mass * w / 2, 20) for w in weights]
    places = as_matrices(np.outer(nodes, [0.5, 0, 0]))  # X = xi l/2 e1 with l = 1
    for n in range(6):
        power = polynomial([0] * n + [1])
        field = as_matrices(np.outer(nodes**n, [0, 1, 0]))
        assert abs(displacement.on(power) / 2 - printed_continuum.mean_displacement_17(masses, field)[1]) < 1e-14
        assert abs(mass * rotation.on(power) / 4 - printed_continuum.mean_rotation_19(masses, places, field)[2]) < 1e-14


def test_modes_of_free_vibration_meet_17_and_19() -> None:
    """The modes are those of masses with springs between all of them."""
    masses, x, _ = cloud(19)
    n = len(masses)
    stiffness = np.zeros((n, 3, n, 3))
    for a in range(n):
        for b in range(a):
            arm = (x[a] - x[b]) / np.linalg.norm(x[a] - x[b])
            block = np.outer(arm, arm)
            for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                stiffness[i, :, j] += sign * block
    squares, modes = eigh(stiffness.reshape(3 * n, 3 * n), np.diag(np.repeat(masses, 3)))
    assert np.abs(squares[:6]).max() < 1e-12 and squares[6] > 0.01
    weights, places = [sp.Float(float(m), 20) for m in masses], as_matrices(x)
    for mode in modes.T[6:]:
        field = as_matrices(mode.reshape(n, 3))
        assert size(printed_continuum.mean_displacement_17(weights, field)) < 1e-12
        assert size(printed_continuum.mean_rotation_19(weights, places, field)) < 1e-12
