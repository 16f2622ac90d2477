"""The cost of second order in operations of the generated functions; bench/order_cost.py has all frames and shapes."""

from __future__ import annotations

from functools import cache

import pytest

import beams
import derive
from derive.roles import Source


@cache
def model(frame: str, n: int, terms: str = "") -> derive.Model:
    """A beam of order 2 with these terms, or of order 1."""
    order = {"order": 2, "terms": terms} if terms else {}
    return derive.lower(derive.derive(beams.beam(frame, n, markers={}, **order)))


def operations(frame: str, n: int, terms: str = "") -> tuple[int, int]:
    """The operations of M and h together, and of the accelerations."""
    kernels = model(frame, n, terms)
    return kernels.kernel("mass_force").operations, kernels.kernel("accel").operations


@pytest.mark.parametrize("n", range(1, 7))
def test_truncated_beams_in_the_mean_frame_cost_little_more_than_beams_of_first_order(n: int) -> None:
    """M stays diagonal, and the N moments int rho X . Psi_nn are part of C5, which first order has as C5 = c8.

    The accelerations take a product and a change of sign more for a shape: in first order the centrifugal forces on the
    shapes cancel c8.
    """
    assert operations("mean", n, "truncated")[0] == operations("mean", n)[0]
    more = operations("mean", n, "truncated")[1] - operations("mean", n)[1]
    assert more == 2 * n
    pattern = model("mean", n, "truncated").pattern("mass", "M")
    assert pattern.full_nnz == n + 3
    numbers, first = (numbers_read(model("mean", n, terms)) for terms in ("truncated", ""))
    assert numbers - first == n


def numbers_read(of: derive.Model) -> int:
    """The constants that M and h read."""
    return len({c.name for c in of.constants} & of.kernel("mass_force").used)


COST = {
    ("mean", 1, "full"): (51, 57),
    ("mean", 2, "full"): (212, 247),
    ("chord", 2, "truncated"): (64, 147),
    ("chord", 4, "truncated"): (140, 293),
    ("chord", 2, "full"): (297, 391),
    ("point", 2, "truncated"): (64, 147),
    ("point", 4, "truncated"): (140, 293),
    ("point", 2, "full"): (317, 411),
    ("tangent", 2, "truncated"): (86, 178),
    ("tangent", 4, "truncated"): (208, 431),
    ("tangent", 2, "full"): (377, 471),
}
"""M and h, and the accelerations, as they are today; a smaller number is progress and is written here."""


@pytest.mark.parametrize(("frame", "n", "terms"), COST)
def test_operations_at_second_order(frame: str, n: int, terms: str) -> None:
    assert operations(frame, n, terms) == COST[frame, n, terms]


FIRST = {
    ("mean", 2): (18, 19),
    ("mean", 4): (42, 43),
    ("chord", 2): (37, 42),
    ("chord", 4): (75, 86),
    ("point", 2): (37, 41),
    ("point", 4): (75, 85),
    ("tangent", 2): (47, 62),
    ("tangent", 4): (103, 138),
}


@pytest.mark.long
@pytest.mark.parametrize(("frame", "n"), FIRST)
def test_a_body_of_first_order_pays_nothing(frame: str, n: int) -> None:
    """Its counts are those that it had before there was a second order, and none of its numbers belongs to that."""
    assert operations(frame, n) == FIRST[frame, n]
    assert operations(frame, n)[0] <= COST.get((frame, n, "truncated"), FIRST[frame, n])[0]
    for order, expected in ((1, False), (2, True)):
        derived = derive.derive(beams.beam(frame, n, markers={}, order=order)).expanded()
        origins = {item.equation for group in (derived.coefficients, derived.terms) for item in group}
        assert (Source.SECOND_ORDER in origins) is expected


def test_shapes_that_are_given_cost_what_the_frame_costs_whose_conditions_they_fulfil() -> None:
    given = derive.planar_beam("given", ansatz=["xi^2 - 1", "xi^3 - xi"], frame="given")
    kernels = derive.lower(derive.derive(given))
    assert kernels.kernel("mass_force").operations == operations("chord", 2)[0]
