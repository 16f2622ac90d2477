"""The file of nodes (.npz) of a part, in the units of the part: the same bytes for the same numbers."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np
from scipy.sparse import csr_array, triu

from derive.fem.model import FiniteElementModel
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.files.node_format import ELEMENTS, SET
from derive.spec.model.mesh import NodeMesh

YEAR_OF_ZIP = (1980, 1, 1, 0, 0, 0)


def node_arrays(model: FiniteElementModel) -> dict[str, Any]:
    """The arrays of the file: matrices by the entries of one half, and the mesh."""
    arrays: dict[str, Any] = {"positions": model.positions}
    for name, matrix in (("mass", model.mass), ("stiffness", model.stiffness)):
        if matrix is not None:
            arrays |= _entries(name, _of_nodes(matrix) if name == "mass" else matrix)
    if model.stiffness is None and model.modal_stiffness is not None:
        arrays |= {"modes": model.modes, "modal_stiffness": model.modal_stiffness, **model.stiffening}
    if model.moments is not None:
        arrays["moments"] = model.moments
    mesh = NodeMesh(model.elements, model.materials, model.node_sets, model.node_numbers)
    of_mesh = mesh_arrays(mesh).items()
    return arrays | {key: a.astype(np.int32) if key.startswith((SET, ELEMENTS)) else a for key, a in of_mesh}


def _of_nodes(mass: csr_array) -> csr_array:
    """The mass matrix of one displacement of each node, if no mass couples two directions and the three are alike."""
    entries = mass.tocoo()
    if ((entries.row - entries.col) % 3 != 0).any():
        return mass  # the checks of bodies say what is wrong with it
    parts = [mass[axis::3][:, axis::3] for axis in range(3)]
    largest = np.abs(mass.data).max(initial=0.0)
    alike = all(np.abs((part - parts[0]).data).max(initial=0.0) <= 1e-12 * largest for part in parts[1:])
    return csr_array(parts[0]) if alike else mass


def _entries(name: str, matrix: csr_array) -> dict[str, Any]:
    half = triu(matrix, format="coo")
    row, col = (index.astype(np.int32) for index in (half.row, half.col))
    return {f"{name}_row": row, f"{name}_col": col, f"{name}_value": half.data}


def archive_bytes(arrays: dict[str, Any]) -> bytes:
    """The content of the file."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.save(member, array, allow_pickle=False)
            info = zipfile.ZipInfo(f"{name}.npy", YEAR_OF_ZIP)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, member.getvalue())
    return content.getvalue()
