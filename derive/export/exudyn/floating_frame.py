"""`--to exudyn-ffrf`: the shape integrals of a body in space for ObjectFFRFreducedOrder of Exudyn."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.errors import Problem, SpecError
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.mechanics.bodies.modal_body import Array, ModalBody
from derive.reduction.body import reduce
from derive.rendering import render
from derive.spec.model.body import NodalBody
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.scene import Scene

IN_SPACE = "the floating-frame body of Exudyn is one in space: give the body by its nodes, or use --to exudyn"
ALONE = (
    "a floating-frame body of Exudyn is a single body, without the joints and forces of a scene: write the "
    "finite-element body as [body] in a specification of its own, or export the whole scene with --to exudyn"
)
NO_MODES = "the floating-frame body of Exudyn has modes and nodes: give the body a mode and a marker at least"
FIRST_ORDER = "the floating-frame body of Exudyn has displacements of first order: order = 1, or use --to exudyn"


def floating_frame_arguments(body: ModalBody) -> dict[str, Array]:
    """The arguments of ObjectFFRFreducedOrder that a body of first order with N modes determines, by their names.

    With a~ b = a x b, Exudyn has the integrals of X~^T Phi_i = -X x Phi_i, of X~^T Phi_i~ = (X . Phi_i) I - Phi_i X,
    and of the same with Phi_j in place of X, as blocks of matrices. The nodes of its mode basis are the points.
    """
    n = body.modes
    return {
        "mass": np.array(body.mass),
        "centerOfMass": body.c1 / body.mass,
        "inertia": body.C3,
        "massMatrixReduced": body.c8,
        "stiffnessMatrixReduced": body.stiffness,
        "dampingMatrixReduced": body.damping,
        "mPhitTPsi": body.c2.T,
        "mPhitTPsiTilde": np.hstack([_skew(c2) for c2 in body.c2]),
        "mXRefTildePsi": -body.c6.T,
        "mXRefTildePsiTilde": np.hstack(list(body.C4)),
        "mPsiTildePsi": -body.c7.transpose(0, 2, 1).reshape(3 * n, n),
        "mPsiTildePsiTilde": body.C5.transpose(1, 2, 0, 3).reshape(3 * n, 3 * n),
        "referencePositions": np.array([point.position for point in body.points]).reshape(-1),
        "modeBasis": np.array([point.shapes.T for point in body.points]).reshape(-1, n),
    }


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def floating_frame_files(host: HostModel) -> tuple[File, ...]:
    """The module that adds the body. Raises SpecError for a scene and for a body of second order or without modes."""
    spec = host.spec
    if not isinstance(spec, NodalBody):
        raise SpecError((Problem("", IN_SPACE if isinstance(spec, Scene) else ALONE),))
    if spec.second_order:
        raise SpecError((Problem("body.order", FIRST_ORDER),))
    body = reduce(spec)
    if not body.modes or not body.points:
        raise SpecError((Problem("body", NO_MODES),))
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": host.name,
        "title": host.model.doc,
        "points": [point.name for point in body.points],
        "arguments": [(name, _literal(array)) for name, array in floating_frame_arguments(body).items()],
        "gravity": [_number(component) for component in spec.gravity or ()],
        "host": host,
    }
    return (
        File(f"{host.name}_ffrf.py", render("export/exudyn/floating_frame.py.jinja", values)),
        File("manifest.json", host.manifest.text),
    )


def _number(component: Quantity) -> float:
    return float(component.default if isinstance(component, Parameter) else component)


def _literal(array: Array) -> str:
    """A number, or nested lists of numbers, on lines."""
    if array.ndim == 0:
        return repr(float(array))
    return "[\n" + "\n".join(prefixed([", ".join(_rows(array)) + ","], "        ")) + "\n    ]"


def _rows(array: Array) -> Iterable[str]:
    plain = (array + 0.0).tolist()
    return map(repr, plain) if array.ndim == 1 else ("[" + ", ".join(map(repr, row)) + "]" for row in plain)


EXUDYN_FFRF = Interface(
    "Exudyn: the shape integrals of a body in space for its own floating-frame body",
    floating_frame_files,
    "import {name}_ffrf in Python with {folder} in the path; then {name}_ffrf.add(mbs)",
)
