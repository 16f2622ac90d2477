"""The tables of component modes in the reports of a body and of a scene."""

from __future__ import annotations

import derive
from derive.reduction.component_mode_table import component_mode_table
from derive.report.document.formula import NumberToken
from derive.report.document.page import Block, Inline, Math, TableBlock
from derive.report.sections.component_modes import component_mode_blocks, component_modes_of_scene
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_bodies import FlexibleBody
from spring_lattice import lattice


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
    assert shown(component_modes_of_scene(scene)[-1]) == (f"truss: {caption}", rows)
    assert shown(component_mode_blocks(body)[-1]) == (caption, rows)


def test_a_body_without_an_interface_has_no_table_of_component_modes() -> None:
    scene = scene_with("free")
    assert component_modes_of_scene(scene) == component_mode_blocks(body_of(scene)) == ()
