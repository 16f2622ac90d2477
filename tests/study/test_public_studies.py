"""The public functions of studies: their arguments are the options of the commands, which call them."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import derive
from derive.cli.arguments.command_line import parser
from derive.cli.arguments.keywords import keywords
from derive.study.methods.failures import failures
from strict_html import Page

STUDIES: dict[str, tuple[list[str], Callable[..., Any]]] = {
    "accuracy": (["study", "accuracy", "SPEC"], derive.study_accuracy),
    "stability": (["study", "stability", "SPEC", "--parameter", "P=0:1:2"], derive.study_stability),
    "methods": (["study", "methods", "SPEC"], derive.study_methods),
    "frames": (["study", "frames", "SPEC"], derive.study_frames),
    "pivots": (["study", "pivots", "SPEC"], derive.study_pivots),
    "choose": (["choose", "SPEC"], derive.choose),
}
OF_PYTHON = {"progress", "record"}
"""The arguments that have no option."""
OF_COMMANDS = {"command", "study", "spec", "json", "no_cache", "out", "chart", "set", "parameter"}
"""The options that files and terminals need, and those whose arguments have a place in the call."""


@pytest.mark.parametrize("name", STUDIES)
def test_options_are_the_arguments_with_their_defaults(name: str) -> None:
    command, function = STUDIES[name]
    options = parser().parse_args(command)
    assert isinstance(options, argparse.Namespace)
    parameters = inspect.signature(function).parameters.values()
    defaults = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY and p.name not in OF_PYTHON}
    given = {key: tuple(x) if isinstance(x, list) else x for key, x in keywords(function, options).items()}
    assert given == defaults
    assert {*vars(options)} - OF_COMMANDS == {*defaults}


PENDULUM = derive.scene(
    "pendulum",
    gravity=(0, -9.81),
    ground={"hub": [0, 0]},
    bodies={"rod": {"mass": 1, "inertia": 0.1, "markers": {"top": [0, 0.5]}, "start": {"angle": 1.5}}},
    joints={"hub": {"kind": "revolute", "between": ["ground.hub", "rod.top"]}},
    simulation={"duration": 1, "output": 0.01},
)
ARM = derive.scene(
    "arm",
    parameters={"P": {"unit": "N", "default": 0}},
    ground={"hub": [0, 0]},
    bodies={"arm": {"mass": 1, "length": 1, "bending_stiffness": 1, "markers": {"root": -1, "tip": 1}}},
    joints={"hub": {"kind": "weld", "between": ["ground.hub", "arm.root"]}},
    forces={"load": {"at": "arm.tip", "components": ["-P", 0]}},
    outputs={"tip": {"kind": "position", "marker": "arm.tip"}},
    plots={"height": {"y": "tip_1"}},
    simulation={"duration": 0.3, "output": 0.01},
)


@pytest.fixture(scope="module")
def methods() -> Iterator[tuple[Any, list[str]]]:
    lines: list[str] = []
    yield derive.study_methods(PENDULUM, integrators=["rk4"], steps=500, states=3, progress=lines.append), lines


def page_of(study: Any) -> Page:
    page = Page(study._repr_html_())
    assert page.faults == [] and study._repr_html_() == study._repr_html_()
    return page


def test_a_study_of_methods_is_shown_with_its_chart_and_tables(methods: tuple[Any, list[str]]) -> None:
    study, lines = methods
    assert lines[0] == "pendulum: deriving and compiling ..."
    assert 1 <= len(repr(study).splitlines()) <= 5
    page = page_of(study)
    assert page.count("svg") == 1 and {run.label for run in study.drifts} <= {*page.words["td"]}
    frame = study.to_pandas()
    assert list(frame.columns) == ["failure", "criterion", "measured", "agrees"] and len(frame) == len(failures(study))


@pytest.mark.long
def test_a_study_of_stability_is_shown_with_its_chart_and_its_losses() -> None:
    study = derive.study_stability(ARM, ("P", 2, 3.5, 2), shapes=[2], pieces=[], sines=[])
    assert study.reference.loss == pytest.approx(2.4674, abs=1e-3)  # pi^2 / 4
    assert 1 <= len(repr(study).splitlines()) <= 5
    page = page_of(study)
    assert page.count("svg") == 1 and "+22 %" in page.words["td"]
    assert len(page.words["tr"] if "tr" in page.words else page.values("tr")) <= 24
    frame = study.to_pandas()
    assert {2.0, 3.5} <= {*frame["parameter"]} and frame["grows"].any()


@pytest.mark.long
def test_studies_of_frames_and_pivots_are_shown_and_convert_to_data_frames() -> None:
    lines: list[str] = []
    frames = derive.study_frames(ARM, pieces=[1], runs=1, progress=lines.append)
    assert page_of(frames).count("svg") == 1 and len(repr(frames).splitlines()) <= 5 and lines
    assert list(frames.to_pandas()["frame"]) == ["mean", "point", "ratio"]
    pivots = derive.study_pivots(ARM, states=5, numberings=2)
    assert "matched" in page_of(pivots).words["td"] and len(repr(pivots).splitlines()) <= 5
    assert {*pivots.to_pandas()["order"]} == {*pivots.rows[0].frames[0].broken}


@pytest.mark.long
def test_accuracy_and_choice_are_shown_and_convert_to_data_frames() -> None:
    study = derive.study_accuracy(ARM, orders=["first"], shapes=[2], pieces=[], sines=[1], runs=1)
    assert page_of(study).count("svg") == 1 and len(repr(study).splitlines()) <= 5
    assert len(study.to_pandas()) == sum(len(line.points) for line in study.lines)
    choice = derive.choose(ARM, error=0.05)
    page = page_of(choice)
    assert choice.chosen is not None and choice.chosen[0].label in page.words["td"]
    assert choice.chosen_scene is not None and choice.chosen_scene.simulation is not None
    assert choice.chosen_scene.simulation.tolerance == choice.chosen[1].tolerance
