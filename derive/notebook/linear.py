"""The HTML of small motions: modes with their shapes and their player, and the matrices of a linearisation."""

from __future__ import annotations

import numpy as np

from derive.notebook.parts import Writers, folded, head, joined, number, picture, player, table
from derive.runtime.native_call import Matrix
from derive.short_text import counted
from derive.simulation.linear.linearisation import Linearisation
from derive.simulation.linear.modes import Modes
from derive.visual.mode_pages import is_drawn, modes_page, modes_picture

DRAWN = 4
"""The number of modes that are drawn, those of zero eigenvalues apart."""
MOST_STATES = 12
"""The most states of matrices that are shown element by element."""


def modes_html(modes: Modes) -> str:
    """The modes of a model: their frequencies and damping ratios, the first shapes, and their player."""
    moving = "steady motion" if modes.steady else f"state at t = {modes.linear.t:g} s"
    state = "equilibrium" if modes.equilibrium else moving
    rows = [
        (i, f"{mode.frequency:.6g}", number(mode.damping_ratio), f"{mode.eigenvalue:.5g}")
        for i, mode in enumerate(modes.modes, 1)
    ]
    title = f"{modes.spec.name}: modes"
    shown = ""
    if is_drawn(modes, DRAWN):
        shapes = picture(modes_picture(modes, DRAWN), f"{title} 1 to {min(DRAWN, len(modes.modes))}")
        shown = shapes + player(modes_page(modes, DRAWN), title)
    return joined(
        head(modes.spec.name, f"{counted(len(modes.modes), 'mode')} about the {state}"),
        table(("mode", "frequency, Hz", "damping ratio", "eigenvalue, 1/s"), rows),
        shown,
    )


def linearisation_html(linear: Linearisation) -> str:
    """A linearisation: its states, inputs and outputs, and its matrices where they are small."""
    names = {"states x": linear.states, "inputs u": linear.inputs, "outputs y": linear.outputs}
    matrices = {"A": linear.A, "B": linear.B, "C": linear.C, "D": linear.D}
    rows = [(what, len(some), ", ".join(some)) for what, some in names.items()]
    small = len(linear.states) <= MOST_STATES
    return joined(
        head(f"Linearisation at t = {linear.t:g} s", "xdot = A x + B u, y = C x + D u"),
        table(("", "number", "names"), rows, left=3),
        "".join(folded(f"{name} ({' x '.join(map(str, of.shape))})", _matrix(of)) for name, of in matrices.items())
        if small
        else "",
    )


def _matrix(matrix: Matrix) -> str:
    """The elements of a matrix, of at most as many columns as states."""
    if not matrix.size or matrix.shape[1] > MOST_STATES:
        return ""
    return table([str(j) for j in range(matrix.shape[1])], [[number(x) for x in row] for row in np.asarray(matrix)], 0)


WRITERS: Writers = {
    Modes: modes_html,
    Linearisation: linearisation_html,
}
