"""The modes of finite-element bodies as moving surfaces; with an interface what each is made of, and its error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from derive.notes.body_notes import alike_bodies
from derive.notes.component_mode_notes import COMPONENT_MODES
from derive.percentages import percent
from derive.report.document.formula import NumberToken
from derive.report.document.page import Block, Heading, Paragraph, Picture, TableBlock, table
from derive.report.sections.instance_rows import enumeration_of_instances
from derive.short_text import counted
from derive.simulation.observables.spatial_player_data import drawn_body
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.visual.convergence_chart import convergence_chart
from derive.visual.mode_surfaces import MOST_PANELS, mode_surfaces

MOVING = (
    "The surfaces show each mode moving to and fro, all at one pace and to one size, coloured by how far they move."
)
TEXT = (
    " Static modes are deformations by loads or displacements of the interface; vibration modes are natural modes. "
    "Combined and orthonormalised, each mode counts by the larger part of its strain energy. Its frequency is that of "
    "the free body by these modes; beside it is that by the full mass and stiffness matrices, the limit for many "
    "modes. Deflections are those at unit forces and moments of the interface, balanced by the inertia forces of a "
    "rigid acceleration, without the mean displacement and rotation of the body."
)


def mode_blocks(spec: NodalBody) -> tuple[Block, ...]:
    """The modes of a body of nodes; none if it has no modes."""
    return _section([("", spec)])


def modes_of_scene(scene: AnyScene) -> tuple[Block, ...]:
    """The modes of the finite-element bodies of a scene, once for bodies that are alike."""
    bodies = alike_bodies(scene) if isinstance(scene, SpatialScene) else {}
    return _section([(enumeration_of_instances(names), body) for body, names in bodies.items()])


def _section(bodies: Sequence[tuple[str, NodalBody]]) -> tuple[Block, ...]:
    from derive.reduction.body import prepare

    shown = [(owner, spec) for owner, spec in bodies if len(prepare(spec).shapes.phi)]
    if not shown:
        return ()
    held = any(spec.interface_markers for _, spec in shown)
    intro = Paragraph((f"{MOVING}{TEXT if held else ''}",))
    return (Heading("Modes", "modes"), intro, *(block for owner, spec in shown for block in _blocks(spec, owner)))


def _blocks(spec: NodalBody, owner: str) -> tuple[Block, ...]:
    """The pictures of the modes of a body; with an interface also their tables and their convergence."""
    picture = _surfaces(spec, owner)
    if not spec.interface_markers:
        return (picture,)
    named = f"{owner}: " if owner else ""
    return (picture, _table(spec, named), _deflections(spec, named), _convergence(spec, owner))


def _surfaces(spec: NodalBody, owner: str) -> Picture:
    """The moving surfaces of the first modes."""
    from derive.reduction.body import prepare

    drawn, stiffness = drawn_body(spec), np.diag(prepare(spec).shapes.stiffness)
    orthonormal = prepare(spec).orthonormal
    frequencies = np.sqrt(np.maximum(stiffness, 0.0)) / (2 * np.pi)
    captions = [f"mode {k}: {f:.5g} Hz" if orthonormal else f"mode {k}" for k, f in enumerate(frequencies, 1)]
    left_out = len(captions) - MOST_PANELS
    more = f"; {counted(left_out, 'more mode')} not shown" if left_out > 0 else ""
    title = f"Modes of {owner}" if owner else "Modes"
    svg = mode_surfaces(drawn.x, drawn.surface.faces, drawn.phi, captions, title)
    return Picture(svg, f"{title}, as moving surfaces", f"{title}{more}")


def _convergence(spec: NodalBody, owner: str) -> Picture:
    """The largest errors of frequencies and deflections over the number of modes."""
    from derive.reduction.mode_selection import mode_convergence

    found = mode_convergence(spec)
    compared = f"{counted(len(found.frequencies), 'frequency', 'frequencies')} up to {found.frequencies[-1]:.4g} Hz"
    curves = (
        (compared, [float(e.frequency_errors.max()) for e in found.errors]),
        ("deflections at the interface", [float(e.deflection_errors.max()) for e in found.errors]),
    )
    title = f"Errors over the number of modes of {owner}" if owner else "Errors over the number of modes"
    return Picture(convergence_chart(found.counts, curves, title), title, title)


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
