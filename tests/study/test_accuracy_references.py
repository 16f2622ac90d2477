"""References of `study accuracy`: their errors, and those that cannot be."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from test_accuracy import TRUNCATED, crank_slider

import derive
from derive.errors import SpecError
from derive.simulation.errors import SimulationError
from derive.spec.model.plots import ColumnCurves, Plot
from derive.spec.model.ports import SceneOutput
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.reference import reference


@pytest.mark.long
def test_a_reference_of_its_own_knows_its_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ever finer models that agree: here two small ones, whose difference is the error."""
    coarse = (LadderModel(Shapes.POLYNOMIALS, 3, TRUNCATED), LadderModel(Shapes.POLYNOMIALS, 4, TRUNCATED))
    monkeypatch.setattr("derive.study.accuracy.reference.refinements", lambda scene: coarse)
    made = reference(crank_slider(), crank_slider().plots[0], None, True, lambda _: None)
    assert made.source == "own run, 1 beam, P2 to P5, truncated"
    assert made.error == pytest.approx(0.00037, rel=0.02) and made.plots[0].reference is not None
    several = Plot("both", ColumnCurves(("slider_s", "rod_phi")))
    curves = reference(crank_slider(), several, None, True, lambda _: None).plots
    assert [plot.quantity.y for plot in curves if isinstance(plot.quantity, ColumnCurves)] == [
        ("slider_s",),
        ("rod_phi",),
    ]
    undamped = replace(crank_slider(), outputs=(SceneOutput("lost", "power"),))
    curves_with_zero = replace(several, quantity=ColumnCurves(("slider_s", "lost_dissipated")))
    lines: list[str] = []
    kept = reference(undamped, curves_with_zero, None, True, lambda _: None, lines.append)
    assert len(kept.plots) == 1 and kept.error is not None and kept.error < 0.01
    assert lines[-1] == "reference: lost_dissipated vanishes all the time; it is not compared"
    nothing = replace(several, quantity=ColumnCurves(("lost_dissipated",)))
    more = (LadderModel(Shapes.RIGID), *coarse)
    monkeypatch.setattr("derive.study.accuracy.reference.refinements", lambda scene: more)
    lines.clear()
    with pytest.raises(SpecError, match="vanishes all the time"):
        reference(undamped, nothing, None, True, lambda _: None, lines.append)
    assert len(lines) == 1  # two models show it, of which the second has no line
    file = reference(crank_slider(), crank_slider().plots[0], 1e-3, False, lambda _: None)
    assert (file.source, file.error) == ("crank_slider_A.csv", 1e-3)


@pytest.mark.long
@pytest.mark.parametrize(("enough", "finest"), [(0.0016, "P2 to P4"), (0.001, "P2 to P5")])
def test_two_models_that_clearly_agree_are_a_reference(
    monkeypatch: pytest.MonkeyPatch, enough: float, finest: str
) -> None:
    """The second and the third differ by 0.037 %, and the first two are said to do so as well."""
    models = tuple(LadderModel(Shapes.POLYNOMIALS, count, TRUNCATED) for count in (2, 3, 4))
    monkeypatch.setattr("derive.study.accuracy.reference.refinements", lambda scene: models)
    monkeypatch.setattr("derive.study.accuracy.reference.rms_difference", lambda finer, coarser: 0.00037)
    made = reference(crank_slider(), crank_slider().plots[0], None, True, lambda _: None, enough=enough)
    assert made.source == f"own run, 1 beam, {finest}, truncated"


@pytest.mark.parametrize(("enough", "error"), [(0.02, 0.0125), (0.005, 0.0125 * 9 / 7)], ids=["3 beams", "4 beams"])
def test_the_error_of_a_reference_counts_what_more_pieces_would_change(
    monkeypatch: pytest.MonkeyPatch, enough: float, error: float
) -> None:
    """Errors that fall with the square of the number of beams are larger than the difference of three and four.

    A quarter is added.
    """
    models = tuple(LadderModel(Shapes.POLYNOMIALS, 4, TRUNCATED, "mean", pieces) for pieces in (1, 2, 3, 4))
    moved = SimpleNamespace(solution=SimpleNamespace(cost=SimpleNamespace(seconds=0.1)))
    made_up: dict[str, Any] = {"refinements": models, "opened": None, "motion": moved, "curves_of": (1,)}
    for name, value in {**made_up, "rms_difference": 0.01, "reference_plots": ()}.items():
        monkeypatch.setattr(f"derive.study.accuracy.reference.{name}", lambda *_, value=value: value)
    ahead: Any = SimpleNamespace(expect=list, result=lambda variant: variant)
    made = reference(crank_slider(), crank_slider().plots[0], None, True, lambda _: None, ahead=ahead, enough=enough)
    assert made.error == pytest.approx(error)


def test_a_reference_that_joints_do_not_permit_is_named() -> None:
    """The chord of the rod keeps its length as it bends, and so the scene runs; the models of a reference do not."""
    rod = {"mass": 1, "length": 1, "bending_stiffness": 20, "frame": "chord", "markers": {"a": -1, "m": 0, "b": 1}}
    held = derive.scene(
        "held",
        gravity=(0, -9.81),
        ground={"a": [0, 0], "b": [1, 0]},
        bodies={"rod": rod},
        joints={end: {"kind": "revolute", "between": [f"ground.{end}", f"rod.{end}"]} for end in "ab"},
        plots={"sag": {"deflection": "rod.m", "chord": ["rod.a", "rod.b"]}},
        simulation={"duration": 0.05, "output": 0.01},
    )
    with pytest.raises(SimulationError, match=r"cannot be made of 1 beam, P2 to P5, truncated: .* with a table axial"):
        derive.study_accuracy(held, own_reference=True, shapes=[2], pieces=[], sines=[])
