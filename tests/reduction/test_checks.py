"""All faults of a body are reported at once, each with its remedy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import bodies_of_nodes as bodies
import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from derive.errors import SpecError
from derive.reduction import eigen, reduce
from derive.reduction.frames import rigid_fields
from derive.spec.model.body import BodyFrame, NodalBody
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import NodeMarker


def refused(body: NodalBody) -> dict[str, str]:
    with pytest.raises(SpecError) as caught:
        reduce(body)
    return {problem.path: problem.message for problem in caught.value.problems}


def mass(data: NodeData, change: Callable[[np.ndarray], None]) -> NodeData:
    m = data.mass.toarray()
    change(m)
    return replace(data, mass=csr_array(m))


def coupled(m: np.ndarray) -> None:
    m[2, 5] = m[5, 2] = 3.0


def one_sided(m: np.ndarray) -> None:
    m[2, 5] = 0.1


def negative(m: np.ndarray) -> None:
    m[4, 4] = -0.3


def none_but_coupled(m: np.ndarray) -> None:
    m[3, 3] = 0
    m[3, 1] = m[1, 3] = 0.01


def nothing(m: np.ndarray) -> None:
    m[:] = 0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (coupled, ["indefinite", "a pivot is -", "node"]),
        (one_sided, ["not symmetric", "both of its halves"]),
        (negative, ["the mass of node 4 is negative (-0.3 kg)"]),
        (none_but_coupled, ["a node without mass is coupled"]),
        (nothing, ["the mass of all nodes is 0 kg; it has to be positive"]),
    ],
)
def test_mass(change: Callable[[np.ndarray], None], words: list[str]) -> None:
    message = refused(bodies.nodal(mass(bodies.cloud(2), change)))["body.nodes"]
    assert all(word in message for word in words), message


def test_mass_that_is_only_just_positive_is_not_refused() -> None:
    data = bodies.cloud(2)
    root = np.random.default_rng(0).uniform(-1, 1, (10, 8))
    assert reduce(bodies.nodal(replace(data, mass=csr_array(root @ root.T)))).mass > 0


@pytest.mark.parametrize(
    ("at", "words"), [([0, 0, 0], "all mass is in one point"), ([1, 2, 3], "all mass is on one line")]
)
def test_no_moment_of_inertia(at: list[float], words: str) -> None:
    data = bodies.cloud(2)
    data = replace(data, positions=np.outer(np.arange(10.0), at) + 0.3)
    assert words in refused(bodies.nodal(data))["body.nodes"]


def test_frame_and_markers_at_once() -> None:
    data = bodies.cloud(2)
    x = data.positions.copy()
    x[4], x[6] = x[3] + [0.1, 0, 0], x[3] + [0.2, 0, 0]
    body = bodies.nodal(replace(data, positions=x), BodyFrame("point", 3, (4, 6)), markers=(NodeMarker("tip", 10),))
    found = refused(body)
    assert found["body.frame"].startswith("nodes 4, 6 are on one line with node 3")
    assert found["body.markers.tip"] == "there is no node 10; nodes are 0 .. 9"
    assert "there is no node 11" in refused(replace(body, frame=BodyFrame("point", 11)))["body.frame"]
    assert "there is no node 12" in refused(replace(body, frame=BodyFrame("point", 3, (1, 12))))["body.frame"]
    assert reduce(replace(body, frame=BodyFrame("point", 3), markers=())).modes == 2


@pytest.mark.parametrize("frame", [bodies.MEAN, bodies.GIVEN, BodyFrame("point", 2)])
def test_rigid_motion_is_named(frame: BodyFrame) -> None:
    data = bodies.cloud(3)
    turn = rigid_fields(data.positions)[4]
    modes = np.array([data.modes[0], turn + 2 * data.modes[0], data.modes[1]])
    found = refused(bodies.nodal(replace(data, modes=modes), frame))["body.modes"]
    assert found.startswith("rigid motion is left in the modes (singular value ")
    assert "mode 1" in found and "mode 2" in found and "mode 3" not in found and found.endswith("; remove one of them")


def test_each_rigid_motion_is_named() -> None:
    data = bodies.cloud(3)
    modes = np.concatenate([rigid_fields(data.positions)[[1, 5]], data.modes[:1]])
    with pytest.raises(SpecError) as caught:
        reduce(bodies.nodal(replace(data, modes=modes)))
    assert len(caught.value.problems) == 2 and all("rigid motion" in p.message for p in caught.value.problems)


def test_dependent_modes_and_modes_without_mass() -> None:
    data = bodies.cloud(3)
    modes = data.modes.copy()
    modes[2] = 3 * modes[0] - modes[1]
    found = refused(bodies.nodal(replace(data, modes=modes)))["body.modes"]
    assert found.startswith("the modes are dependent") and all(f"mode {i}" in found for i in (1, 2, 3))
    modes = data.modes.copy()
    modes[1] = 0
    assert refused(bodies.nodal(replace(data, modes=modes)))["body.modes"] == "modes that move no mass: 2; remove them"


def test_number_of_modes() -> None:
    data, springs = bodies.cloud(2), bodies.truss((2, 2, 2))
    assert "3 modes are requested, but 2 are given" in refused(bodies.nodal(data, modes=3))["body.modes"]
    found = refused(bodies.nodal(springs, modes=19))["body.modes"]
    assert found == "19 modes are too many: nodes with mass allow 18 elastic modes and 6 rigid motions"
    assert "give the number of modes" in refused(bodies.nodal(springs))["body.modes"]
    assert "0 or more" in refused(bodies.nodal(springs, modes=-1))["body.modes"]


def test_stiffness_that_is_missing_or_says_two_things() -> None:
    data = bodies.truss()
    without = replace(data, stiffness=None)
    assert "a stiffness to compute them from" in refused(bodies.nodal(without, modes=2))["body.nodes"]
    modes = bodies.cloud(2, 24).modes
    assert "modes need modal_stiffness" in refused(bodies.nodal(replace(without, modes=modes)))["body.nodes"]
    both = replace(data, modes=modes, modal_stiffness=np.eye(2))
    assert "modal_stiffness is not Phi^T K Phi" in refused(bodies.nodal(both))["body.nodes"]
    k = reduce(bodies.nodal(replace(both, modal_stiffness=None), bodies.GIVEN, orthonormal=False)).stiffness
    assert np.array_equal(reduce(bodies.nodal(replace(both, modal_stiffness=k))).c8, np.eye(2))


@pytest.mark.parametrize("dense", [True, False])
def test_stiffness_that_is_not_of_a_free_body(dense: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(eigen, "MAX_DENSE_SIZE", 10_000 if dense else 0)
    data = bodies.truss((4, 3, 3), seed=1)
    k = data.stiffness.toarray()
    k[3, 3] += 30
    tied = refused(bodies.nodal(replace(data, stiffness=csr_array(k)), modes=4))["body.nodes"]
    assert "resists rigid motion" in tied and "tied to the ground" in tied
    wrong = refused(bodies.nodal(replace(data, stiffness=csr_array(-data.stiffness)), modes=4))["body.nodes"]
    assert "negative eigenvalue" in wrong
    loose = data.stiffness.toarray()
    loose[9:12] = loose[:, 9:12] = 0
    masses = data.mass.diagonal()
    masses[3] = 0
    bare = replace(data, stiffness=csr_array(loose), mass=csr_array(diags_array(masses)))
    assert "node 3 has neither mass nor stiffness" in refused(bodies.nodal(bare, modes=4))["body.nodes"]
    loose = data.stiffness.toarray()
    loose[3, 5] += 1
    assert "not symmetric" in refused(bodies.nodal(replace(data, stiffness=csr_array(loose)), modes=4))["body.nodes"]


def test_given_modes_with_a_stiffness_that_pushes() -> None:
    data = bodies.cloud(2)
    found = refused(bodies.nodal(replace(data, modal_stiffness=np.diag([3.0, -2.0]))))["body.nodes"]
    assert "negative eigenvalue in the modes (-" in found and "mode 2" in found


def test_arrays_that_do_not_fit() -> None:
    data = bodies.cloud(2)
    wrong = replace(data, mass=csr_array(np.eye(9)), modes=np.zeros((2, 9, 3)), modal_stiffness=np.full((3, 3), np.nan))
    with pytest.raises(SpecError) as caught:
        reduce(bodies.nodal(wrong))
    assert len(caught.value.problems) == 4 and {p.path for p in caught.value.problems} == {"body.nodes"}


@pytest.mark.parametrize(("change", "accepted"), [(1e-7, True), (1e-5, False)])
def test_a_modal_stiffness_agrees_with_the_stiffness_matrix_to_six_digits(change: float, accepted: bool) -> None:
    data = replace(bodies.truss(), modes=bodies.cloud(2, 24).modes)
    k = reduce(bodies.nodal(data, bodies.GIVEN, orthonormal=False)).stiffness.copy()
    k[0, 1] = k[1, 0] = k[0, 1] + change * np.abs(k).max()
    body = bodies.nodal(replace(data, modal_stiffness=k))
    if accepted:
        assert reduce(body).modes == 2
    else:
        assert "modal_stiffness is not Phi^T K Phi" in refused(body)["body.nodes"]


@pytest.mark.parametrize(("change", "accepted"), [(1e-10, True), (1e-8, False)])
def test_matrices_are_symmetric_to_nine_digits(change: float, accepted: bool) -> None:
    data = bodies.truss()
    k = data.stiffness.toarray()
    k[3, 5] += change * np.abs(k).max()
    body = bodies.nodal(replace(data, stiffness=csr_array(k)), modes=2)
    if accepted:
        assert reduce(body).modes == 2
    else:
        assert "the stiffness matrix is not symmetric" in refused(body)["body.nodes"]


@pytest.mark.parametrize(("change", "accepted"), [(1e-4, True), (1e-6, False)])
def test_modes_that_differ_by_little_are_dependent(change: float, accepted: bool) -> None:
    data = bodies.cloud(2)
    modes = data.modes.copy()
    modes[1] = modes[0] + change * modes[1]
    body = bodies.nodal(replace(data, modes=modes))
    if accepted:
        assert reduce(body).modes == 2
    else:
        assert refused(body)["body.modes"].startswith("the modes are dependent")


@pytest.mark.parametrize(("ratio", "accepted"), [(2e-3, True), (5e-2, False)])
def test_a_body_that_rests_on_soft_springs_has_supports(ratio: float, accepted: bool) -> None:
    """With K + (ratio omega)^2 M, its rigid motions have that part of the lowest elastic frequency omega."""
    data = bodies.truss()
    lowest = float(np.diag(reduce(bodies.nodal(data, modes=1)).stiffness)[0])
    k = data.stiffness + ratio**2 * lowest * diags_array(np.repeat(data.mass.diagonal(), 3))
    body = bodies.nodal(replace(data, stiffness=csr_array(k)), modes=2)
    if accepted:
        assert reduce(body).modes == 2
    else:
        assert "resists rigid motion" in refused(body)["body.nodes"]
