"""A model to files: the third arrow of the house."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from fractions import Fraction
from importlib.metadata import version

from derive.emit.c import ABI, c_files
from derive.emit.files import MARK, File
from derive.emit.python import python_file
from derive.kernel.model import Model
from derive.spec.body import PlanarBeam
from derive.version import VERSION


def model_files(model: Model, spec: PlanarBeam) -> tuple[File, ...]:
    """The C, the Python and the manifest of a model; `spec` is what it was made from."""
    description = specification(spec)
    fingerprint = hashlib.sha256(json.dumps(description, sort_keys=True).encode()).hexdigest()
    files = (*c_files(model, fingerprint), python_file(model, fingerprint))
    return (*files, _manifest(model, description, fingerprint, files))


def specification(spec: PlanarBeam) -> dict[str, object]:
    """A specification as plain data, exact numbers as text."""
    plain = json.loads(json.dumps(asdict(spec), default=_exact))
    return {"kind": "planar_beam", **plain}


def _exact(value: object) -> str:
    if isinstance(value, Fraction):
        return str(value)
    raise TypeError(f"{value!r} is no plain data")


def _manifest(model: Model, description: dict[str, object], fingerprint: str, files: tuple[File, ...]) -> File:
    """What was made, from what, by which tools, at what cost."""
    mass, jacobian = model.pattern("mass", "M"), model.pattern("jacobian", "jac")
    content = {
        "generator": f"{MARK}. Do not edit.",
        "name": model.name,
        "specification": description,
        "specification_sha256": fingerprint,
        "abi": ABI,
        "tools": {"tisserand": VERSION, **{name: version(name) for name in ("sympy", "casadi", "jinja2")}},
        "operations": {kernel.name: kernel.operations for kernel in model.kernels},
        "nonzeros": {
            "mass": {"structural": mass.full_nnz, "of": mass.rows * mass.cols, "stored": len(mass.rowidx)},
            "jacobian": {"structural": len(jacobian.rowidx), "of": jacobian.rows * jacobian.cols},
        },
        "files": {file.path: hashlib.sha256(file.text.encode()).hexdigest() for file in files},
    }
    return File(f"{model.name}/manifest.json", json.dumps(content, indent=2) + "\n")
