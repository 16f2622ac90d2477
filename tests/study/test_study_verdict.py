"""The verdict follows the numbers: other numbers, other words."""

from __future__ import annotations

from dataclasses import replace

import made_up
import pytest
from made_up import FINE, in_frame, worse

from derive.study.verdict import conclusion, judge, verdict

BAD = replace(FINE, without_diagonal=3, failures=37, smallest=0.0, growth=float("inf"), backward_error=float("inf"))


def said(mean: dict[str, object], point: dict[str, object], *broken: dict[str, float]) -> str:
    some = broken or ({}, {})
    return "\n".join(verdict(in_frame("mean", mean, some[0]), in_frame("point", point, some[1])))


def test_it_holds_in_part_where_one_order_fails_in_one_frame() -> None:
    text = said(
        {"constrained": FINE, "unconstrained": FINE},
        {"constrained": FINE, "unconstrained": BAD},
        {},
        {"unconstrained": 1.0},
    )
    assert "more stable with the order unconstrained, not substantially different with constrained." in text
    assert "100 % in the point frame (here 3 multipliers come before all of their coordinates)" in text
    assert "Minimum degree takes first" in text


def test_it_does_not_hold_where_nothing_differs() -> None:
    text = said(
        {"constrained": FINE, "unconstrained": FINE}, {"constrained": worse(growth=50), "unconstrained": worse(error=5)}
    )
    assert "does not hold here: the zeros make no substantial difference" in text
    assert "Minimum degree" not in text and "no pivot vanishes in either frame" in text


def test_it_holds_where_every_order_is_substantially_better() -> None:
    assert "conjecture holds here: with every order" in said({"constrained": FINE}, {"constrained": worse(error=50)})
    below_rounding = {"constrained": replace(FINE, backward_error=1e-17)}
    assert "does not hold here" in said(below_rounding, {"constrained": replace(FINE, backward_error=5e-16)})


def test_it_may_be_the_other_way_round() -> None:
    text = said(
        {"constrained": FINE, "markowitz": FINE},
        {"constrained": FINE, "markowitz": FINE},
        {"markowitz": 0.4},
        {"markowitz": 0.1},
    )
    assert "does not hold here: the mean frame is nowhere substantially more stable, and less so" in text
    assert "some pivot vanishes in 40 % in the mean frame and in 10 % in the point frame: substantially" in text
    gained = [judge(order, *sorted_frames()) for order in ("constrained", "markowitz", "unconstrained")]
    assert [j.gain for j in gained] == [0, -1, 1]
    assert "substantially less stable with markowitz" in conclusion(gained, sorted_frames()[0].frame)


def sorted_frames():
    orders = {"constrained": FINE, "markowitz": FINE, "unconstrained": FINE}
    return in_frame("mean", orders, {"markowitz": 0.4}), in_frame("point", orders, {"unconstrained": 0.5})


def test_what_is_told_besides_follows_the_numbers() -> None:
    mean, point = in_frame("mean", {"constrained": FINE}), in_frame("point", {"constrained": FINE})
    text = "\n".join(verdict(mean, point))
    assert "M has 240 zeros of 256 in the mean frame, 210 in the point frame" in text
    assert "of its other 16 and 46 entries 0 and 18 vanish" in text
    assert "about the same in the mean frame" in text and "594 operations against 802 (-26 %)" in text
    worse_here = replace(mean, simulated=replace(mean.simulated, condition=5e6), undeformed=point.undeformed)
    assert "5.0 times larger in the mean frame" in "\n".join(verdict(worse_here, point))


def test_it_does_not_matter_which_frame_comes_first() -> None:
    mean, point = in_frame("mean", {"constrained": FINE}), in_frame("point", {"constrained": worse(error=50)})
    assert verdict(mean, point) == verdict(point, mean)


def test_equal_frames_say_nothing() -> None:
    one = in_frame("mean", {"constrained": FINE})
    assert verdict(one, replace(one, frame="chord")) == [
        "Both frames have equally many zeros in M: of these the conjecture says nothing."
    ]
    assert made_up.SPARSE.mass < made_up.FULL.mass


@pytest.mark.parametrize(("share", "gain"), [(0.08, 0), (0.12, 1)])
def test_shares_that_differ_by_a_tenth_differ_substantially(share: float, gain: int) -> None:
    orders = {"constrained": FINE}
    assert (
        judge("constrained", in_frame("mean", orders), in_frame("point", orders, {"constrained": share})).gain == gain
    )


@pytest.mark.parametrize(("factor", "gain"), [(8.0, 0), (12.0, 1)])
def test_errors_that_differ_by_a_factor_of_ten_differ_substantially(factor: float, gain: int) -> None:
    frames = in_frame("mean", {"constrained": FINE}), in_frame("point", {"constrained": worse(error=factor)})
    assert judge("constrained", *frames).gain == gain
