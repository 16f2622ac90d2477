"""Dependent constraints are named, and distinguished from a dead centre."""

from __future__ import annotations

import compiled
import numpy as np
import pytest
from double import Body, Double, Motion, Pin
from mechanisms import CRANK, ROD, crank_slider, four_bar, pendulum, pushed_crank

from constraint_analysis import analyse_constraints
from derive.roles import Role
from derive.simulation.compiled_scene import coordinates_with
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.errors import MasslessMotion, RedundantConstraints, SingularConfiguration

NONE = np.zeros(0)


def test_a_mechanism_with_independent_constraints_passes() -> None:
    for model, q, _ in (pendulum(), crank_slider(), crank_slider(angle=2.0), four_bar(2)):
        found = analyse_constraints(model, NONE, 0.0, q)
        assert (found.rank, found.dependent) == (model.nlambda, ())
        assert found.smallest > 0.1
        check_constraints(model, NONE, 0.0, q)


def test_a_constraint_that_is_there_twice_is_named_with_its_twin() -> None:
    model, q, _ = crank_slider(extra=(Pin("rail", None, (0, 0), "slider", (0, 0), components=(1,)),))
    found = analyse_constraints(model, NONE, 0.0, q)
    assert (found.count, found.rank) == (10, 9)
    with pytest.raises(RedundantConstraints, match="rail_2 is implied by guide_2") as error:
        check_constraints(model, NONE, 0.0, q)
    assert [(d.name, d.on) for d in error.value.redundant] == [("rail_2", ("guide_2",))]


@pytest.mark.parametrize(("bars", "redundant"), [(3, 1), (4, 2)])
def test_a_bar_too_many_is_redundant_in_every_position(bars: int, redundant: int) -> None:
    model, q, _ = four_bar(bars)
    with pytest.raises(RedundantConstraints) as error:
        check_constraints(model, NONE, 0.0, q)
    found = error.value.redundant
    assert len(found) == redundant
    assert all(d.name not in other.on for d in found for other in found)
    kept = [i for i, name in enumerate(model.multipliers) if name not in {d.name for d in found}]
    G = np.reshape(model.constraint_jacobian(0, q, NONE), (model.nq, model.nlambda)).T
    assert np.linalg.matrix_rank(G[kept]) == np.linalg.matrix_rank(G) == len(kept)


def test_a_slider_that_is_pushed_in_line_is_at_a_dead_centre() -> None:
    model, q, _ = pushed_crank(CRANK + ROD, -1.0)
    with pytest.raises(SingularConfiguration, match="dead centre") as error:
        check_constraints(model, NONE, 0.0, q)
    assert error.value.smallest < 1e-7
    assert set(error.value.multipliers) == {"bearing_1", "crank_pin_1", "slider_pin_1", "push"}
    model, q, _ = pushed_crank(CRANK + ROD - 1e-3, -1.0)
    check_constraints(model, NONE, 0.0, q)


@pytest.mark.parametrize(
    "motion",
    [
        (lambda t: 0.45 * np.cos(t), lambda t: -0.45 * np.sin(t), lambda t: -0.45 * np.cos(t)),
        (lambda t: 0.45 - t**2, lambda t: -2 * t, lambda t: -2.0),
    ],
)
def test_a_drive_that_begins_to_move_at_a_dead_centre(motion: Motion) -> None:
    """At rest no constraint changes with time; a little later it does, and the mechanism is not singular there."""
    model, q, _ = pushed_crank(CRANK + ROD, 0.0, motion)
    with pytest.raises(SingularConfiguration):
        check_constraints(model, NONE, 0.0, q)


def test_a_drive_that_stands_still_at_a_dead_centre_has_to_be_named_as_a_drive() -> None:
    model, q, _ = pushed_crank(CRANK + ROD, 0.0)
    with pytest.raises(SingularConfiguration):
        check_constraints(model, NONE, 0.0, q, drives=["push"])


def test_a_crank_as_long_as_the_rod_is_singular_where_it_folds() -> None:
    """PHYSICS section 4: det ~ l2 cos(phi2), zero at a crank angle of 90 degrees if l1 = l2."""
    model, q, _ = crank_slider(crank=0.3, rod=0.3, angle=np.pi / 2)
    with pytest.raises(SingularConfiguration):
        check_constraints(model, NONE, 0.0, q)
    smallest = [
        analyse_constraints(*(m := crank_slider(crank=0.3, rod=0.3, angle=np.pi / 2 - e))[:1], NONE, 0.0, m[1]).smallest
        for e in (1e-2, 1e-3)
    ]
    assert smallest[0] / smallest[1] == pytest.approx(10, rel=0.02)


def test_the_scale_of_units_does_not_matter() -> None:
    """Lengths in mm: the same singular values."""
    model, q, _ = crank_slider(angle=0.5)
    small, q_small, _ = crank_slider(crank=CRANK * 1e-3, rod=ROD * 1e-3, angle=0.5)
    small.diagonal[2::3] *= 1e-6
    expected = analyse_constraints(model, NONE, 0.0, q).smallest
    assert analyse_constraints(small, NONE, 0.0, q_small).smallest == pytest.approx(expected, rel=1e-9)


def test_a_driven_crank_needs_no_mass() -> None:
    """Constraints say all about its motion, and their singular values are not those of a crank of next to no mass."""
    model, q, _ = crank_slider(angle=0.5)
    expected = analyse_constraints(model, NONE, 0.0, q).smallest
    model.diagonal[:3] = 0.0
    found = analyse_constraints(model, NONE, 0.0, q)
    assert found.rank == 9 and 0.2 < found.smallest / expected < 5
    check_constraints(model, NONE, 0.0, q)


def test_a_body_without_inertia_that_can_turn_is_told() -> None:
    model = Double((Body("bob", 1.0, 0.0),), (Pin("pin", None, (0, 0), "bob", (0, 0)),))
    with pytest.raises(MasslessMotion, match="bob_phi"):
        check_constraints(model, NONE, 0.0, np.zeros(3))


def test_coordinates_are_selected_by_their_roles() -> None:
    """The names of a scene say nothing here: a body may be called phi."""
    native = compiled.crank_slider(1).native
    assert native.coordinates == ("rod_c1", "rod_c2", "rod_phi", "rod_alpha1", "rod_alpha2", "slider_s")
    assert coordinates_with(native, Role.ROTATION).tolist() == [False, False, True, False, False, False]
    rigid = ~coordinates_with(native, Role.AMPLITUDE)
    assert rigid.tolist() == [True, True, True, False, False, True]
