"""Notes on the modes of a finite-element body that are computed: which, how many, and how well they represent it."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import TYPE_CHECKING

from derive.errors import quoted
from derive.percentages import percent
from derive.short_text import counted
from derive.spec.model.body import ComponentModes, NodalBody
from derive.spec.model.mode_selection import ModeSelection

if TYPE_CHECKING:
    from derive.reduction.arithmetic import Array
    from derive.reduction.mode_errors import ModeErrors

COMPONENT_MODES = {
    "free": "free modes",
    "craig_bampton": "Craig-Bampton modes",
    "attachment": "attachment modes with inertia relief, and free modes,",
}


def component_mode_notes(spec: NodalBody) -> Iterator[str]:
    """Yield what the modes are if they are computed by choice, and the frequency of each beside that of the free body.

    Frequencies of the modes are not below those of the full matrices, in their order.
    """
    if spec.component_modes is not None:
        yield from _of_choice(spec, spec.component_modes)
    if isinstance(spec.modes, ModeSelection):
        yield _of_selection(spec, spec.modes)
    if spec.interface_markers:
        yield from _of_interface(spec)


def _of_choice(spec: NodalBody, kind: ComponentModes) -> Iterator[str]:
    """Yield which modes of the files are left out."""
    if spec.data.modes is not None:
        left_out = " with their geometric stiffness" if spec.data.has_geometric_stiffness else ""
        count = len(spec.data.modes)
        yield (
            f"component_modes = {quoted(kind)}: the {counted(count, 'mode')} of the files "
            f"{'is' if count == 1 else 'are'} left out{left_out}, and modes are computed from mass and stiffness"
        )


def _of_interface(spec: NodalBody) -> Iterator[str]:
    """Yield what the modes are, the frequency of each beside the exact one, and the error of deflections."""
    from derive.reduction.component_mode_table import component_mode_table, interface_deflections

    rows = component_mode_table(spec)
    interface = ", ".join(spec.interface)
    counts = ", ".join(f"{sum(row.kind == kind for row in rows)} {kind}" for kind in ("static", "vibration"))
    yield (
        f"{COMPONENT_MODES[str(spec.component_modes)]} of the interface {interface} ({counts}, by the larger "
        "part of the strain energy); frequencies in Hz, and those of the free body by its full matrices:"
    )
    for number, row in enumerate(rows, 1):
        yield f"  mode {number}: {row.kind:9} {row.frequency:10.5g}  full matrices {row.full:10.5g}  {row.excess}"
    worst = max(interface_deflections(spec), key=lambda row: row.error)
    yield (
        "deflections under unit forces and moments at the interface, balanced by inertia forces: within "
        f"{percent(worst.error)} of those by the full matrices (largest error: {worst.load})"
    )


def _of_selection(spec: NodalBody, wish: ModeSelection) -> str:
    """How many modes were selected, and why not fewer."""
    from derive.reduction.mode_selection import selected_modes

    found = selected_modes(spec)
    static = f" ({found.static} static)" if found.static else ""
    compared = f"the {counted(len(found.frequencies), 'frequency', 'frequencies')} up to {wish.up_to:g} Hz"
    if spec.interface_markers:
        compared += " and the deflections at the interface"
    text = f"{counted(found.count, 'mode')}{static} represent {compared} within {percent(wish.error)}"
    return f"{text}; with one fewer {_worst(spec, found.fewer, found.frequencies)}" if found.fewer else text


def _worst(spec: NodalBody, errors: ModeErrors, full: Array) -> str:
    """The largest error in words. full: the frequencies of the full matrices, Hz."""
    from derive.reduction.mode_errors import unit_loads

    both = [*errors.frequency_errors, *errors.deflection_errors]
    worst = both.index(max(both))
    if worst >= len(full):
        load = unit_loads(spec).names[worst - len(full)]
        return f"the deflection under a unit {load} is off by {percent(both[worst])}"
    number = f"frequency {worst + 1} ({full[worst]:.5g} Hz)"
    return f"{number} is off by {percent(both[worst])}" if isfinite(both[worst]) else f"{number} is missing"
