"""The picture and the animation of the modes of a model."""

from __future__ import annotations

import numpy as np

from derive.simulation.linear.displaced import displaced, drawn_scene, mode_lines
from derive.simulation.linear.displaced_body import body_displacements, displaced_body
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.motion import Array, body_coordinates
from derive.simulation.observables.player_data import player_data
from derive.simulation.observables.spatial_player_data import (
    DrawnBody,
    bodies_data,
    bodies_motion_data,
    drawn_body,
    path_of,
)
from derive.spec.model.body import NodalBody, SymbolicBody
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_scene import SpatialScene
from derive.visual.mode_shapes import ModePanel, mode_picture
from derive.visual.player import motions_page, spatial_motions_page

PERIODS, FRAMES = 4, 40
"""Periods of an animation, and the instants in a period."""
NOMINAL_PERIOD = 1.0
"""The period (s) at which a mode that does not oscillate is shown."""


VIEW = (0.6, 0.35)
"""The angles (rad) from which a body in space is seen, as in its player: about e3, and above the plane of e1 and e2."""


def is_drawn(modes: Modes, count: int) -> bool:
    """Whether there is a mode to draw, and a model with a geometry: not that of a body with symbolic integrals."""
    return not isinstance(modes.spec, (SymbolicBody, SpatialScene)) and bool(drawn_modes(modes, count))


def modes_picture(modes: Modes, count: int) -> str:
    """The shapes of the first `count` modes as SVG, those of zero eigenvalues apart."""
    title = f"{modes.spec.name}: modes"
    if (drawn := _spatial(modes)) is not None:
        note = "Grey: the undeformed body; solid: displaced by the mode, at an arbitrary amplitude."
        return mode_picture(title, note, _body_panels(modes, drawn, count), np.zeros((0, 2)))
    scene = drawn_scene(modes)[0]
    panels = []
    for label, mode in drawn_modes(modes, count):
        shown = mode_lines(modes, mode)
        there = [line + d.real for line, d in zip(shown.lines, shown.displacements, strict=True)]
        back = [line - d.real for line, d in zip(shown.lines, shown.displacements, strict=True)]
        panels.append(ModePanel(label, shown.lines, there, back))
    ground = np.array([body_coordinates(scene, MarkerRef(GROUND, m.name)) for m in scene.ground]).reshape(-1, 2)
    note = "Grey: the state itself; solid and dashed: displaced by the mode, at an arbitrary amplitude."
    return mode_picture(title, note, panels, ground)


def _spatial(modes: Modes) -> DrawnBody | None:
    """The drawing of a body in space; None of a planar model."""
    return drawn_body(modes.spec) if isinstance(modes.spec, NodalBody) else None


def _body_panels(modes: Modes, drawn: DrawnBody, count: int) -> list[ModePanel]:
    """The edges of a body in space, projected."""
    yaw, pitch = VIEW
    away = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    axes = np.array([[np.cos(yaw), np.sin(yaw), 0.0], np.sin(pitch) * away + [0.0, 0.0, np.cos(pitch)]])

    def lines(x: Array) -> list[Array]:
        return [(x @ axes.T)[list(edge)] for edge in drawn.surface.edges]

    return [
        ModePanel(label, lines(drawn.x), lines(drawn.x + body_displacements(drawn, mode)[0].real), [])
        for label, mode in drawn_modes(modes, count)
    ]


def modes_page(modes: Modes, count: int) -> str:
    """A page that plays the first `count` modes, those of zero eigenvalues apart; damping is not shown."""
    title, frames, pages = f"{modes.spec.name}: modes", np.arange(PERIODS * FRAMES + 1), []
    phases = 2 * np.pi * frames / FRAMES
    drawn = _spatial(modes)
    for label, mode in drawn_modes(modes, count):
        period = 2 * np.pi / mode.eigenvalue.imag if mode.eigenvalue.imag else NOMINAL_PERIOD
        times = period * frames / FRAMES
        if drawn is not None:
            path = path_of(displaced_body(modes, mode, drawn, phases))
            content = bodies_motion_data([drawn], times, [path], measured=False)
        else:
            content = player_data(displaced(modes, mode, phases), (), times)
        pages.append({**content, "name": label})
    return motions_page(title, pages) if drawn is None else spatial_motions_page(title, bodies_data([drawn]), pages)


def drawn_modes(modes: Modes, count: int) -> list[tuple[str, Mode]]:
    """The first `count` modes with their labels, those of zero eigenvalues apart."""
    shown = enumerate(modes.first(count), 1)
    return [(f"{number}: {_label(mode)}", mode) for number, mode in shown if mode.eigenvalue]


def _label(mode: Mode) -> str:
    if not mode.eigenvalue.imag:
        return f"{'grows' if mode.eigenvalue.real > 0 else 'decays'}, {mode.eigenvalue.real:.4g} 1/s"
    ratio = f", ζ = {mode.damping_ratio:.3g}" if abs(mode.damping_ratio) > 1e-9 else ""
    return f"{mode.frequency:.4g} Hz{ratio}"
