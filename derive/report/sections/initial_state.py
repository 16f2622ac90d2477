"""The initial state of a scene: the values that its specification gives, those that it has, and its equilibrium."""

from __future__ import annotations

from derive.report.document.page import Block, Cell, CodeSpan, Content, Heading, Paragraph, folded, table
from derive.simulation.initial.contradictions import InitialValue
from derive.simulation.initial.initial_state import InitialState

KEPT = "The initial state meets the joints and drives and keeps the values in the specification"
ADAPTED = (
    " Positions that are not specified are as near as possible to the first guesses. Velocities that are not specified "
    "have the least kinetic energy."
)


def initial_state_blocks(initial: InitialState | str) -> tuple[Block, ...]:
    """The blocks of an initial state, or of the text that says why there is none."""
    heading = Heading("Initial state", "initial")
    if isinstance(initial, str):
        return heading, Paragraph((f"The initial state cannot be computed: {initial}",))
    corrected = ", and corrects values that contradict each other by rounding" if initial.corrections else ""
    blocks: list[Block] = [heading, Paragraph((f"{KEPT}{corrected}.{ADAPTED}",))]
    if of := initial.equilibrium or initial.steady:
        text = str(of)
        blocks.append(
            Paragraph((f"The scene begins in its {text}. The positions in the specification are its first guess.",))
        )
    if initial.values:
        head = ("key", "specified", "initial state", "unit", "")
        rows = [_row(value) for value in initial.values]
        blocks.append(folded(table("Initial values", head, rows, "lrrll"), "Initial values"))
    return tuple(blocks)


def _row(value: InitialValue) -> list[Content]:
    remark = "corrected" if value.corrected else "first guess" if value.guess else "kept"
    state = Cell((f"{value.value:.9g}",), mark="bad" if value.corrected else "")
    return [CodeSpan(value.name), f"{value.specified:.9g}", state, value.unit, remark]
