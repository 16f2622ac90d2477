"""The constraints g = 0 of a joint and of its drive, with the parts of their first and second time derivatives."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.multibody.point_motion import Derivatives, RelativeMotion, added
from derive.mechanics.terms import Constraint, EquationOfMotion, Intermediate
from derive.spec.model.instances import identifier, joined
from derive.spec.model.joints import Joint

if TYPE_CHECKING:
    from derive.mechanics.multibody.joints.joint_type import JointType, PrescribedMotion


def constraints(
    joint: Joint,
    joint_type: JointType,
    relative: RelativeMotion,
    drive: PrescribedMotion | None,
    rows: tuple[EquationOfMotion, ...],
) -> tuple[tuple[Intermediate, ...], tuple[Constraint, ...]]:
    """The constraints of a joint and of its drive, and the intermediate quantities in them.

    `relative` is the motion of its second marker relative to its first, `rows` are those of the whole mechanism.
    """
    equations = joint_type.equations(joint, relative)
    texts = {"markers": _markers(joint), "second": joint.second.body, "joint": joint.name}
    result = []
    for row, residual in zip(joint_type.removes, equations.residuals, strict=True):
        shown, doc = joined(joint.name, row.label), row.doc.format(**texts)
        result.append(_constraint(joint, shown, doc, row.unit, row.force_unit, residual, rows))
    if drive:
        driven = joint_type.driven
        assert driven is not None and equations.driven is not None, "the specification refuses other drives"
        residual = added(equations.driven, drive.motion, -1)
        doc = driven.drive_doc.format(drive=drive.name, **texts)
        result.append(_constraint(joint, drive.name, doc, driven.unit, driven.force_unit, residual, rows))
    return equations.definitions, tuple(result)


def _constraint(
    joint: Joint,
    shown: str,
    doc: str,
    unit: str,
    force_unit: str,
    residual: Derivatives,
    rows: tuple[EquationOfMotion, ...],
) -> Constraint:
    position, rate, second = residual
    second = sp.expand(second)
    present = second.free_symbols
    factors = ((row, second.coeff(row.a)) for row in rows if row.a in present)
    return Constraint(
        name=identifier(shown),
        shown=shown,
        of=joint.name,
        doc=doc,
        unit=unit,
        force_unit=force_unit,
        position=sp.expand(position),
        rate=sp.expand(rate),
        bias=second.xreplace({row.a: sp.S.Zero for row in rows if row.a in present}),
        jacobian=tuple((row.name, factor) for row, factor in factors if factor != 0),
    )


def _markers(joint: Joint) -> str:
    """The two markers of a joint as text."""
    return f"{joint.first} and {joint.second}"
