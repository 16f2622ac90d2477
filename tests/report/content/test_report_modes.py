"""The modes in the reports of a body and of a scene: their tables and their moving pictures."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest

import derive
from derive.reduction.body import prepare
from derive.reduction.component_mode_table import component_mode_table, interface_deflections
from derive.report.document.formula import NumberToken
from derive.report.document.page import Block, Inline, Math, Picture, TableBlock
from derive.report.sections.modes import mode_blocks, modes_of_scene
from derive.report.writers.picture import inline
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.visual.convergence_chart import convergence_chart
from spring_lattice import lattice

SVG = "{http://www.w3.org/2000/svg}"


def scene_with(kind: str) -> derive.SpatialScene:
    """A scene of a lattice, with an interface at both ends if its modes are not free ones."""
    markers = {"left": {"nodes": [0, 1, 2, 3]}, "right": {"nodes": [32, 33, 34, 35]}}
    body = {"nodes": lattice(8), "units": "SI", "modes": 8, "component_modes": kind, "markers": markers}
    body |= {} if kind == "free" else {"interface": ["left", "right"]}
    return derive.spatial_scene("scene", bodies={"truss": body})


def body_of(scene: derive.SpatialScene) -> NodalBody:
    """The finite-element body of a scene."""
    (body,) = scene.bodies
    assert isinstance(body, FlexibleBody)
    return body.body


def shown(block: Block) -> tuple[str, list[tuple[str, ...]]]:
    """The caption of a table, and its cells as text."""
    assert isinstance(block, TableBlock)
    return block.caption, [tuple(as_text(cell.text[0]) for cell in row) for row in block.rows]


def tables(blocks: tuple[Block, ...]) -> list[tuple[str, list[tuple[str, ...]]]]:
    """The tables among blocks, as `shown` gives them."""
    return [shown(block) for block in blocks if isinstance(block, TableBlock)]


def as_text(of: Inline) -> str:
    """The text of a cell: words, or a number."""
    if isinstance(of, Math):
        assert isinstance(of.formula, NumberToken)
        return of.formula.text
    assert isinstance(of, str)
    return of


def test_a_report_shows_the_frequencies_of_component_modes_beside_those_of_the_full_matrices() -> None:
    scene = scene_with("craig_bampton")
    body = body_of(scene)
    rows = [
        (str(k), row.kind, f"{row.frequency:.5g}", f"{row.full:.5g}", row.excess)
        for k, row in enumerate(component_mode_table(body), 1)
    ]
    assert {kind for _, kind, *_ in rows} == {"static", "vibration"}
    caption = "Craig-Bampton modes of the interface left, right"
    of_scene, of_body = tables(modes_of_scene(scene)), tables(mode_blocks(body))
    assert of_scene[0] == (f"truss: {caption}", rows)
    assert of_body[0] == (caption, rows)
    deflections = [(row.load, f"{row.own:.5g}", f"{row.full:.5g}") for row in interface_deflections(body)]
    assert [row[:3] for row in of_body[1][1]] == deflections


def test_a_body_without_an_interface_has_no_table_of_component_modes() -> None:
    scene = scene_with("free")
    assert tables(modes_of_scene(scene)) == tables(mode_blocks(body_of(scene))) == []


def test_pictures_of_modes_move_between_opposite_deflections() -> None:
    """Each face goes to and fro between two positions; each of 8 modes has a panel with its frequency."""
    (picture, *_) = (block for block in mode_blocks(body_of(scene_with("free"))) if isinstance(block, Picture))
    root = ElementTree.fromstring(picture.svg)
    panels = root.findall(f"{SVG}g")
    assert len(panels) == 8
    frequencies = np.sqrt(np.diag(prepare(body_of(scene_with("free"))).shapes.stiffness)) / (2 * np.pi)
    assert [panel.findtext(f"{SVG}text") for panel in panels] == [
        f"mode {k}: {f:.5g} Hz" for k, f in enumerate(frequencies, 1)
    ]
    for polygon in panels[0].findall(f"{SVG}polygon"):
        moves = polygon.find(f"{SVG}animate")
        assert moves is not None
        first, opposite, last = moves.attrib["values"].split(";")
        assert first == last == polygon.get("points") != opposite


def test_a_picture_may_move_points_and_nothing_else() -> None:
    """Addresses and events are refused, also in animations."""
    still = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><polygon points="0,0 1,0 0,1">{}</polygon></svg>'
    )
    assert "animate" in inline(still.format('<animate attributeName="points" values="a;b"/>'), "p", "")
    for bad in ('attributeName="href" values="a;b"', 'attributeName="points" onbegin="f()"'):
        with pytest.raises(ValueError, match="a picture holds"):
            inline(still.format(f"<animate {bad}/>"), "p", "")


def test_errors_of_one_decade_have_an_axis_that_can_be_read() -> None:
    """Powers of ten alone would be the single label 10 here; over many decades they are enough."""

    def labels(errors: list[float]) -> list[str]:
        chart = convergence_chart([6, 7, 8, 9], [("frequencies", errors)], "errors")
        texts = [element.text or "" for element in ElementTree.fromstring(chart).iter(f"{SVG}text")]
        return texts[texts.index("number of modes") + 1 : texts.index("largest error, %")]

    assert labels([0.7, 0.69, 0.1, 0.06]) == ["10", "20", "50"]
    assert labels([0.7, 1e-3, 1e-6, 1e-9]) == ["1e-06", "0.0001", "0.01", "1", "100"]
