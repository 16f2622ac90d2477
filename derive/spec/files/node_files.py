"""The arrays of a body of nodes as files contain them: NumPy archives and MatrixMarket, none of it trusted."""

from __future__ import annotations

import hashlib
import io
import os
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.sparse

from derive.errors import printable, quoted
from derive.spec.files.file_content import file_content
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.files.node_format import FILES, MESH, is_of_mesh
from derive.spec.model.node_data import NodeData
from derive.spec.parsing.faults import Fault, Faults, KeyPath, unknown_key
from derive.spec.parsing.values import WrongValueError, kind_of

MAX_BYTES = 1_000_000_000
MAX_ARRAYS = 2000
NODES = ("body", "nodes")
SPARSE = ("mass", "stiffness")
PARTS = ("row", "col", "value")
ARRAYS = (*FILES, *(f"{key}_{part}" for key in SPARSE for part in PARTS))
"""The arrays that an archive may hold: those of FILES, and matrices as rows, columns and values of their entries."""

Array = Any
"""A NumPy array or a sparse matrix of SciPy."""


@dataclass(frozen=True)
class FoundArrays:
    """The arrays that are there, None if one cannot be read, and the SHA-256 of their bytes."""

    arrays: dict[str, Array | None]
    sha256: str
    faults: Faults

    @property
    def complete(self) -> bool:
        """Whether an array that is not among `arrays` is missing in the data, and not merely unreadable."""
        return bool(self.arrays) or not self.faults


def read_nodes(nodes: object, folder: Path) -> FoundArrays:
    """The arrays of a .npz file, of a table of MatrixMarket files, or of arrays that are given in Python."""
    if isinstance(nodes, NodeData):
        given = {f.name: getattr(nodes, f.name) for f in fields(nodes) if f.name in FILES}
        arrays = {key: array for key, array in given.items() if array is not None}
        return FoundArrays(arrays | mesh_arrays(nodes.mesh), nodes.sha256, Faults())
    if isinstance(nodes, (str, os.PathLike)):
        return archive(nodes, folder)
    if isinstance(nodes, Mapping):
        return _table(nodes, folder)
    wanted = 'a file is needed, such as "block.npz", or a table such as { positions = "x.mtx", mass = "m.mtx" }'
    return FoundArrays({}, "", Faults([Fault(NODES, f"{wanted}, not {kind_of(nodes)}")]))


_MAX_MB = MAX_BYTES // 1_000_000
_SMALLER = ", the most that is read; store matrices as the entries that are not zero"


def archive(
    name: str | os.PathLike[str], folder: Path, known: tuple[str, ...] = ARRAYS, path: KeyPath = NODES
) -> FoundArrays:
    """The arrays in a .npz file. known: their names; path: that of the key with the name of the file, for faults."""
    faults = Faults()
    arrays: dict[str, Array | None] = {}
    content = b""
    with faults.at(*path):
        content = file_content(name, folder, MAX_BYTES, _SMALLER)
        try:
            _check_archive(content, quoted(os.fsdecode(name)), known)
            with np.load(io.BytesIO(content), allow_pickle=False) as file:
                _members(file, known, path, arrays, faults)
        except (zipfile.BadZipFile, zlib.error, OSError, EOFError, NotImplementedError, RuntimeError) as error:
            raise WrongValueError(f"the file {quoted(os.fsdecode(name))} is damaged: {_why(error)}") from None
    return FoundArrays(arrays, hashlib.sha256(content).hexdigest(), faults)


def _check_archive(content: bytes, name: str, known: tuple[str, ...]) -> None:
    """Raise WrongValueError for what is no .npz file, and for one that is too large."""
    if not zipfile.is_zipfile(io.BytesIO(content)):
        alone = content.startswith(b"\x93NUMPY")
        matrices = '; MatrixMarket files go in a table: { positions = "x.mtx", mass = "m.mtx" }'
        raise WrongValueError(
            f"{name} is no .npz file"
            + ("; it holds a single array: save all of them in one file with numpy.savez" if alone else "")
            + (matrices if not alone and known == ARRAYS else "")
        )
    with zipfile.ZipFile(io.BytesIO(content)) as zipped:
        members = zipped.infolist()
    others = [member for member in members if not is_of_mesh(member.filename.removesuffix(".npy"))]
    if len(others) > 2 * len(known) or len(members) > MAX_ARRAYS:
        raise WrongValueError(f"{name} holds {len(members)} arrays; those that are known are {', '.join(known)}")
    if sum(member.file_size for member in members) > MAX_BYTES:
        raise WrongValueError(f"{name} unpacks to more than {_MAX_MB} MB{_SMALLER}")


def _members(file: Any, known: tuple[str, ...], path: KeyPath, arrays: dict[str, Array | None], faults: Faults) -> None:
    """Read the arrays of an opened file into `arrays`, with the faults of each."""
    for key in file.files:
        if key not in known and not (known == ARRAYS and is_of_mesh(key)):
            faults.append(Fault((*path, key), unknown_key(key, (*known, *(MESH if known == ARRAYS else ())))))
            continue
        if key in arrays:
            faults.append(Fault((*path, key), "this array is in the file twice; keep one"))
        arrays[key] = None
        with faults.at(*path, key):
            arrays[key] = _member(file, key)


DAMAGED = (
    *(ValueError, TypeError, LookupError, AttributeError, OverflowError, MemoryError),
    *(SyntaxError, RecursionError, tokenize.TokenError),
)
"""The errors that NumPy raises where the header of an array, a text in Python syntax, is damaged."""


def _member(file: Mapping[str, Array], key: str) -> Array:
    try:
        array = file[key]
    except DAMAGED as error:
        if "Object arrays" in str(error):
            raise WrongValueError("this holds Python objects, which are not read; save an array of numbers") from None
        raise WrongValueError(f"this array is damaged: {_why(error)}") from None
    if not isinstance(array, np.ndarray):
        raise WrongValueError("this is no array; save it with numpy.savez")
    return array


def _table(nodes: Mapping[object, object], folder: Path) -> FoundArrays:
    """The arrays in MatrixMarket files, and arrays that are given in Python."""
    faults = Faults()
    arrays: dict[str, Array | None] = {}
    digest = hashlib.sha256()
    for key in nodes:
        known = (*ARRAYS, *MESH) if _is_array(nodes[key]) else tuple(FILES)
        if key not in known and not (_is_array(nodes[key]) and is_of_mesh(str(key))):
            faults.append(Fault((*NODES, str(key)), unknown_key(str(key), known)))
    for key in (*ARRAYS, *(str(key) for key in nodes if is_of_mesh(str(key)))):
        value = nodes.get(key)
        if _is_array(value):
            arrays[key] = value
            _add(digest, value)
        elif key in FILES and key in nodes:
            arrays[key] = None
            with faults.at(*NODES, key):
                if not isinstance(value, (str, os.PathLike)):
                    raise WrongValueError(
                        f'a file in quotation marks is needed, such as "{key}.mtx", not {kind_of(value)}'
                    )
                content = file_content(value, folder, MAX_BYTES, _SMALLER)
                digest.update(content)
                arrays[key] = _matrix_market(content, quoted(os.fsdecode(value)))
    return FoundArrays(arrays, digest.hexdigest(), faults)


def _is_array(value: object) -> bool:
    return isinstance(value, np.ndarray) or scipy.sparse.issparse(value)


def _add(digest: Any, array: Array) -> None:
    """Add an array that is given in Python to the digest."""
    if scipy.sparse.issparse(array):
        entries = scipy.sparse.coo_array(array)
        parts = (*(index.astype("<i8") for index in entries.coords), entries.data)
    else:
        parts = (array,)
    for part in parts:
        digest.update(f"{part.shape}{part.dtype.str}".encode())
        digest.update(np.ascontiguousarray(part).tobytes() if part.dtype.kind != "O" else b"")


def _matrix_market(content: bytes, name: str) -> Array:
    """The matrix in a MatrixMarket file, as it is stored: dense or sparse."""
    try:
        rows, columns, entries, form, field, symmetry = scipy.io.mminfo(io.BytesIO(content))
    except (ValueError, OverflowError, OSError) as error:
        raise WrongValueError(f"{name} is no MatrixMarket file: {_why(error)}") from None
    if field in ("complex", "pattern"):
        kind = "complex numbers" if field == "complex" else "a pattern without numbers"
        raise WrongValueError(f"{name} holds {kind}; real numbers are needed")
    # A number takes two bytes at least, so that memory is asked for only if there is something to fill it.
    stored = entries if form == "coordinate" else rows * columns // 2
    if 2 * stored > len(content):
        raise WrongValueError(f"{name} ends before its {rows} x {columns} matrix does")
    try:
        matrix = scipy.io.mmread(io.BytesIO(content))
    except (ValueError, OverflowError, OSError, MemoryError) as error:
        raise WrongValueError(f"{name} cannot be read as MatrixMarket: {_why(error)}") from None
    if form == "coordinate" and symmetry != "general" and _has_duplicates(matrix):
        # What is above the diagonal is filled in from below, and would count twice.
        raise WrongValueError(f"{name} is {symmetry} and holds an entry twice; store the lower triangle alone")
    return matrix


def _has_duplicates(matrix: Array) -> bool:
    entries = scipy.sparse.coo_array(matrix)
    before = entries.nnz
    entries.sum_duplicates()
    return bool(entries.nnz < before)


def _why(error: Exception) -> str:
    text = printable(str(error).split("\n", 1)[0])[:200].rstrip(". ") or type(error).__name__
    return text[:1].lower() + text[1:]
