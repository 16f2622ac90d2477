"""The picture and the animation of the modes of a scene."""

from __future__ import annotations

import numpy as np

from derive.simulation.linear.displaced import displaced, drawn_scene, mode_lines
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.motion import body_coordinates
from derive.simulation.observables.player_data import player_data
from derive.spec.model.scene import GROUND, MarkerRef
from derive.visual.mode_shapes import ModePanel, mode_picture
from derive.visual.player import motions_page

PERIODS, FRAMES = 4, 40
"""Periods of an animation, and the instants in a period."""
NOMINAL_PERIOD = 1.0
"""The period (s) at which a mode that does not oscillate is shown."""


def modes_picture(modes: Modes, count: int) -> str:
    """The shapes of the first `count` modes as SVG, those of zero eigenvalues apart."""
    scene = drawn_scene(modes)[0]
    panels = []
    for label, mode in drawn_modes(modes, count):
        shown = mode_lines(modes, mode)
        there = [line + d.real for line, d in zip(shown.lines, shown.displacements, strict=True)]
        back = [line - d.real for line, d in zip(shown.lines, shown.displacements, strict=True)]
        panels.append(ModePanel(label, shown.lines, there, back))
    ground = np.array([body_coordinates(scene, MarkerRef(GROUND, m.name)) for m in scene.ground]).reshape(-1, 2)
    note = "Grey: the state itself; solid and dashed: displaced by the mode, at an arbitrary amplitude."
    return mode_picture(f"{scene.name}: modes", note, panels, ground)


def modes_page(modes: Modes, count: int) -> str:
    """A page that plays the first `count` modes, those of zero eigenvalues apart; damping is not shown."""
    pages = []
    for label, mode in drawn_modes(modes, count):
        frames = np.arange(PERIODS * FRAMES + 1)
        period = 2 * np.pi / mode.eigenvalue.imag if mode.eigenvalue.imag else NOMINAL_PERIOD
        motion = displaced(modes, mode, 2 * np.pi * frames / FRAMES)
        pages.append({**player_data(motion, (), period * frames / FRAMES), "name": label})
    return motions_page(f"{modes.spec.name}: modes", pages)


def drawn_modes(modes: Modes, count: int) -> list[tuple[str, Mode]]:
    """The first `count` modes with their labels, those of zero eigenvalues apart."""
    shown = enumerate(modes.first(count), 1)
    return [(f"{number}: {_label(mode)}", mode) for number, mode in shown if mode.eigenvalue]


def _label(mode: Mode) -> str:
    if not mode.eigenvalue.imag:
        return f"{'grows' if mode.eigenvalue.real > 0 else 'decays'}, {mode.eigenvalue.real:.4g} 1/s"
    ratio = f", ζ = {mode.damping_ratio:.3g}" if abs(mode.damping_ratio) > 1e-9 else ""
    return f"{mode.frequency:.4g} Hz{ratio}"
