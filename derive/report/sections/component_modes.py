"""The component modes of finite-element bodies: what each is made of, and its frequency beside the exact one."""

from __future__ import annotations

from collections.abc import Sequence

from derive.notes.body_notes import alike_bodies
from derive.notes.component_mode_notes import COMPONENT_MODES
from derive.percentages import percent
from derive.report.document.formula import NumberToken
from derive.report.document.page import Block, Heading, Paragraph, TableBlock, table
from derive.report.sections.instance_rows import enumeration_of_instances
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

TEXT = (
    "Static modes are deformations by loads or displacements of the interface; vibration modes are natural modes. "
    "Combined and orthonormalised, each mode counts by the larger part of its strain energy. Its frequency is that of "
    "the free body by these modes; beside it is that by the full mass and stiffness matrices, the limit for many "
    "modes. Deflections are those at unit forces and moments of the interface, balanced by the inertia forces of a "
    "rigid acceleration, without the mean displacement and rotation of the body."
)


def component_mode_blocks(spec: NodalBody) -> tuple[Block, ...]:
    """The component modes of a body; none if it has no interface."""
    return _section([_table(spec), _deflections(spec)] if spec.interface_markers else [])


def component_modes_of_scene(scene: AnyScene) -> tuple[Block, ...]:
    """The component modes of the finite-element bodies of a scene, once for bodies that are alike."""
    bodies = alike_bodies(scene) if isinstance(scene, SpatialScene) else {}
    held = [(body, enumeration_of_instances(names)) for body, names in bodies.items() if body.interface_markers]
    return _section([part(body, f"{names}: ") for body, names in held for part in (_table, _deflections)])


def _section(tables: Sequence[TableBlock]) -> tuple[Block, ...]:
    return (Heading("Component modes", "component-modes"), Paragraph((TEXT,)), *tables) if tables else ()


def _table(spec: NodalBody, owner: str = "") -> TableBlock:
    """The table of the modes of a body with an interface."""
    from derive.reduction.component_mode_table import component_mode_table

    assert spec.component_modes is not None  # by check_body: an interface asks for component modes
    rows = [
        (k, row.kind, NumberToken(f"{row.frequency:.5g}"), NumberToken(f"{row.full:.5g}"), row.excess)
        for k, row in enumerate(component_mode_table(spec), 1)
    ]
    kind = COMPONENT_MODES[spec.component_modes].removesuffix(",")
    caption = f"{owner}{kind} of the interface {', '.join(spec.interface)}"
    head = ("mode", "kind", "frequency, Hz", "full matrices, Hz", "error")
    return table(caption[0].upper() + caption[1:] if not owner else caption, head, rows, "rlrrr")


def _deflections(spec: NodalBody, owner: str = "") -> TableBlock:
    """The table of the deflections at unit loads of the interface."""
    from derive.reduction.component_mode_table import interface_deflections

    rows = [
        (row.load, NumberToken(f"{row.own:.5g}"), NumberToken(f"{row.full:.5g}"), percent(row.error))
        for row in interface_deflections(spec)
    ]
    head = ("unit load", "deflection, m/N or rad/(N m)", "full matrices", "error")
    caption = f"{owner}deflections under unit loads of the interface"
    return table(caption if owner else caption[0].upper() + caption[1:], head, rows, "lrrr")
