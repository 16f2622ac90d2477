"""The texts of objects, `repr(...)`: of each public type, of one to five lines that a terminal has room for."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beams
import derive
from derive.short_text import LINES, WIDTH, full_text, listed, number_text, record_text, summary
from derive.spec.toml.read import parse

ROOT = Path(__file__).parents[1]
HOSTILE = "<script>alert(1)</script>"
DEFAULTS = (object.__repr__, dict.__repr__)
ELSEWHERE = {"Role", "RequestedFunctions"}
"""Public types whose text Python makes: that of an Enum is its name, and a base class has no objects of its own."""


def own_text(of: type) -> bool:
    """Whether a type has a text of its own: not that of `object`, nor one that a dataclass lists its fields in."""
    text = of.__repr__
    generated = dataclasses.is_dataclass(of) and getattr(text, "__wrapped__", None) is not None
    return text not in DEFAULTS and not (generated and "__repr__" in of.__dict__)


def test_every_public_type_has_a_text_of_its_own() -> None:
    types = {name: of for name in derive.__all__ if isinstance(of := getattr(derive, name), type)}
    missing = {name for name, of in types.items() if not issubclass(of, Exception) and not own_text(of)}
    # what has a few short fields of its own is listed by its dataclass
    assert missing <= {"Parameter", "MarkerRef", "DrivingForces"} | ELSEWHERE


def parts(value: Any) -> Iterator[Any]:
    """A specification and all frozen types within it."""
    if dataclasses.is_dataclass(value):
        yield value
        for field in dataclasses.fields(value):
            yield from parts(getattr(value, field.name))
    elif isinstance(value, tuple):
        for item in value:
            yield from parts(item)


def checked(shown: object) -> str:
    """The text of an object, which is short."""
    text = repr(shown)
    lines = text.splitlines()
    assert 1 <= len(lines) <= LINES, text
    assert max(map(len, lines)) <= WIDTH, text
    assert "Fraction(" not in text
    return text


@pytest.mark.parametrize("path", sorted((ROOT / "scenes").glob("*.toml")), ids=lambda path: path.stem)
def test_specifications_have_short_texts_with_their_names(path: Path) -> None:
    spec = derive.read(path)
    assert spec.name in checked(spec).splitlines()[0]
    for part in parts(spec):
        checked(part)


def test_a_scene_lists_its_members_by_their_kinds() -> None:
    assert repr(derive.read(ROOT / "scenes/crank_slider_3.toml")).splitlines() == [
        "Scene crank_slider_3: 3 bodies, 4 joints, 1 drive, 1 plot",
        "  bodies      crank (rigid), rod (beam in 3 pieces), slider (rigid)",
        "  joints      crank_bearing, crank_pin, slider_pin (revolute), guide (translational)",
        "  others      motor (drive), deflection (plot)",
        "  simulation  0.1 s, a row every 0.0001 s",
    ]


def test_a_record_shows_what_differs_from_its_defaults() -> None:
    scene = derive.read(ROOT / "scenes/crank_slider_3.toml")
    slider = next(body for body in scene.bodies if body.name == "slider")
    text = " ".join(repr(slider).split())
    assert text == (
        "RigidBody('slider', mass=0.0333779, inertia=1e-06, markers=(pin), start=InitialValues(position=(0.45, 0)))"
    )


def test_texts_of_long_content_are_cut_between_words_and_count_the_rest() -> None:
    names = [f"coordinate_{i}" for i in range(1000)]
    assert listed(names).endswith(" more")
    shown = int(listed(names).split()[-2])
    assert listed(names).count(",") + 1 + shown == 1000
    assert listed(["x" * 200]) == "1 of them"
    text = summary("word " * 60, {f"row {i}": "value" for i in range(9)})
    assert len(text.splitlines()) == LINES
    assert max(map(len, text.splitlines())) <= WIDTH
    assert text.splitlines()[-1] == "  and row 3, row 4, row 5, row 6, row 7, row 8"
    assert number_text(Fraction(1, 3)) == "1/3"
    assert number_text(Fraction(3, 20)) == "0.15"
    assert number_text(Fraction(123456789, 1000000000)) == "0.123457"


def test_the_full_text_of_a_specification_tells_what_its_short_text_leaves_out() -> None:
    text = 'name = "s"\n[ground.markers]\no = [0, 0]\n[bodies.a]\nmass = 1.00000001\ninertia = 1\nmarkers.p = [0, 0]\n'
    one, other = parse(text), parse(text.replace("1.00000001", "1.00000002"))
    assert repr(one) == repr(other)
    assert repr(one.bodies[0]) == repr(other.bodies[0])  # six digits
    assert full_text(one) != full_text(other)
    assert full_text(one) == full_text(parse(text))


def test_derived_and_compiled_objects_have_short_texts() -> None:
    built = beams.made("mean", 2)
    for thing in (built.equations, built.equations.expanded(), built.model):
        assert "c1" in checked(thing)
        assert thing.name in repr(thing)
    files = derive.model_files(built.model, built.spec)
    for file in files:
        assert file.path in checked(file)
    for registry in (derive.JOINTS, derive.SPATIAL_JOINTS, derive.INTEGRATORS, derive.FORCES):
        assert next(iter(registry)) in checked(registry)
    assert "mass from 1 to 3" in checked(derive.grid({"mass": [1, 2, 3]}))


def test_a_text_of_a_hostile_record_stays_in_its_lines() -> None:
    record = derive.PointMarker("a\nb" + HOSTILE * 50, Fraction(1), Fraction(2))
    assert len(record_text(record).splitlines()) == 1
    assert inspect.isfunction(record_text)
    assert "<array 3 x 2>" in repr(derive.NodeData(np.zeros((3, 2)), None, None, None, None, ""))  # type: ignore[arg-type]
