"""The files of the finite-element bodies of a scene in space, with the faults of their data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from derive.errors import quoted
from derive.mechanics.multibody.space.nodal_loads import load_points
from derive.spec.model.node_data import NodeData
from derive.spec.parsing.faults import Fault, KeyPath, did_you_mean, names_text
from derive.spec.tables.shared import TomlTable
from derive.spec.tables.spatial_bodies import LEAST_NODES, kind_of_spatial_body


def flexible_nodes(
    data: Mapping[str, object], specification: TomlTable | None, folder: Path
) -> tuple[dict[str, NodeData], list[Fault]]:
    """The data of finite-element bodies by their names, with files relative to `folder`, and their faults."""
    bodies = data.get("bodies")
    result: dict[str, NodeData] = {}
    faults: list[Fault] = []
    known: dict[tuple[str, str], NodeData] = {}
    for name, body in bodies.items() if isinstance(bodies, Mapping) else ():
        if not isinstance(body, Mapping) or kind_of_spatial_body(body) != "flexible":
            continue
        from derive.spec.checks.node_checks import nodes_of  # NumPy is not for specifications without arrays

        tables: Any = getattr(specification, "bodies", None) or {}
        nodes, of_body = nodes_of(body, tables.get(name), folder)
        faults += [fault._replace(path=_in_scene(str(name), fault.path)) for fault in of_body]
        if nodes is not None:  # bodies of the same file share its data, and what follows from them
            file, same = body["nodes"], nodes
            if isinstance(file, str):
                same = known.setdefault((file, repr(body.get("units"))), nodes)
            result[str(name)] = same
            faults += _missing_sets(str(name), body.get("markers"), nodes)
            faults += _shared_nodes(str(name), body.get("markers"), nodes)
            faults += _missing_nodes(str(name), "markers", body.get("markers"), len(nodes.positions))
            faults += _missing_nodes(str(name), "loads", body.get("loads"), len(nodes.positions))
            faults += _loads_like_markers(str(name), body)
    return result, faults


def _in_scene(name: str, path: KeyPath) -> KeyPath:
    """The path of a key of a body in a scene, for that of a body alone."""
    return ("bodies", name, *path[1:])


def _loads_like_markers(name: str, body: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of loads whose points have the names of markers."""
    loads, markers = body.get("loads"), body.get("markers")
    for load in loads if isinstance(loads, Mapping) else ():
        taken = load_points(str(load)) & {str(marker) for marker in markers} if isinstance(markers, Mapping) else set()
        if taken:
            text = f"a point of the load {load} is called like the marker {min(taken)}; rename one of them"
            yield Fault(("bodies", name, "loads", str(load)), text)


def _missing_nodes(name: str, section: str, markers: object, count: int) -> Iterator[Fault]:
    """Faults of markers or loads with nodes that do not exist; single nodes are looked at with the data."""
    for marker, value in markers.items() if isinstance(markers, Mapping) else ():
        if not isinstance(value, Mapping):
            continue
        numbers = [("node", value.get("node"))]
        nodes = value.get("nodes")
        numbers += [("nodes", node) for node in nodes] if isinstance(nodes, (list, tuple)) else []
        for key, node in numbers:
            if isinstance(node, int) and node >= count:
                text = f"there is no node {node}: the nodes are 0 to {count - 1}"
                yield Fault(("bodies", name, section, str(marker), key), text)
                break


def _missing_sets(name: str, markers: object, data: NodeData) -> Iterator[Fault]:
    """Faults of markers at sets that the file does not have, or whose nodes do not determine a rotation."""
    sets = data.mesh.node_sets if data.mesh else {}
    for marker, value in markers.items() if isinstance(markers, Mapping) else ():
        wanted = value.get("set") if isinstance(value, Mapping) else None
        if not isinstance(wanted, str):
            continue
        path = ("bodies", name, "markers", str(marker), "set")
        if wanted not in sets:
            hint = did_you_mean(wanted, sets, f"its sets are {names_text(sets)}") if sets else "; it has no sets"
            yield Fault(path, f"the file has no set {quoted(wanted)}{hint}")
        elif len(sets[wanted]) < LEAST_NODES:
            text = "a set needs three nodes, not on a line, to have a rotation; name its node instead"
            yield Fault(path, f"the set {wanted} has {len(sets[wanted])}: {text}")


def _own_nodes(value: object, data: NodeData) -> list[int]:
    """The nodes that the table of a marker names, those of its set among them."""
    if not isinstance(value, Mapping):
        return []
    nodes, wanted = value.get("nodes"), value.get("set")
    if isinstance(wanted, str) and data.mesh and wanted in data.mesh.node_sets:
        return [int(node) for node in data.mesh.node_sets[wanted]]
    return [node for node in nodes if isinstance(node, int)] if isinstance(nodes, (list, tuple)) else []


def _shared_nodes(name: str, markers: object, data: NodeData) -> Iterator[Fault]:
    """Faults of rigid sets of nodes that have a node in common, and so are a single rigid set."""
    owner: dict[int, str] = {}
    for marker, value in markers.items() if isinstance(markers, Mapping) else ():
        rigid = isinstance(value, Mapping) and value.get("motion") == "rigid"
        own = _own_nodes(value, data) if rigid else []
        shared = next((node for node in own if node in owner), None)
        if shared is not None:
            text = f"node {shared} is in the rigid set {owner[shared]} as well; make one rigid set of both"
            yield Fault(("bodies", name, "markers", str(marker), "nodes"), text)
        owner |= {node: str(marker) for node in own if node not in owner}
