"""The files of a model: what its backends emit, and the manifest."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence
from fractions import Fraction
from importlib.metadata import version
from typing import Any

from derive.artifacts import MARK, File
from derive.backends.c.source import ABI, CBackend
from derive.backends.description import MODEL_HASH
from derive.backends.protocol import Backend
from derive.backends.python.backend import PythonBackend
from derive.ir.model import JACOBIAN, Model
from derive.registry import Registry
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import DisplacementOrder, NodalBody, SymbolicBody
from derive.spec.model.mesh import NodeMesh
from derive.spec.model.node_data import NodeData
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import InitialValues, SpatialStart
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import Specification, check_specification
from derive.spec.model.time_function import Spline, TimeFunction
from derive.version import VERSION

BACKENDS: Registry[Backend] = Registry("backend", {"c": CBackend(), "python": PythonBackend()})
"""The backends by their names."""


def emit(model: Model, spec: Specification, backends: Sequence[str] = ("c", "python")) -> tuple[File, ...]:
    """The files that the backends of these names emit for a model, and the manifest.

    spec: the specification that the model was made from. Raises UnknownNameError for a name that is not in BACKENDS.
    """
    files = _with_hash(tuple(file for name in backends for file in BACKENDS[name].files(model, fingerprint(spec))))
    return (*files, _manifest(model, spec, files))


def explicit_files(model: Model, spec: Specification) -> tuple[File, ...]:
    """The C of a model alone, which is all that explicit integration of it needs: no Python, no manifest, no batches.

    The iteration matrix of straight-line code is left out, if it is there, as only starts need it: it is interpreted in
    a hundredth of the time that the compiler takes.
    """
    return _with_hash(CBackend().files(_without_iteration_matrix(model), fingerprint(spec), batches=False))


def _without_iteration_matrix(model: Model) -> Model:
    if model.lowering != "flat" or model.inputs:
        return model
    return dataclasses.replace(model, kernels=tuple(k for k in model.kernels if k.name != JACOBIAN))


def fingerprint(spec: Specification) -> str:
    """The SHA-256 of all of a specification that its model depends on. Raises TypeError for anything else."""
    check_specification(spec)
    return hashlib.sha256(json.dumps(specification(spec), sort_keys=True).encode()).hexdigest()


def _with_hash(files: tuple[File, ...]) -> tuple[File, ...]:
    """The files with 16 digits of the SHA-256 of all their texts, by which compilers notice files of two builds."""
    digest = hashlib.sha256("".join(file.text for file in files).encode()).hexdigest()[:16]
    return tuple(dataclasses.replace(file, text=file.text.replace(MODEL_HASH, digest)) for file in files)


UNWRITTEN = (
    *("order", "ends", "masses", "axial", "lowering", "redundant"),
    *("rigid_sets", "component_modes", "interface", "interface_markers", "loaded_nodes"),
)
"""The fields that are left out where they have their defaults: those of the paper's beam, and of most scenes."""

OF_PICTURES = ("visuals", "ground_visuals", "stress")
"""The fields on which no model depends."""

KINDS = {
    PlanarBeam: "planar_beam",
    NodalBody: "nodal_body",
    SymbolicBody: "symbolic_body",
    Scene: "scene",
    SpatialScene: "spatial_scene",
}


def specification(spec: Specification) -> dict[str, object]:
    """A specification as plain data, exact numbers as text; of the numbers of nodes their sizes and their SHA-256."""
    fields = {name: value for name, value in _of_model(spec).items() if value or name not in ("inputs", "outputs")}
    plain = json.loads(json.dumps(fields, default=_exact))
    return {"kind": KINDS[type(spec)], **{key: value for key, value in plain.items() if value is not None}}


def _of_model(spec: Specification) -> dict[str, Any]:
    """The fields of a specification on which its model depends: not its simulation, plots and initial values."""
    return {
        name: value
        for name, value in _fields(spec).items()
        if name not in ("simulation", "plots") and not isinstance(value, InitialValues | SpatialStart)
    }


def _numbers_sha256(data: NodeData) -> str:
    """The SHA-256 of all numbers of nodes, which may be others than those of the files that they came from.

    Those of a sparse matrix are its shape, its columns, where its rows begin, and its values. Elements and materials
    are among them, which give bodies of second order their geometric stiffness.
    """
    digest = hashlib.sha256()
    for field in dataclasses.fields(data):
        value = getattr(data, field.name)
        if value is None or isinstance(value, str):
            continue
        if isinstance(value, NodeMesh):
            for block in value.elements:
                digest.update(f"{block.kind.value} {value.materials.get(block.material)} ".encode())
                digest.update(block.nodes.astype("<i8").tobytes())
            continue
        sparse = hasattr(value, "indptr")
        parts = (value.indices, value.indptr, value.data) if sparse else (value,)
        digest.update(f"{field.name} {value.shape} ".encode())
        for part in parts:
            digest.update(part.astype("<f8" if part.dtype.kind == "f" else "<i8").tobytes())
    return digest.hexdigest()


def _exact(value: object) -> object:
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, DisplacementOrder):
        return value.value
    if isinstance(value, BeamBody):  # the model of a scene does not depend on the fields of a single beam
        return {**_fields(value), "beam": _of_model(value.beam)}
    if isinstance(value, NodeData):
        modes = 0 if value.modes is None else len(value.modes)
        hashes = {"sha256": value.sha256, "numbers_sha256": _numbers_sha256(value)}
        return {"nodes": len(value.positions), "modes": modes, **hashes}
    if isinstance(value, Spline):
        numbers = repr((value.knots, value.coefficients)).encode()
        return {"name": value.name, "knots": len(value.knots), "sha256": hashlib.sha256(numbers).hexdigest()}
    if isinstance(value, TimeFunction):
        return {f.name: of for f in dataclasses.fields(value) if (of := getattr(value, f.name)) is not None}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _fields(value)
    raise TypeError(f"{value!r} is no plain data")


def _fields(value: Any) -> dict[str, Any]:
    """The fields of a dataclass, without those of UNWRITTEN that have their defaults."""
    every = ((f, getattr(value, f.name)) for f in dataclasses.fields(value) if f.name not in OF_PICTURES)
    return {f.name: item for f, item in every if f.name not in UNWRITTEN or item != f.default}


def _manifest(model: Model, spec: Specification, files: tuple[File, ...]) -> File:
    """The manifest: specification, tools, operation counts, non-zeros, and the hashes of the files."""
    from derive.backends.c.stack_use import stack_bytes
    from derive.backends.merged_instances import merged_instances

    mass = model.pattern("mass", "M")
    jacobian = model.pattern(JACOBIAN, "jac") if model.has_iteration_matrix else None
    content = {
        "generator": f"{MARK}. Do not edit.",
        "name": model.name,
        "specification": merged_instances(specification(spec)),
        "specification_sha256": fingerprint(spec),
        "abi": ABI,
        "tools": {"tisserand": VERSION, **{name: version(name) for name in ("sympy", "casadi", "jinja2")}},
        "lowering": {"kind": model.lowering, "choice": model.choice},
        "operations": {kernel.name: kernel.operations for kernel in model.kernels},
        "stack_bytes": {kernel.name: stack_bytes(kernel) for kernel in model.kernels},
        "nonzeros": {
            "mass": {"structural": mass.full_nnz, "of": mass.rows * mass.cols, "stored": len(mass.rowidx)},
            **(
                {"jacobian": {"structural": len(jacobian.rowidx), "of": jacobian.rows * jacobian.cols}}
                if jacobian
                else {}
            ),
        },
        **_of_scene(model),
        "files": {file.path: hashlib.sha256(file.text.encode()).hexdigest() for file in files},
    }
    return File(f"{model.name}/manifest.json", json.dumps(content, indent=2) + "\n")


def _of_scene(model: Model) -> dict[str, object]:
    """The additional entries of a scene: constraints, the structure of its KKT matrix, and what is eliminated."""
    if model.kkt is None:
        return {}
    jacobian = model.pattern("constraint_jacobian", "G")
    return {
        "scene": {
            "coordinates": len(model.coordinates),
            "constraints": len(model.multipliers),
            "constraint_jacobian": {"structural": len(jacobian.rowidx), "of": jacobian.rows * jacobian.cols},
            "kkt": {
                "structural": model.kkt.pattern.full_nnz,
                "of": model.kkt.pattern.rows**2,
                "fill_in": model.kkt.fill,
            },
            "left_out": {out.what: out.reason for out in model.eliminated},
        }
    }
