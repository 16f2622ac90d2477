"""Checks of the component modes of a finite-element body: its interface, and what its files have to contain."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set

from derive.errors import quoted
from derive.spec.parsing import values
from derive.spec.parsing.faults import Fault, did_you_mean, names_text, readable

STATIC = {"craig_bampton": "static modes without the six rigid motions", "attachment": "attachment modes"}


def asks_for_component_modes(body: Mapping[str, object]) -> bool:
    """Whether modes are computed even where the files contain some."""
    return "component_modes" in body or bool(body.get("interface"))


def component_mode_faults(body: Mapping[str, object], arrays: Set[str], sets: Mapping[str, int]) -> Iterator[Fault]:
    """Faults of a kind of component modes and its interface.

    arrays: the names of those in the files. sets: how many nodes each set of the files has.
    """
    if not asks_for_component_modes(body):
        return
    kind, names = body.get("component_modes", "craig_bampton"), body.get("interface")
    if "stiffness" not in arrays:
        key = "component_modes" if "component_modes" in body else "interface"
        text = "component modes are computed from a stiffness matrix, which the files lack; add `stiffness`"
        yield Fault(("body", key), f"{text}, or leave this out to use the modes of the files")
    if kind == "free":
        if names:
            text = "free modes have no interface; leave this out, or write another kind of component_modes"
            yield Fault(("body", "interface"), text)
        return
    if kind not in STATIC:
        return
    if not names:
        text = f'{kind} modes need an interface: the markers at which joints hold the body, interface = ["left"]'
        yield Fault(("body", "component_modes"), text)
    if isinstance(names, (list, tuple)):
        yield from _interface_faults(body, str(kind), names, sets)


def _interface_faults(
    body: Mapping[str, object], kind: str, names: list[object] | tuple[object, ...], sets: Mapping[str, int]
) -> Iterator[Fault]:
    """Faults of names of markers, and of a number of modes that does not suffice for them."""
    markers = body.get("markers")
    known: Mapping[str, object] = {
        **{name: {"set": name} for name in sets},
        **(markers if isinstance(markers, Mapping) else {}),
    }
    motions, wrong = 0, False
    for i, name in enumerate(names):
        if not isinstance(name, str):
            return
        if name not in known:
            of_file = " and no set" if sets else ""
            hint = did_you_mean(name, known, f"there are {names_text(known)}") if known else "; it has none"
            yield Fault(("body", "interface", i), f"the body has no marker{of_file} {quoted(name)}{hint}")
            wrong = True
            continue
        if name in names[:i]:
            yield Fault(("body", "interface", i), f"the marker {name} is named twice; name it once")
            wrong = True
            continue
        marker = known[name]
        several = isinstance(marker, Mapping) and ("nodes" in marker or sets.get(str(marker.get("set")), 0) > 1)
        motions += 6 if several else 3
    least = motions - 6 if kind == "craig_bampton" else motions
    count = readable(values.mode_count, body.get("modes"))
    if not wrong and count is not None and count < least:
        text = f"{count} modes are too few for this interface of {motions} displacements and rotations"
        text += f": it has {least} {STATIC[kind]}; write modes = {least} or more, which adds modes of vibration"
        yield Fault(("body", "modes"), text)
