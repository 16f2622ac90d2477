"""`--to exudyn`: a model as an object of Exudyn with user functions in C, and the Python module that adds it."""

from __future__ import annotations

from collections.abc import Iterator

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.reference_motion import ACCEPTED, reference_motion
from derive.export.straight_line import require_straight_line
from derive.ir.model import Model
from derive.rendering import render
from derive.roles import Role

MANY = 100
"""Coordinates from which on the sample takes sparse matrices of Exudyn."""


def exudyn_files(host: HostModel) -> tuple[File, ...]:
    """The C of a model and of its user functions, the module that adds them to a system, and a sample program.

    Raises SpecError for a model with loops, and what the integration of the reference motion raises.
    """
    model, name = host.model, host.name
    require_straight_line(model)
    motion, quaternions = reference_motion(host), tuple(_quaternions(model))
    multipliers = len(host.multipliers)
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": name,
        "macro": name.upper(),
        "title": model.doc,
        "host": host,
        "scene": host.is_scene,
        "quaternions": quaternions,
        "constraints": multipliers + len(quaternions),
        "dimension": 3 if quaternions or model.in_space else 2,
        "points": bool(model.markers),
        "inputs": list(_inputs(host)),
        "sizes": {
            "q": len(host.coordinates),
            "multipliers": multipliers,
            "inputs": len(host.inputs),
            "outputs": len(host.outputs),
            "parameters": len(host.parameters),
            "constants": sum(constant.size for constant in model.constants),
            "nonzeros": max(_values(model)),
        },
        "sparse": len(host.coordinates) > MANY,
        "times": motion.times.tolist(),
        "states": motion.states.tolist(),
        "scales": (motion.tolerances / ACCEPTED).tolist(),
    }
    return (
        File(f"{name}.h", host.header.text),
        File(f"{name}.c", host.source.text),
        File(f"{name}_exudyn.c", render("export/exudyn/body.c.jinja", values)),
        File(f"{name}_exudyn.py", render("export/exudyn/module.py.jinja", values)),
        File("sample.py", render("export/exudyn/sample.py.jinja", values)),
        File("manifest.json", host.manifest.text),
    )


def _quaternions(model: Model) -> Iterator[int]:
    """The positions of the first elements of quaternions in q."""
    place, within = 0, 0
    for coordinate in model.coordinates:
        for _ in range(coordinate.size):
            if coordinate.role is Role.QUATERNION:
                if within % QUATERNION_SIZE == 0:
                    yield place
                within += 1
            place += 1


QUATERNION_SIZE = 4


def _values(model: Model) -> Iterator[int]:
    """The numbers of values of the sparse matrices that the user functions expand."""
    named = [("mass", "M"), ("jacobian", "jac"), *((f"marker_{marker.name}", "jacobian") for marker in model.markers)]
    if model.is_scene:
        named.append(("constraint_jacobian", "G"))
    for kernel, output in named:
        yield len(model.pattern(kernel, output).rowidx)


def _inputs(host: HostModel) -> Iterator[tuple[str, int, tuple[float, ...]]]:
    """The name of each input, the position of its first value in u, and its values in a host that keeps it constant."""
    first, inputs = 0, host.constant_inputs
    while first < len(inputs):
        end = first + 1
        while end < len(inputs) and host.inputs[end].derivative > 0:
            end += 1
        yield host.inputs[first].name, first, inputs[first:end]
        first = end


EXUDYN = Interface(
    "Exudyn: an object with user functions in C, with the joints of the model and points for others",
    exudyn_files,
    "cc -O2 -shared -fPIC {folder}/{name}_exudyn.c {folder}/{name}.c -o {name}.so -lm, then "
    "python {folder}/sample.py ./{name}.so",
)
