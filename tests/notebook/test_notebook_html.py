"""The HTML of objects in notebooks that need no compiler: specifications, equations, models, registries, studies."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import beams
import derive
from derive.notebook.html import MODULES, html
from derive.notebook.parts import LARGEST_PLAYER, MOST_ROWS, player, table
from derive.study.sweep.outputs import Statistic, SweepOutput
from strict_html import Page

SCENES = Path(__file__).parents[2] / "scenes"
HOSTILE = "<script>alert('1')</script>&\"<b>"


def shown(thing: object) -> Page:
    """The HTML that a notebook shows of an object: well-formed, without scripts, and the same each time."""
    text: str = thing._repr_html_()  # type: ignore[attr-defined]
    assert text == thing._repr_html_()  # type: ignore[attr-defined]
    page = Page(text)
    assert page.faults == []
    assert not page.count("script")
    return page


def words(page: Page) -> str:
    """All texts of a page."""
    return " ".join("".join(some) for some in page.words.values())


@pytest.mark.parametrize("frame", ["mean", "point"])
def test_equations_are_shown_row_by_row(frame: str) -> None:
    equations = beams.made(frame, 2).equations
    page = shown(equations)
    assert page.count("math") >= sum(1 for _ in equations.rows)
    assert equations.doc.split(",")[0] in words(page)
    titles = page.values("title")
    assert all(f"{term.name} term, {term.equation}" in titles for term in equations.terms)


def test_a_model_is_shown_with_its_pattern_and_its_functions() -> None:
    model = beams.made("mean", 2).model
    page = shown(model)
    assert page.count("svg") == 1
    assert f"{model.pattern('mass', 'M').full_nnz} of {len(model.velocities) ** 2} entries" in words(page)
    cells = page.words["td"]
    assert all(kernel.name in cells and str(kernel.operations) in cells for kernel in model.kernels)


def test_equations_of_a_generic_shape_are_shown() -> None:
    spec = derive.symbolic_body("any_body", 8, lowering="loops")
    assert "i" in shown(derive.derive(spec)).words["mi"]
    assert "any_body" in words(shown(spec))


def test_a_scene_is_shown_as_its_drawing_and_tables_of_its_members() -> None:
    scene = derive.read(SCENES / "crank_slider_3.toml")
    page = shown(scene)
    assert page.count("svg") == 1
    members = (*scene.bodies, *scene.joints, *scene.drives, *scene.plots)
    assert all(member.name in page.words["td"] for member in members)
    assert "beam in 3 pieces" in page.words["td"]
    assert "joint crank_bearing, speed 150" in page.words["td"]  # and no key that has its default


@pytest.mark.parametrize("name", ["free_beam_mean", "block", "body_symbolic"])
def test_a_body_alone_is_shown_with_its_keys(name: str) -> None:
    spec = derive.read(SCENES / f"{name}.toml")
    page = shown(spec)
    assert spec.name in words(page)
    assert {"frame", "modes"} & set(page.words["td"])


def test_a_mechanism_is_typeset_with_its_constraints_and_alike_bodies_once() -> None:
    mechanism = derive.derive(derive.read(SCENES / "crank_slider_3.toml"))
    page = shown(mechanism)
    equations = mechanism.expanded()
    labels = [text for text in page.values("aria-label") if text]
    rows = 5 + 1  # of one piece of the rod, and of the slider
    constraints = 2 + 2 + 3  # of the crank pin, the slider pin and one cut
    assert len(labels) == rows + constraints
    assert "rod_2, rod_3" in page.words["td"]
    assert all(e.reason in page.words["td"] for e in equations.eliminated)


def test_a_large_mechanism_shows_the_equations_of_its_kinds() -> None:
    scene = derive.read(Path(__file__).parents[2] / "examples/chain_100.toml")
    mechanism = derive.derive(scene)
    page = shown(mechanism)
    assert "and 99 more, before joints" in words(page)
    assert len(page.values("aria-label")) == 4  # c1, c2, phi and a generic shape


def test_texts_of_a_specification_are_data() -> None:
    scene = derive.read(SCENES / "crank_slider_3.toml")
    bodies = tuple(replace(body, name=HOSTILE) if body.kind == "rigid" else body for body in scene.bodies)
    joints = tuple(replace(joint, name=HOSTILE, kind=HOSTILE) for joint in scene.joints)
    drive = replace(scene.drives[0], name=HOSTILE, joint=HOSTILE)
    changed = replace(scene, name=HOSTILE, joints=joints, drives=(drive,), plots=())
    for hostile in (replace(changed, drives=(), joints=()), replace(scene, bodies=bodies, joints=(), drives=())):
        page = shown(hostile)
        assert HOSTILE in words(page)
    model = replace(beams.made("mean", 2).model, name=HOSTILE, doc=HOSTILE)
    assert words(shown(model)).count(HOSTILE) == 2
    equations = replace(beams.made("mean", 2).equations, doc=HOSTILE)
    assert HOSTILE in words(shown(equations))
    cells = Page(table((HOSTILE,), [(HOSTILE,)])).words
    assert cells["th"] == cells["td"] == [HOSTILE]


def test_a_player_is_a_page_within_a_frame_that_reaches_nothing_else() -> None:
    page = Page(player(f"<!doctype html><p>{HOSTILE}</p>", HOSTILE))
    assert page.faults == []
    assert not page.count("script")
    assert page.values("sandbox") == ["allow-scripts"]
    assert page.values("title") == [HOSTILE]
    assert page.values("srcdoc") == [f"<!doctype html><p>{HOSTILE}</p>"]
    large = Page(player("x" * (LARGEST_PLAYER + 1), "t"))
    assert not large.count("iframe")
    assert "1.5 MB" in words(large)


def test_long_tables_say_how_many_rows_are_missing() -> None:
    page = Page(table(("n",), [(n,) for n in range(MOST_ROWS + 7)]))
    assert page.count("td") == MOST_ROWS
    assert "and 7 more rows" in words(page)
    assert table(("n",), []) == ""


@pytest.mark.parametrize("registry", [derive.JOINTS, derive.SPATIAL_SPRINGS, derive.INTEGRATORS, derive.OUTPUTS])
def test_registries_list_their_members(registry: derive.registry.Registry) -> None:
    assert set(registry) <= set(shown(registry).words["td"])


def test_a_sweep_is_shown_with_its_picture_and_its_extremes() -> None:
    samples = derive.grid({"EI": [1.0, 2.0, 3.0]})
    outputs = (SweepOutput(Statistic.PEAK, "s", "m"),)
    values = np.array([[4.0], [5.0], [np.nan]])
    result = derive.SweepResult(HOSTILE, samples, outputs, values, {2: HOSTILE}, {}, {}, 1, 1, {"EI": "N m^2"})
    page = shown(result)
    assert page.count("svg") == 1
    assert page.words["td"][-5:] == ["peak_s", "4", "EI = 1", "5", "EI = 2"]
    assert f"1 sample: {HOSTILE}" in page.words["li"]


def test_every_type_that_has_html_is_known() -> None:
    """A public type with `_repr_html_` has a function; anything else is an error that names the types."""
    known = {of for module in MODULES for of in import_module(f"derive.notebook.{module}").WRITERS}
    types = [of for name in derive.__all__ if isinstance(of := getattr(derive, name), type)]
    with_html = {of for of in types if hasattr(of, "_repr_html_")}
    assert len(with_html) >= 15
    assert all(any(base in known for base in of.__mro__) for of in with_html)
    assert all(hasattr(of, "_repr_html_") for of in known)
    with pytest.raises(TypeError, match=r"Trajectory.*not int"):
        html(1)


def test_functions_of_time_are_shown_as_they_are_written() -> None:
    ground, rod = {"hub": [0, 0]}, {"mass": 1, "inertia": 1, "markers": {"top": [0, 1]}}
    hinge = {"kind": "revolute", "between": ["ground.hub", "rod.top"]}
    push = {"at": "rod.top", "components": [0, "2*sin(t)"]}
    scene = derive.scene("swing", ground=ground, bodies={"rod": rod}, joints={"hub": hinge}, forces={"push": push})
    motor = {"joint": "hub", "motion": "t - sin(2*t)"}
    driven = derive.scene("driven", ground=ground, bodies={"rod": rod}, joints={"hub": hinge}, drives={"motor": motor})
    assert "motion t - sin(2*t)" in words(shown(driven))
    assert "components [0, 2*sin(t)]" in words(shown(scene))
