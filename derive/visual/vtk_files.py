"""The fields of a finite-element body as files of VTK: a .vtu file for each instant, and a .pvd file with their times.

ParaView opens the .pvd file and plays it. The format is a few lines of XML with arrays in base64, so that no library is
needed: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html.
"""

from __future__ import annotations

import zlib
from base64 import b64encode
from collections.abc import Sequence
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from derive.artifacts import MARK
from derive.simulation.observables.fields import FieldInstant
from derive.solids.element_shapes import element_shape
from derive.spec.model.mesh import NodeMesh

TYPES = {"f4": "Float32", "i4": "Int32", "u1": "UInt8"}
HEAD = f'<?xml version="1.0"?>\n<!-- {MARK}. Do not edit. -->\n'


def vtu(mesh: NodeMesh, fields: FieldInstant) -> str:
    """The text of a .vtu file: the mesh at its places, with displacements and stresses at nodes, SI units."""
    blocks = [(element_shape(block.kind).vtk, block.nodes) for block in mesh.elements]
    sizes = np.concatenate([np.full(len(nodes), nodes.shape[1]) for _, nodes in blocks])
    cells = [
        _array("connectivity", np.concatenate([nodes.ravel() for _, nodes in blocks]), "i4"),
        _array("offsets", np.cumsum(sizes), "i4"),
        _array("types", np.concatenate([np.full(len(nodes), number) for number, nodes in blocks]), "u1"),
    ]
    data = [_array("displacement", fields.displacements, "f4")]
    attributes = 'Vectors="displacement"'
    if fields.stresses is not None and fields.von_mises is not None:
        data += [_array("von_mises", fields.von_mises, "f4"), _array("stress", fields.stresses, "f4")]
        attributes += ' Scalars="von_mises" Tensors="stress"'
    return "\n".join(
        [
            HEAD + '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" '
            'compressor="vtkZLibDataCompressor">',
            f'<UnstructuredGrid><Piece NumberOfPoints="{len(fields.places)}" NumberOfCells="{len(sizes)}">',
            f"<Points>{_array('places', fields.places, 'f4')}</Points>",
            *("<Cells>", *cells, "</Cells>"),
            *(f"<PointData {attributes}>", *data, "</PointData>"),
            "</Piece></UnstructuredGrid></VTKFile>\n",
        ]
    )


def pvd(files: Sequence[tuple[float, str]]) -> str:
    """The text of a .pvd file with the times, s, and the paths of the files of a series."""
    sets = [f'<DataSet timestep="{t:.17g}" part="0" file={quoteattr(path)}/>' for t, path in files]
    head = HEAD + '<VTKFile type="Collection" version="0.1"><Collection>'
    return "\n".join([head, *sets, "</Collection></VTKFile>\n"])


def _array(name: str, values: NDArray[np.generic], kind: str) -> str:
    """An array in one compressed block: its sizes, and the numbers, each in base64."""
    numbers = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
    packed = zlib.compress(numbers, 6)
    sizes = np.array([1, len(numbers), len(numbers), len(packed)], dtype="<u8").tobytes()
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    content = (b64encode(sizes) + b64encode(packed)).decode()
    return f'<DataArray type="{TYPES[kind]}" Name="{name}"{components} format="binary">{content}</DataArray>'
