"""Faults of initial values: deflections that a beam cannot have, and coordinates that a joint does not have."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import ValidationError

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.checks.name_clashes import piece_counts
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.model.beam_parts import ShapeFamily
from derive.spec.parsing import values
from derive.spec.parsing.faults import Fault, readable
from derive.spec.tables.beam import DEFLECTION


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
    from derive.mechanics.bodies.reference_conditions import ConditionError, assumed_shapes, piece_deflection

    try:
        shapes = assumed_shapes(deflection)
    except ConditionError:
        return
    combination = "1, xi and the ansatz: add its powers to `ansatz`"
    if isinstance(deflection.ansatz, ShapeFamily):
        combination = "1 and xi, for families of shape functions hold no polynomials"
    nearest = "; or write `guess = true`, which takes the nearest curve that they have"
    for key in ("deflection", "deflection_rate"):
        curve = readable(values.shape, start[key]) if key in start else None
        if curve is None:
            continue
        for pieces in piece_counts(view, name, body):
            if any(piece_deflection(curve, shapes, pieces, k) is None for k in range(pieces)):
                cut = f" in {pieces} pieces" if pieces > 1 else ""
                text = f"the shape functions of {name}{cut} cannot describe this curve; it must be a combination of "
                yield Fault(("bodies", name, "start", key), text + combination + nearest)
                break


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
