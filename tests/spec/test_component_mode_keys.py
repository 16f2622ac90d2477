"""The keys of component modes: what is refused in one line each, what Python writes back, and what `build` prints."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import derive
from derive.derivation import reduced_bodies
from derive.notes.body_notes import body_notes, notes_on_flexible_bodies
from derive.spec.set_values import with_values
from spring_lattice import lattice

MARKERS = {"left": {"nodes": [0, 1, 2, 3]}, "right": {"nodes": [8, 9, 10, 11]}, "a": 0, "b": 11, "middle": 5}


def scene(**keys: Any) -> derive.SpatialScene:
    """A scene with a lattice of two bays."""
    body = {"nodes": lattice(2), "units": "SI", "markers": MARKERS, **keys}
    return derive.spatial_scene("scene", bodies={"truss": body})


@pytest.mark.parametrize(
    ("keys", "path", "text"),
    [
        ({"modes": 5, "interface": ["left", "right"]}, "modes", "write modes = 6 or more"),
        ({"modes": 11, "interface": ["left", "right"], "component_modes": "attachment"}, "modes", "modes = 12 or more"),
        ({"modes": 6, "interface": ["left", "rihgt"]}, "interface[1]", 'did you mean "right"?'),
        ({"modes": 6, "interface": ["left", "left"]}, "interface[1]", "name it once"),
        ({"modes": 6, "interface": ["left"], "component_modes": "free"}, "interface", "free modes have no interface"),
        ({"modes": 6, "component_modes": "craig_bampton"}, "component_modes", "need an interface"),
        ({"modes": 6, "interface": ["left"], "order": 2}, "order", "or elements with materials and a stiffness"),
    ],
)
def test_what_does_not_go_together_is_one_line(keys: dict[str, Any], path: str, text: str) -> None:
    with pytest.raises(derive.SpecError) as raised:
        scene(**keys)
    wrong = [problem for problem in raised.value.problems if problem.path == f"bodies.truss.{path}"]
    assert text in wrong[0].message
    assert "\n" not in wrong[0].message


def test_every_wrong_name_of_an_interface_is_a_line_and_no_number_of_modes_follows_from_them() -> None:
    with pytest.raises(derive.SpecError) as raised:
        scene(modes=0, interface=["lfet", "right", "right", "rihgt"])
    assert [problem.path for problem in raised.value.problems] == [f"bodies.truss.interface[{i}]" for i in (0, 2, 3)]


def test_no_mode_of_an_interface_misses_every_deflection() -> None:
    """Held at one set of nodes a body needs no static mode."""
    (whole,) = [note for note in notes_on_flexible_bodies(scene(modes=0, interface=["left"])) if "deflections" in note]
    assert "within 100 % of those by the full matrices" in whole


def test_an_interface_without_markers_is_none() -> None:
    """As `--set bodies.truss.interface=[]` writes it, beside component_modes=free or alone."""
    crane = scene(modes=8, interface=["left", "right"])
    free, _ = with_values(crane, {"bodies.truss.interface": "[]", "bodies.truss.component_modes": "free"})
    assert (free.bodies[0].body.component_modes, free.bodies[0].body.interface) == ("free", ())
    assert scene(modes=8, interface=[]).bodies[0].body.component_modes is None


@pytest.mark.parametrize("names", [["a"], ["a", "b"]])
def test_an_interface_on_a_line_is_refused(names: list[str]) -> None:
    with pytest.raises(derive.SpecError, match=r"bodies\.truss\.interface: .* add a marker beside it") as raised:
        reduced_bodies(scene(modes=8, interface=names))
    assert len(raised.value.problems) == 1


def test_markers_that_share_their_nodes_are_refused() -> None:
    arrays = {"nodes": lattice(2), "units": "SI", "modes": 8, "interface": ["one", "two"]}
    markers = {"one": {"nodes": [0, 1, 2, 3]}, "two": {"nodes": [0, 1, 2, 3], "weights": [1, 1, 1, 1]}}
    with pytest.raises(derive.SpecError, match="share nodes"):
        reduced_bodies(derive.spatial_scene("scene", bodies={"truss": {**arrays, "markers": markers}}))


def test_the_keys_are_those_of_a_body_alone_too_and_are_written_back() -> None:
    own = derive.nodal_body(
        "truss", lattice(2), units="SI", modes=4, interface=["a", "b", "middle"], markers={"a": 0, "b": 11, "middle": 5}
    )
    assert own.component_modes == "craig_bampton"
    assert [marker.nodes for marker in own.interface_markers] == [(0,), (11,), (5,)]
    assert "Craig-Bampton modes of the interface a, b, middle" in derive.modal(own).doc
    assert derive.modal(own).c8 == pytest.approx(np.eye(4), abs=1e-12)
    assert replace(derive.validated(own), data=own.data) == own
    in_scene = scene(modes=7, interface=["right", "middle"], component_modes="craig_bampton")
    body, again = in_scene.bodies[0].body, derive.validated(in_scene).bodies[0].body
    assert replace(again, data=body.data) == body


def test_build_prints_what_each_mode_is_beside_the_full_matrices() -> None:
    notes = notes_on_flexible_bodies(scene(modes=8, interface=["left", "right"]))
    rows = [note.split() for note in notes if note.startswith("truss:   mode ")]
    assert [row[2] for row in rows] == [f"{i}:" for i in range(1, 9)]
    assert {row[3] for row in rows} == {"static", "vibration"}
    assert all(float(row[4]) >= 0.9999 * float(row[7]) > 0 for row in rows)


def test_modes_of_files_are_not_left_out_in_silence() -> None:
    corners = np.array([[1.0, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]])
    breathing = [corners / 8**0.5]
    stiffness = 100 * np.outer(breathing, breathing)
    nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "stiffness": stiffness}
    body = derive.nodal_body("square", nodes, units="SI", modes=1, component_modes="free")
    assert any("the 1 mode of the files is left out" in note for note in body_notes(body))
    assert not any("left out" in note for note in body_notes(derive.nodal_body("square", nodes, units="SI")))
