"""Forces at nodes in CSV and .npz files, in place of lists in a specification; none of them is trusted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from derive.errors import quoted
from derive.spec.files.file_content import file_content
from derive.spec.files.reference_curves import MAX_BYTES, csv_column, csv_number, csv_rows
from derive.spec.parsing.faults import Faults, KeyPath
from derive.spec.parsing.values import WrongValueError

COLUMNS = ("node", "x", "y", "z")
"""The columns of a file: the number of a node, and the components of the force there, N."""
ARRAYS = ("nodes", "forces")
"""The arrays of a .npz file."""
MAX_LOADED = 20_000
"""The largest number of nodes of a load."""
UNREAD: Mapping[str, Any] = {"nodes": [0], "forces": [[0, 0, 1]]}
"""The nodes and forces of a load whose file has a fault, so that nothing else is reported of it."""


def with_nodal_forces(data: Mapping[str, Any], folder: Path) -> tuple[Mapping[str, Any], Faults]:
    """The data of a scene in which the files of loads are replaced by their nodes and forces, with their faults.

    Files are relative to `folder`.
    """
    faults, bodies = Faults(), data.get("bodies")
    if not isinstance(bodies, Mapping):
        return data, faults
    changed: dict[str, Any] = {}
    for name, body in bodies.items():
        loads = body.get("loads") if isinstance(body, Mapping) else None
        if isinstance(loads, Mapping):
            path = ("bodies", str(name), "loads")
            read = {key: _with_forces(load, folder, (*path, str(key)), faults) for key, load in loads.items()}
            changed[name] = {**body, "loads": read}
    return ({**data, "bodies": {**bodies, **changed}}, faults) if changed else (data, faults)


def _with_forces(load: Any, folder: Path, path: KeyPath, faults: Faults) -> Any:
    """A load with the nodes and the forces of its file, if it has one."""
    if not isinstance(load, Mapping) or "file" not in load:
        return load
    rest = {key: value for key, value in load.items() if key not in ("file", "nodes", "forces")}
    with faults.at(*path, "file"):
        if "nodes" in load or "forces" in load:
            raise WrongValueError("the file has the nodes and the forces; leave `nodes` and `forces` out, or the file")
        return {**rest, **_forces(load["file"], folder, (*path, "file"))}
    return {**rest, **UNREAD}


def _forces(name: object, folder: Path, path: KeyPath) -> Mapping[str, Any]:
    """The nodes and the forces in a file, as exact numbers in text."""
    if not isinstance(name, str) or not name:
        raise WrongValueError('the name of a CSV or a .npz file is needed, such as "pressure.csv"')
    return _of_arrays(name, folder, path) if name.endswith(".npz") else _of_rows(name, folder)


def _of_arrays(name: str, folder: Path, path: KeyPath) -> Mapping[str, Any]:
    """The nodes (n,) and the forces (n, 3) of a .npz file: the shortest decimals that are these doubles."""
    import numpy as np  # not for specifications without such files

    from derive.spec.files.node_files import archive

    found, file = archive(name, folder, ARRAYS, path), quoted(name)
    if found.faults:
        of_arrays = ((f"{fault.path[-1]}: " if fault.path != path else "", fault.message) for fault in found.faults)
        raise WrongValueError("; ".join(f"{array}{message}" for array, message in of_arrays))
    missing = [key for key in ARRAYS if key not in found.arrays]
    if missing:
        raise WrongValueError(f"{file} has no array {quoted(missing[0])}; it needs nodes (n,) and forces (n, 3), in N")
    nodes, forces = (np.asarray(found.arrays[key]) for key in ARRAYS)
    if nodes.ndim != 1 or nodes.dtype.kind not in "iu":
        raise WrongValueError(f"nodes in {file} are {nodes.dtype.name} {nodes.shape}; whole numbers (n,) are needed")
    if forces.dtype.kind not in "fiu" or forces.shape != (len(nodes), 3):
        numbers = f"numbers ({len(nodes)}, 3)"
        raise WrongValueError(f"forces in {file} are {forces.dtype.name} {forces.shape}; {numbers} are needed")
    if len(nodes) > MAX_LOADED:
        raise WrongValueError(f"{file} has {len(nodes)} nodes, and at most {MAX_LOADED} are read")
    if (nodes < 0).any():
        raise WrongValueError(f"nodes in {file}: {nodes.min()} is no number of a node; nodes count from 0")
    if not np.isfinite(forces).all():
        raise WrongValueError(f"forces in {file} have a component that is no finite number")
    return {"nodes": nodes.tolist(), "forces": [[repr(x) for x in force] for force in forces.tolist()]}


def _of_rows(name: str, folder: Path) -> Mapping[str, Any]:
    """The nodes and the forces in the rows of a CSV file."""
    file = quoted(name)
    table = csv_rows(file_content(name, folder, MAX_BYTES, ", the most that is read"), file, "forces", 1)
    if len(table) - 1 > MAX_LOADED:
        raise WrongValueError(f"{file} has {len(table) - 1} nodes, and at most {MAX_LOADED} are read")
    node, *axes = (csv_column(column, table, file) for column in COLUMNS)
    nodes, forces = [], []
    for line, row in table[1:]:
        number = csv_number(row, node, line, file)
        if number < 0 or number != int(number):
            raise WrongValueError(f"line {line} of {file}: {row[node]} is no number of a node; nodes count from 0")
        nodes.append(int(number))
        for axis in axes:
            csv_number(row, axis, line, file)
        forces.append([row[axis] for axis in axes])
    return {"nodes": nodes, "forces": forces}
