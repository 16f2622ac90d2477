"""The picture and the animation of the modes of a model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from derive.simulation.linear.displaced import displaced, drawn_scene, mode_lines
from derive.simulation.linear.displaced_bodies import (
    bodies_displacements,
    body_displacements,
    displaced_body,
    displaced_paths,
)
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.motion import Array, body_coordinates
from derive.simulation.observables.player_data import player_data
from derive.simulation.observables.spatial_player_data import (
    BodyPath,
    DrawnBody,
    Tie,
    bodies_data,
    bodies_motion_data,
    drawn_body,
    path_of,
)
from derive.simulation.observables.spatial_scene_player import PLAYER_TRIANGLES, drawn_bodies, ground_points, ties
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
    return not isinstance(modes.spec, SymbolicBody) and bool(drawn_modes(modes, count))


def modes_picture(modes: Modes, count: int) -> str:
    """The shapes of the first `count` modes as SVG, those of zero eigenvalues apart."""
    title = f"{modes.spec.name}: modes"
    if drawn := _spatial(modes, 0):
        note = f"Grey: {_rest(modes)}; solid: displaced by the mode, at an arbitrary amplitude."
        ground = np.array([at for _, at in _ground(modes)]).reshape(-1, 3)
        return mode_picture(title, note, _body_panels(modes, drawn, count), ground @ _page_axes().T)
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


def _spatial(modes: Modes, triangles: int) -> list[DrawnBody]:
    """The drawings of the bodies of a model in space, as of `drawn_bodies`; none of a planar model."""
    if isinstance(modes.spec, NodalBody):
        return [drawn_body(modes.spec)]
    return drawn_bodies(modes.spec, triangles) if isinstance(modes.spec, SpatialScene) else []


def _ground(modes: Modes) -> list[tuple[str, Array]]:
    """The names and places (3,), m, of the markers of the ground of a model in space."""
    return ground_points(modes.spec) if isinstance(modes.spec, SpatialScene) else []


def _ties(modes: Modes) -> list[Tie]:
    return ties(modes.spec) if isinstance(modes.spec, SpatialScene) else []


def _rest(modes: Modes) -> str:
    return "the undeformed body" if isinstance(modes.spec, NodalBody) else "the state itself"


def _page_axes() -> Array:
    """The directions of the page, to the right and upwards, by rows (2, 3)."""
    yaw, pitch = VIEW
    away = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    return np.array([[np.cos(yaw), np.sin(yaw), 0.0], np.sin(pitch) * away + [0.0, 0.0, np.cos(pitch)]])


def _body_panels(modes: Modes, drawn: list[DrawnBody], count: int) -> list[ModePanel]:
    """The edges of bodies in space, projected."""
    axes, panels = _page_axes(), []

    def lines(places: Sequence[Array]) -> list[Array]:
        edges = zip(drawn, places, strict=True)
        return [(x @ axes.T)[list(edge)] for body, x in edges for edge in (*body.surface.edges, *body.links)]

    for label, mode in drawn_modes(modes, count):
        if isinstance(modes.spec, NodalBody):
            rest, moved = [drawn[0].x], [body_displacements(drawn[0], mode)[0]]
        else:
            rest, moved, _ = bodies_displacements(modes, mode, drawn)
        there = [x + d.real for x, d in zip(rest, moved, strict=True)]
        panels.append(ModePanel(label, lines(rest), lines(there), []))
    return panels


def modes_page(modes: Modes, count: int) -> str:
    """A page that plays the first `count` modes, those of zero eigenvalues apart; damping is not shown."""
    title, frames, pages = f"{modes.spec.name}: modes", np.arange(PERIODS * FRAMES + 1), []
    phases = 2 * np.pi * frames / FRAMES
    drawn = _spatial(modes, PLAYER_TRIANGLES)
    for label, mode in drawn_modes(modes, count):
        period = 2 * np.pi / mode.eigenvalue.imag if mode.eigenvalue.imag else NOMINAL_PERIOD
        times = period * frames / FRAMES
        if drawn:
            content = bodies_motion_data(drawn, times, _paths(modes, mode, drawn, phases), measured=False)
        else:
            content = player_data(displaced(modes, mode, phases), (), times)
        pages.append({**content, "name": label})
    if not drawn:
        return motions_page(title, pages)
    return spatial_motions_page(title, bodies_data(drawn, _ground(modes), _ties(modes)), pages)


def _paths(modes: Modes, mode: Mode, drawn: list[DrawnBody], phases: Array) -> list[BodyPath]:
    if isinstance(modes.spec, NodalBody):
        return [path_of(displaced_body(modes, mode, drawn[0], phases))]
    return displaced_paths(modes, mode, drawn, phases)


def drawn_modes(modes: Modes, count: int) -> list[tuple[str, Mode]]:
    """The first `count` modes with their labels, those of zero eigenvalues apart."""
    shown = enumerate(modes.first(count), 1)
    return [(f"{number}: {_label(mode)}", mode) for number, mode in shown if mode.eigenvalue]


def _label(mode: Mode) -> str:
    if not mode.eigenvalue.imag:
        return f"{'grows' if mode.eigenvalue.real > 0 else 'decays'}, {mode.eigenvalue.real:.4g} 1/s"
    ratio = f", ζ = {mode.damping_ratio:.3g}" if abs(mode.damping_ratio) > 1e-9 else ""
    return f"{mode.frequency:.4g} Hz{ratio}"
