"""Checks of the keys of a body of nodes that depend on its arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from derive.enumerations import enumeration
from derive.spec.checks.component_modes import asks_for_component_modes, component_mode_faults
from derive.spec.files.mesh_arrays import Array, arrays_elements_lack, set_sizes
from derive.spec.files.node_data import CheckedNodes, node_data
from derive.spec.files.node_files import read_nodes
from derive.spec.files.node_format import Units
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.model.node_data import NodeData
from derive.spec.parsing import values
from derive.spec.parsing.faults import Fault, Faults, KeyPath, readable
from derive.spec.parsing.values import MAX_MODES
from derive.spec.tables.shared import MAX_MARKERS, TomlTable
from derive.spec.tables.value_types import MAX_AROUND


def nodes_of(body: Mapping[str, object], table: TomlTable | None, folder: Path) -> tuple[NodeData | None, Faults]:
    """The data of a body of nodes, and the faults of the data and of the keys that refer to them.

    `table` is the body if its keys are right. If they are not, the files are looked at none the less.
    """
    if "nodes" not in body:
        return None, Faults()
    arrays_found = read_nodes(body["nodes"], folder)
    units = getattr(table, "units", Units())
    checked = node_data(arrays_found, units)
    faults = Faults([*arrays_found.faults, *checked.faults])
    if isinstance(body["nodes"], NodeData) and units != Units():
        faults.append(Fault(("body", "units"), "NodeData are in SI units; leave `units` out"))
    sets = set_sizes(arrays_found.arrays)
    if arrays_found.complete:
        faults += _mode_faults(body, {key.removesuffix("_value") for key in arrays_found.arrays}, checked)
        faults += component_mode_faults(body, {key.removesuffix("_value") for key in arrays_found.arrays}, sets)
        faults += _order_faults(body, arrays_found.arrays, checked.data)
    faults += _stress_faults(body, arrays_found.arrays, checked.data)
    if checked.nodes is not None:
        faults += _node_faults(body, checked.nodes)
    return checked.data, faults


def _mode_faults(body: Mapping[str, object], arrays: set[str], checked: CheckedNodes) -> Iterator[Fault]:
    """Faults of a number of modes that the data cannot provide."""
    asked = readable(values.mode_count, body.get("modes"))
    if "modes" in arrays and not asks_for_component_modes(body):
        if isinstance(body.get("modes"), (Mapping, ModeSelection)):
            text = "an error selects computed modes, and the files have modes of their own"
            yield Fault(("body", "modes"), f'{text}; write component_modes = "free" as well, or a number of modes')
        given = checked.modes
        count = given if asked is None else asked
        if given is not None and asked is not None and asked > given:
            yield Fault(("body", "modes"), f"{asked} modes are asked for, and there are {given} in the files")
            return
        if not {"modal_stiffness", "stiffness"} & arrays and count != 0:
            yield Fault(("body", "nodes"), "the modes have no stiffness: add modal_stiffness, or stiffness")
    else:
        count = asked
        if "stiffness" not in arrays and asked != 0 and not asks_for_component_modes(body):
            yield Fault(
                ("body", "modes") if asked else ("body", "nodes"),
                "there is nothing to take modes from: add modes and modal_stiffness, or a stiffness to compute them "
                "with mass, or write modes = 0 for a rigid body",
            )
        elif "modes" not in body:
            yield Fault(
                ("body", "modes"),
                "this key is missing; write modes = 8 to have so many computed from mass and stiffness",
            )
        if body.get("orthonormal") is False:
            yield Fault(
                ("body", "orthonormal"), "modes that are computed are orthonormal; leave this out, or give the modes"
            )
    if count is None or checked.nodes is None:
        return
    most = max(3 * checked.nodes - 6, 0)
    if count > most:
        yield Fault(
            ("body", "modes"),
            f"{count} modes are too many: {checked.nodes} nodes have {3 * checked.nodes} displacements, of which 6 are "
            f"rigid motion, so that there are {most} at most",
        )
    elif count > MAX_MODES:
        yield Fault(
            ("body", "modes"),
            f"there are {count} modes in the files, and {MAX_MODES} are allowed; keep fewer: modes = 8",
        )


def _stress_faults(body: Mapping[str, object], arrays: Mapping[str, Array], data: NodeData | None) -> Iterator[Fault]:
    """Faults of a largest stress of a body without elements or materials."""
    if body.get("stress") is True and data is not None and not data.has_stresses:
        text = "stresses are computed from elements with Young's modulus and Poisson's ratio, which the files lack"
        text += _lacking(arrays)
        yield Fault(("body", "stress"), f"{text}; add elements_tet10 or others and materials, or leave this out")


def _lacking(arrays: Mapping[str, Array]) -> str:
    """The end of a sentence, on the arrays by which elements have their materials; empty if none is missing."""
    names = arrays_elements_lack(arrays)
    return f"; the elements lack {enumeration(names)}" if names else ""


def _order_faults(body: Mapping[str, object], arrays: Mapping[str, Array], data: NodeData | None) -> Iterator[Fault]:
    """Faults of a second order without geometric stiffness matrices and without elements to compute them."""
    unknown = data is None and "materials" in arrays
    if readable(values.order, body.get("order")) != 2 or unknown or (data and data.gives_geometric_stiffness):
        return
    needed = f"elements with materials and a stiffness, from which they are computed{_lacking(arrays)}"
    if not arrays.keys() & {"K0t", "K0r", "K0omega", "K0F"}:
        text = "a body of order 2 needs geometric stiffness matrices, K0t, K0r, K0omega or K0F, among its arrays"
        yield Fault(("body", "order"), f"{text}, or {needed}")
    elif asks_for_component_modes(body):
        text = "geometric stiffness matrices belong to the modes of the files, and component modes are others"
        yield Fault(("body", "order"), f"{text}; write order = 1, leave component modes out, or add {needed}")


def _node_faults(body: Mapping[str, object], nodes: int) -> Iterator[Fault]:
    """Faults of references to nodes that do not exist."""
    for path, value in _node_numbers(body):
        node = readable(values.whole, value)
        if node is not None and node >= nodes:
            which = f"node {node}" if node < 10**18 else "such node"
            yield Fault(path, f"there is no {which}: the nodes are 0 to {nodes - 1}")


def _node_numbers(body: Mapping[str, object]) -> Iterator[tuple[KeyPath, object]]:
    frame, markers = body.get("frame"), body.get("markers")
    if isinstance(frame, Mapping):
        yield ("body", "frame", "node"), frame.get("node")
        around = frame.get("around")
        if isinstance(around, (list, tuple)):
            for i, node in enumerate(around[:MAX_AROUND]):
                yield ("body", "frame", "around", i), node
    if isinstance(markers, Mapping) and len(markers) <= MAX_MARKERS:
        for name, node in markers.items():
            yield ("body", "markers", str(name)), node
