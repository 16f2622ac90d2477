"""Second-order fields from geometric stiffness: against fields at the nodes, and frames against a rigid motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import bodies_of_nodes as bodies
import numpy as np
import pytest
import second_order_bodies as stiff
from scipy.optimize import root

from derive.errors import SpecError
from derive.mechanics.bodies.modal_body import ModalBody
from derive.reduction import reduce
from derive.reduction.body import prepare
from derive.spec.model.body import BodyFrame, DisplacementOrder
from derive.spec.model.node_markers import NodeMarker

NODE = BodyFrame("point", 2, (5, 7, 9))
FRAMES = [bodies.GIVEN, bodies.MEAN, NODE]


def rotation(theta: np.ndarray) -> np.ndarray:
    angle = np.linalg.norm(theta) or 1e-300
    k = np.cross(np.eye(3), theta / angle) * -1
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def motion_into(frame: BodyFrame, mass: np.ndarray, x: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """u' of nodes that are at X + u before, where a rigid motion fulfils the conditions of the frame on u' itself."""

    def moved(u: np.ndarray) -> np.ndarray:
        if frame.kind == "given":
            return u

        def turned(p: np.ndarray) -> np.ndarray:
            return (x + u - p[:3]) @ rotation(p[3:]) - x

        def conditions(p: np.ndarray) -> np.ndarray:
            new = turned(p)
            if frame.kind == "mean":
                weighed = mass @ new
                return np.concatenate([weighed.sum(axis=0), np.cross(x, weighed).sum(axis=0)])
            around = list(frame.around)
            return np.concatenate([new[frame.node], np.cross(x[around], new[around]).sum(axis=0)])

        return turned(root(conditions, np.zeros(6), tol=1e-15).x)

    return moved


def second_derivatives(of: Callable[[np.ndarray], np.ndarray], n: int, h: float = 2e-4) -> np.ndarray:
    """d^2 / da_i da_j at a = 0 by differences, extrapolated."""

    def difference(i: int, j: int, step: float) -> np.ndarray:
        e, f = np.eye(n)[i] * step, np.eye(n)[j] * step
        return (of(e + f) - of(e - f) - of(f - e) + of(-e - f)) / (4 * step**2)

    return np.array([[(4 * difference(i, j, h) - difference(i, j, 2 * h)) / 3 for j in range(n)] for i in range(n)])


def integrals(mass: np.ndarray, x: np.ndarray, phi: np.ndarray, psi: np.ndarray) -> dict[str, np.ndarray]:
    """c9, c10 and the symmetric part of C5 from fields at the nodes."""
    g = np.einsum("ab,ak,ijbl->ijkl", mass, x, psi)
    both = np.einsum("ab,iak,jbl->ijkl", mass, phi, phi) + g
    both = (both + both.swapaxes(-1, -2)) / 2
    return {
        "c9": np.einsum("ab,ijbk->ijk", mass, psi),
        "c10": np.stack([g[..., k - 2, k - 1] - g[..., k - 1, k - 2] for k in range(3)], axis=-1),
        "C5": np.einsum("ijkk->ij", both)[..., None, None] * np.eye(3) - both,
    }


def compare(found: ModalBody, expected: dict[str, np.ndarray], tolerance: float) -> None:
    even = (found.C5 + found.C5.swapaxes(-1, -2)) / 2
    for name, value in {"c9": found.c9, "c10": found.c10, "C5": even}.items():
        assert np.allclose(value, expected[name], rtol=0, atol=tolerance), (name, np.abs(value - expected[name]).max())


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("frame", FRAMES, ids=lambda f: f.kind)
def test_fields_in_the_frame_are_those_of_a_rigid_motion(frame: BodyFrame, full: bool) -> None:
    """The frame follows the deformed body; u' of the nodes, differentiated twice, gives Psi'_ij."""
    n = 3
    body, psi = stiff.stiffened(n, frame, full=full, orthonormal=False)
    found, prepared = reduce(body), prepare(body)
    mass, x, phi = prepared.mass.toarray(), prepared.shapes.x, body.data.modes
    into = motion_into(frame, mass, x)
    new = second_derivatives(lambda a: into(np.tensordot(a, phi, 1) + np.einsum("i,j,ijak->ak", a, a, psi) / 2), n)
    tolerance = 2e-6 if frame.kind != "given" else 1e-12
    points = np.array([point.second for point in found.points]).transpose(1, 2, 0, 3)
    if frame.kind == "given":
        new = psi
    assert np.abs(points - new).max() < tolerance * 10
    compare(found, integrals(mass, x, prepared.shapes.phi, new), tolerance * 50)
    if frame.kind == "mean":
        assert not found.c9.any() and not found.c10.any()
        assert found.zeros["c9_1_2_3"] == "condition (17) at second order (no mean displacement)"
        assert found.zeros["c10_1_2_3"] == "condition (19) at second order (no mean rotation)"


@pytest.mark.parametrize("frame", FRAMES, ids=lambda f: f.kind)
def test_orthonormal_modes_describe_the_same_fields(frame: BodyFrame) -> None:
    raw, new = (reduce(stiff.stiffened(4, frame, orthonormal=flag)[0]) for flag in (False, True))
    shapes = [np.array([p.shapes for p in body.points]).transpose(1, 0, 2).reshape(4, -1) for body in (raw, new)]
    weights = np.linalg.lstsq(shapes[0].T, shapes[1].T, rcond=None)[0].T
    for first, second in zip(raw.points, new.points, strict=True):
        assert np.allclose(second.second, np.einsum("ki,lj,ija->kla", weights, weights, first.second), atol=1e-11)
    for name in ("c9", "c10", "C5"):
        expected = np.einsum("ki,lj,ij...->kl...", weights, weights, getattr(raw, name))
        assert np.allclose(getattr(new, name), expected, atol=1e-10), name


def test_fewer_modes_keep_the_matrices_of_those() -> None:
    body, _ = stiff.stiffened(4, orthonormal=False)
    every, few = reduce(body), reduce(replace(body, modes=2))
    assert np.allclose(few.C5, every.C5[:2, :2], atol=1e-14) and few.points[3].second.shape == (2, 2, 3)


def test_what_is_not_given_is_zero() -> None:
    """K0omega alone: no mean displacement and no moment of Psi_ij, so that the mean frame changes nothing of it."""
    body, _ = stiff.stiffened(3, bodies.GIVEN, orthonormal=False)
    whole = reduce(body)
    alone = replace(body.data, K0t=None, K0r=None, K0F=None, K0F_nodes=None)
    found = reduce(replace(body, data=alone, markers=()))
    assert np.array_equal(found.C5, whole.C5) and not found.c9.any() and not found.c10.any()


def test_first_order_leaves_them_out() -> None:
    body, _ = stiff.stiffened(3)
    found = reduce(replace(body, order=DisplacementOrder.FIRST_ORDER))
    plain = reduce(bodies.nodal(bodies.cloud(3), markers=body.markers))
    assert found.c9 is None and not found.second_order and np.array_equal(found.C5, plain.C5)
    assert found.zeros == plain.zeros and found.points[0].second is None


def faults(**changes: object) -> list[str]:
    body, _ = stiff.stiffened(3)
    markers, frame = changes.pop("markers", body.markers), changes.pop("frame", body.frame)
    with pytest.raises(SpecError) as caught:
        reduce(replace(body, data=replace(body.data, **changes), markers=markers, frame=frame))
    return [f"{problem.path}: {problem.message}" for problem in caught.value.problems]


def test_faults_of_the_matrices() -> None:
    data = stiff.stiffened(3)[0].data
    skew = data.K0t.copy()
    skew[1, 0, 2] += 1
    infinite = data.K0omega.copy()
    infinite[5, 1, 1] = np.nan
    assert faults(K0t=skew, K0r=data.K0r[:2], K0omega=infinite) == [
        "body.nodes: K0t is not symmetric in the modes",
        "body.nodes: K0r of 3 modes is (3, 3, 3), not (2, 3, 3)",
        "body.nodes: K0omega contains values that are not finite",
    ]


def test_nodes_without_forces() -> None:
    data = stiff.stiffened(3)[0].data
    some = {"K0F": data.K0F[3:7], "K0F_nodes": data.K0F_nodes[3:7]}
    marker = (NodeMarker("tip", 2), NodeMarker("mid", 4))
    reason = "is missing, and with it the displacement of second order there; add it with the node to K0F and K0F_nodes"
    assert faults(markers=marker, **some) == [f"body.markers.tip: K0F of node 2 {reason}, or write order = 1"]
    fixed = faults(markers=(), frame=BodyFrame("point", 4, (3, 5, 8)), **some)
    assert fixed == [f"body.frame: K0F of node 8 {reason}, or write order = 1"]


@pytest.mark.parametrize("frame", FRAMES[:2], ids=lambda f: f.kind)
def test_symmetry_of_the_data_gives_zeros(frame: BodyFrame) -> None:
    """A box with mirror planes: fields with its symmetry keep its zeros, others only those of the modes."""
    data = bodies.truss()
    plain = bodies.nodal(data, modes=4, markers=())
    shapes = prepare(plain).shapes
    given = replace(data, modes=shapes.phi, modal_stiffness=shapes.stiffness)
    even = np.einsum("iak,jal->ijakl", shapes.phi, shapes.phi)
    psi = np.einsum("ijakl,al->ijak", (even + even.swapaxes(0, 1)) / 2, data.positions)
    random = stiff.fields(4, len(data.positions))
    keys = {"modes": 4, "markers": (), "order": DisplacementOrder.TRUNCATED}
    found, other = (reduce(bodies.nodal(stiff.with_stiffness(given, field), frame, **keys)) for field in (psi, random))
    first = reduce(replace(plain, frame=frame))
    planes = {name for name, why in first.zeros.items() if why.startswith("mirror") and name.startswith("C5")}
    assert planes and planes <= set(found.zeros) and np.abs(found.C5 - first.C5).max() > 0.01
    assert not any(name in other.zeros for name in planes)
    if frame.kind == "given":
        assert found.zeros["c9_1_2_1"].startswith("mirror") and "c9_1_1_1" not in other.zeros
        names = {name for name in found.zeros if name.startswith(("c9", "c10"))}
        assert 30 < len(names) < 60, len(names)
