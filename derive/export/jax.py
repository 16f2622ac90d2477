"""`--to jax`: a Python module without branches on data, for JAX and for other arrays."""

from __future__ import annotations

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE, description, model_text, pattern_texts
from derive.backends.python.constants import spline_functions
from derive.backends.python.module import Failure
from derive.backends.wrapping import prefixed
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.straight_line import straight_line_functions
from derive.rendering import render


def jax_files(host: HostModel) -> tuple[File, ...]:
    """The module of a model. Raises SpecError for a model with loops."""
    model = host.model
    values = {
        "mark": f"# {MARK}. Do not edit.\n# {LICENCE}",
        "description": "\n".join(prefixed(description(model_text(model)), "")),
        "model": model,
        "host": host,
        "patterns": pattern_texts(model, "        "),
        "spline": render("python/spline.py.jinja", {"numbers": False}).strip() if model.splines else "",
        "splines": spline_functions(model),
        "functions": straight_line_functions(model, Failure.NAN),
        "scene": host.is_scene,
    }
    return File(f"{host.name}.py", render("export/jax/module.py.jinja", values)), File(
        "manifest.json", host.manifest.text
    )


SLOW = (
    "jax.jit unrolls the loops over bodies, and its compiler takes minutes for some eight bodies: call the functions "
    "without jit, or with arrays of NumPy"
)


def _notes(host: HostModel) -> tuple[str, ...]:
    return (SLOW,) if host.model.lowering == "instances" else ()


JAX = Interface(
    "JAX and other arrays: a Python module that can be traced, compiled, differentiated and vectorised",
    jax_files,
    "import {name} in Python with {folder} in the path; then jax.jit({name}.rhs), jax.grad, jax.vmap",
    notes=_notes,
)
