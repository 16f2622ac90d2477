"""The fewest modes that represent a body within an error, and why these."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array
from derive.reduction.component_modes import ComponentModes, component_modes, static_mode_count
from derive.reduction.eigen import elastic_modes, max_elastic_modes, modal_stiffness, symmetric_matrix
from derive.reduction.frames import from_centre_of_mass, orthonormal_modes
from derive.reduction.integrals import canonical_csr, mass_products
from derive.reduction.interface import RIGID_MOTIONS
from derive.reduction.mode_errors import ModeErrors, full_frequencies, mode_errors
from derive.spec.model.body import NodalBody
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.parsing.values import MAX_MODES

EQUAL = 1e-6
"""The relative difference of two frequencies that count as one: both modes are kept, or neither."""


FIRST = 6
"""The number of frequencies that are compared where no limit is given."""


@dataclass(frozen=True, eq=False)
class SelectedModes:
    """The number of modes that were selected, `static` of which are static modes of the interface.

    frequencies: those of the full matrices up to the limit (Hz). errors: those of the selected modes. fewer: those of
    the most modes that are fewer; None if there are none.
    """

    count: int
    static: int
    frequencies: Array
    errors: ModeErrors
    fewer: ModeErrors | None


def with_selected_modes(body: NodalBody) -> NodalBody:
    """A body with a number of modes in place of the wish for an error. Raises SpecError if no number meets it."""
    return replace(body, modes=selected_modes(body).count) if isinstance(body.modes, ModeSelection) else body


def selected_modes(body: NodalBody) -> SelectedModes:
    """The fewest modes within the error that `body.modes` asks for. Raises SpecError if MAX_MODES are too few."""
    return _selected(replace(body, name=""))


@lru_cache(8)
def _selected(body: NodalBody) -> SelectedModes:
    wish = body.modes
    assert isinstance(wish, ModeSelection)
    mass = canonical_csr(body.data.mass)
    static = static_mode_count(body.component_modes or "free", body.interface_markers)
    most = min(max_elastic_modes(mass, RIGID_MOTIONS, body.rigid_sets), MAX_MODES)
    full = full_frequencies(body, wish.up_to, most)
    wanted = full[full <= wish.up_to]
    if len(wanted) > most:
        text = f"more than {MAX_MODES} natural frequencies are below {wish.up_to:g} Hz; write a lower up_to"
        raise SpecError((Problem("body.modes", text),))
    if not body.interface_markers and not len(wanted):
        text = f"the first natural frequency, {full[0]:.5g} Hz, is above up_to; write modes = 0 for a rigid body"
        raise SpecError((Problem("body.modes", text),))
    statics = _modes(replace(body, modes=static), static).static  # not those orthogonal to modes of vibration
    last, tried = most - static, 0 if body.interface_markers else len(wanted)
    while True:  # twice as many modes of vibration each time; those that suffice are then counted by bisection
        modes = ComponentModes(statics, _modes(replace(body, modes=static + min(tried + 1, last)), static).vibration)
        errors = _errors(body, modes, tried, wanted)
        if errors.largest <= wish.error:
            break
        if tried == last:
            raise SpecError((_out_of_reach(body, wish, most, errors),))
        tried = min(max(2 * tried, 4), last)
    least = bisect_left(range(tried), True, key=lambda count: _errors(body, modes, count, wanted).largest <= wish.error)
    count = least + _is_one_of_two(body, modes, least)
    fewer = _errors(body, modes, least - 1, wanted) if least else None
    return SelectedModes(static + count, static, wanted, _errors(body, modes, count, wanted), fewer)


def _modes(body: NodalBody, static: int) -> ComponentModes:
    """The component modes of a body with a number of modes, or its free modes as modes of vibration."""
    if body.interface_markers:
        return component_modes(body, canonical_csr(body.data.mass), np.array(body.data.positions, dtype=np.float64))
    mass = canonical_csr(body.data.mass)
    x = from_centre_of_mass(mass, np.array(body.data.positions, dtype=np.float64))
    assert isinstance(body.modes, int)
    phi = orthonormal_modes(mass, *elastic_modes(body, mass, x))[0][: body.modes]
    return ComponentModes(phi[:static], phi[static:])


def _errors(body: NodalBody, modes: ComponentModes, count: int, frequencies: Array) -> ModeErrors:
    """The errors of the static modes and the first `count` modes of vibration."""
    return mode_errors(body, np.concatenate([modes.static, modes.vibration[:count]]), frequencies)


def _is_one_of_two(body: NodalBody, modes: ComponentModes, count: int) -> bool:
    """Whether the last of `count` modes of vibration and the next one have one frequency, so that both are needed."""
    pair = modes.vibration[count - 1 : count + 1]
    if not count or len(pair) < 2:
        return False
    assert body.data.stiffness is not None  # by check_body
    stiffness = np.diag(modal_stiffness(symmetric_matrix(body.data.stiffness), pair))
    first, second = stiffness / np.diag(mass_products(canonical_csr(body.data.mass), pair, pair))
    return bool(abs(second - first) <= EQUAL * first)


def _out_of_reach(body: NodalBody, wish: ModeSelection, most: int, errors: ModeErrors) -> Problem:
    """The fault of an error that the most modes do not meet."""
    hint = "write a larger error or a lower up_to"
    return Problem(
        "body.modes", f"{most} modes still have an error of {errors.largest:.2g}, not {wish.error:g}; {hint}"
    )


@dataclass(frozen=True, eq=False)
class ModeConvergence:
    """The errors of the first modes of a body, for several numbers of them.

    frequencies: those of the full matrices that are compared (Hz). errors: one for each of `counts`.
    """

    counts: tuple[int, ...]
    frequencies: Array
    errors: tuple[ModeErrors, ...]


def mode_convergence(body: NodalBody) -> ModeConvergence:
    """The errors of the static modes of an interface with more and more modes of vibration, up to all that are used.

    The frequencies that are compared are those up to the limit of a selection, or else the first six.
    """
    mass = canonical_csr(body.data.mass)
    most = max_elastic_modes(mass, RIGID_MOTIONS, body.rigid_sets)
    if isinstance(body.modes, ModeSelection):
        full = full_frequencies(body, body.modes.up_to, most)
        wanted = full[full <= body.modes.up_to]
    else:
        wanted = full_frequencies(body, np.inf, min(FIRST, most) - 1)
    used = with_selected_modes(body)
    assert isinstance(used.modes, int)
    static = static_mode_count(body.component_modes or "free", body.interface_markers)
    statics, vibration = _modes(replace(used, modes=static), static).static, _modes(used, static).vibration
    modes, steps = ComponentModes(statics, vibration), range(used.modes - static + 1)
    errors = tuple(_errors(body, modes, count, wanted) for count in steps)
    return ModeConvergence(tuple(static + count for count in steps), wanted, errors)
