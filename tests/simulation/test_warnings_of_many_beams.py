"""Warnings and messages on many bodies: alike ones are one line, which names the worst and a few others."""

from __future__ import annotations

from dataclasses import replace

import pytest

from derive.enumerations import enumeration
from derive.errors import SpecError
from derive.registry import MOST_LISTED, UnknownNameError
from derive.simulation.validity.monitors import Cause, Monitor, warnings
from derive.spec.model.body import DisplacementOrder
from derive.spec.toml.read import parse

BENT = Monitor("link[0]", 1, Cause.DEFLECTION, DisplacementOrder.FIRST_ORDER, 0.2, 0.06, 0.5)


def test_beams_with_one_remedy_are_one_warning_that_names_the_worst() -> None:
    errors = [0.06, 0.3, 0.07, 0.01, 0.08, 0.09, 0.1]
    monitors = [replace(BENT, beam=f"link[{k}]", error=error) for k, error in enumerate(errors)]
    (warning,) = warnings(monitors)
    assert warning.startswith(
        "link[1] in 1 beam: it bends by 20 % of its length at t = 0.5 s; this implies an error of 30 %"
    )
    assert ", and of 10 % in link[6], 9 % in link[5], 8 % in link[4], 7 % in link[2] and 1 more; divide" in warning


def test_other_causes_and_remedies_have_their_own_lines_and_no_number_is_the_worst() -> None:
    lost = replace(BENT, beam="lost", error=float("nan"))
    second = replace(BENT, beam="second", order=DisplacementOrder.TRUNCATED)
    axial = replace(BENT, beam="axial", cause=Cause.AXIAL_FORCE)
    first, *others = warnings([BENT, second, axial, lost])
    assert first.startswith("lost in 1 beam") and "an error of 100 % or more" in first and "6 % in link[0]" in first
    assert others == [second.warning, axial.warning]
    assert not warnings([replace(BENT, error=0.01)])


@pytest.mark.parametrize(
    ("names", "text"), [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (list("abcd"), "a, b and 2 more")]
)
def test_enumerations(names: list[str], text: str) -> None:
    assert enumeration(names, 3 if len(names) < 4 else 2) == text


def test_unknown_names_list_as_many_as_someone_reads() -> None:
    known = [f"link_{k}" for k in range(MOST_LISTED + 5)]
    assert str(UnknownNameError("column", "x", known)).endswith("link_29 and 5 more")
    assert str(UnknownNameError("column", "x", known[:-5])).endswith("link_28, link_29")


def test_a_plot_without_keys_of_deflections_is_one_of_columns() -> None:
    scene = 'name = "a"\n[bodies.b]\nmass = 1\ninertia = 1\n[simulation]\nduration = 1\noutput = 0.1\n'
    with pytest.raises(SpecError, match=r"plots\.p\.y: this key is missing") as raised:
        parse(scene + '[plots.p]\ncolumns = ["b_phi"]\n')
    assert "deflection" not in str(raised.value)
    with pytest.raises(SpecError, match=r"plots\.p\.deflection: this key is missing"):
        parse(scene + '[plots.p]\nover = "t"\n')
