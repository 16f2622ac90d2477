"""The tables of component modes in the reports of a body and of a scene."""

from __future__ import annotations

from dataclasses import replace

import derive
from derive.reduction.component_mode_table import component_mode_table
from derive.report.document.page import Block, Math, TableBlock
from derive.report.sections.component_modes import component_mode_blocks, component_modes_of_scene
from spring_lattice import lattice


def scene_of(*names: str, modes: int = 8, kind: str = "craig_bampton") -> derive.SpatialScene:
    """Lattices that are alike in all but their names, with an interface at both ends."""
    markers = {"left": {"nodes": [0, 1, 2, 3]}, "right": {"nodes": [32, 33, 34, 35]}}
    body = {"nodes": lattice(8), "units": "SI", "modes": modes, "component_modes": kind, "markers": markers}
    body |= {} if kind == "free" else {"interface": ["left", "right"]}
    return derive.spatial_scene("scene", bodies={name: dict(body) for name in names})


def rows(block: Block) -> list[tuple[str, ...]]:
    """The cells of a table as text."""
    assert isinstance(block, TableBlock)
    texts = [[cell.text[0] for cell in row] for row in block.rows]
    return [tuple(t.formula.text if isinstance(t, Math) else str(t) for t in row) for row in texts]


def test_a_report_shows_the_frequencies_of_component_modes_beside_those_of_the_full_matrices() -> None:
    scene = scene_of("a")
    body = scene.bodies[0].body
    heading, _, shown = component_modes_of_scene(scene)
    assert (heading.anchor, shown.caption) == (
        "component-modes",
        "a: Craig-Bampton modes of the interface left, right",
    )
    expected = [
        (str(k), row.kind, f"{row.frequency:.5g}", f"{row.full:.5g}", row.excess)
        for k, row in enumerate(component_mode_table(body), 1)
    ]
    assert rows(shown) == expected
    assert {kind for _, kind, *_ in expected} == {"static", "vibration"}
    alone = component_mode_blocks(replace(body, name="body"))[-1]
    assert rows(alone) == expected
    assert alone.caption == "Craig-Bampton modes of the interface left, right"


def test_a_body_without_an_interface_has_no_table_of_component_modes() -> None:
    assert component_modes_of_scene(scene_of("a", kind="free")) == ()
