"""Faults of initial values: deflections that a beam cannot have, and coordinates that a joint does not have."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from pydantic import ValidationError

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.checks.body_checks import both_deflections, torsion_ansatz
from derive.spec.checks.name_clashes import piece_counts
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.model.beam_parts import Polynomial, ShapeFamily
from derive.spec.parsing import values
from derive.spec.parsing.faults import Fault, KeyPath, readable
from derive.spec.tables.beam import DEFLECTION

if TYPE_CHECKING:
    from derive.mechanics.bodies.beam_functions import BeamFunction


def body_start_faults(view: SceneData, name: str, body: Raw) -> Iterator[Fault]:
    """Faults of deflections that the shapes of a beam cannot describe in one of the numbers of pieces in the scene."""
    start = body.get("start")
    if not isinstance(start, dict) or start.get("guess") is True:  # a guess is approached by the nearest curve
        return
    try:
        deflection = DEFLECTION.validate_python(body)
    except ValidationError:
        return
    # SymPy takes its time to import, which a specification that fails before has not to wait for.
    from derive.mechanics.bodies.reference_conditions import ConditionError, assumed_shapes

    try:
        shapes = assumed_shapes(deflection)
    except ConditionError:
        return
    combination = _combination(deflection.ansatz)
    for key in ("deflection", "deflection_rate"):
        curve = readable(values.shape, start[key]) if key in start else None
        if curve:
            path = ("bodies", name, "start", key)
            yield from _curve_faults(path, name, curve, shapes, piece_counts(view, name, body), combination)


def spatial_start_faults(view: SceneData, name: str, body: Raw) -> Iterator[Fault]:
    """Faults of deflections and twists that the shapes of a beam in space cannot describe."""
    start = body.get("start")
    if not isinstance(start, dict) or start.get("guess") is True:
        return
    try:
        deflections, torsion = both_deflections(body), torsion_ansatz(body)
    except ValidationError:
        return
    from derive.mechanics.bodies.displacement_fields import axial_shapes
    from derive.mechanics.bodies.reference_conditions import CONSTANT, assumed_shapes

    path, counts = ("bodies", name, "start"), piece_counts(view, name, body)
    for key in ("deflection", "deflection_rate"):
        pair = start.get(key)
        given = pair if isinstance(pair, (list, tuple)) and len(pair) == 2 else ()
        for i, (of_pair, deflection) in enumerate(zip(given, deflections, strict=False)):
            curve = readable(values.load_polynomial, of_pair)
            if curve:
                shapes, of = assumed_shapes(deflection), _combination(deflection.ansatz)
                yield from _curve_faults((*path, key, i), name, curve, shapes, counts, of)
    for key in ("twist", "twist_rate"):
        curve = readable(values.deflection, start[key]) if key in start else None
        if curve:
            frame = deflections[0]
            shapes = axial_shapes(torsion, frame.frame, frame.orthogonal) if torsion else ()
            of = "1 and the ansatz of torsion: add its powers to `torsion`"
            yield from _curve_faults((*path, key), name, curve, shapes, counts, of, CONSTANT)


def _combination(ansatz: tuple[Polynomial, ...] | ShapeFamily) -> str:
    """The words for the curves that an ansatz can describe."""
    if isinstance(ansatz, ShapeFamily):
        return "1 and xi, for families of shape functions hold no polynomials"
    return "1, xi and the ansatz: add its powers to `ansatz`"


def _curve_faults(
    path: KeyPath,
    name: str,
    curve: Polynomial,
    shapes: tuple[BeamFunction, ...],
    piece_counts: Iterable[int],
    combination: str,
    rigid: tuple[BeamFunction, ...] | None = None,
) -> Iterator[Fault]:
    """The fault of a curve that shapes cannot describe in one of some numbers of pieces of a beam."""
    from derive.mechanics.bodies.reference_conditions import LINE, piece_deflection

    nearest = "; or write `guess = true`, which takes the nearest curve that they have"
    for pieces in piece_counts:
        if any(piece_deflection(curve, shapes, pieces, k, rigid or LINE) is None for k in range(pieces)):
            cut = f" in {pieces} pieces" if pieces > 1 else ""
            text = f"the shape functions of {name}{cut} cannot describe this curve; it must be a combination of "
            yield Fault(path, text + combination + nearest)
            return


def joint_start_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of initial values of joints and drives for coordinates that their joints do not have."""
    joints = view.tables["joints"]
    for section, of_joint in (("joints", None), ("drives", "joint")):
        for name, table in view.tables[section].items():
            start, joint = table.get("start"), name if of_joint is None else str(table.get(of_joint))
            joint_type = JOINTS.get(str(joints.get(joint, {}).get("kind")))
            if not isinstance(start, dict) or joint_type is None:
                continue
            path = (section, name, "start")
            if joint_type.driven is None:
                if of_joint is None and start:
                    yield Fault(path, "this joint has no relative coordinate that could have initial values")
                continue
            wrong, right = ("displacement", "angle") if joint_type.driven.unit == "rad" else ("angle", "displacement")
            if wrong in start:
                kind = joints[joint]["kind"]
                yield Fault((*path, wrong), f"the {kind} joint {joint} has no {wrong}; write `{right}` instead")
