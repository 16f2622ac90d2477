"""The frame of a body in space: the conditions on its modes, and how well they were met."""

from __future__ import annotations

from collections.abc import Sequence

from derive.report.document.formula import Equation, Number
from derive.report.document.page import Block, Heading, Paragraph
from derive.report.document.page import Equations as Lines
from derive.report.document.tables import Said, table
from derive.report.notation.formula_reader import equation
from derive.spec.model.body import NodalBody, SymbolicBody

MEAN = "The frame follows the mean motion: no mode displaces the body or turns it on average."
GIVEN = "The modes are used as they are given; no condition is imposed on them."


def body_frame_blocks(spec: NodalBody | SymbolicBody, notes: Sequence[str]) -> tuple[Block, ...]:
    """What is asked of the modes, and, of a body of nodes, how far they were from it."""
    kind = spec.frame if isinstance(spec, SymbolicBody) else spec.frame.kind
    found: list[Block] = [Heading("The frame and what it removes", "frame")]
    if kind == "mean":
        found += [Paragraph((MEAN,)), Lines((_line("17", "int_Omega rho Phi_i dOmega = 0"), _rotation()))]
    elif kind == "point":
        assert isinstance(spec, NodalBody)
        said = (
            f"The frame is held by node {spec.frame.node}: no mode displaces it, nor turns it and its neighbours on "
            "average."
        )
        found += [Paragraph((said,)), Lines((_line("16", "Phi_i(P_c) = 0"),))]
    else:
        found.append(Paragraph((GIVEN,)))
    if isinstance(spec, NodalBody):
        found += _residuals(spec)
    return (*found, *(Paragraph((note.removeprefix("warning: "),)) for note in notes if note.startswith("warning")))


def _line(number: str, text: str) -> Equation:
    line = equation(text)
    return Equation(line.left, line.parts, line.relation, number)


def _rotation() -> Equation:
    return _line("19", "int_Omega rho X >< Phi_i dOmega = 0")


def _residuals(spec: NodalBody) -> list[Block]:
    """Numbers without units, before and after the modes were brought to the frame."""
    from derive.reduction import residuals

    found = residuals(spec)
    rows: list[list[Said]] = [
        ["mean displacement of a mode, of its size (17)", *_both(found.before.displacement, found.after.displacement)],
        ["mean rotation of a mode, of its size (19)", *_both(found.before.rotation, found.after.rotation)],
        ["distance of O from the centre of mass", *_both(found.before.centre, found.after.centre)],
    ]
    return [table("How far the modes are from the mean frame", ("", "as given", "as used"), rows, "lrr")]


def _both(before: float, after: float) -> tuple[Number, Number]:
    return Number(f"{before:.1e}"), Number(f"{after:.1e}")
