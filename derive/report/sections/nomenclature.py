"""The nomenclature of a report: the symbols of the equations of motion, and the two meanings of the letter c."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from derive.report.document.formula import Name
from derive.report.document.page import Block, Content, Details, Heading, Paragraph, table
from derive.report.notation.formula_reader import formula, marked_text
from derive.spec.model.body import DisplacementOrder

Entry = tuple[str, str, str]
"""A symbol as the formula reader takes it, its meaning, and the equation or place of the paper that introduces it."""

POSITION: tuple[Entry, ...] = (
    ("x", "position of a material point in the inertial frame", "(1)"),
    ("X", "position of the point in the undeformed body, from O, in the floating frame", "(1)"),
    ("u", "displacement of the point due to deformation", "(1)"),
    ("r", "X + u, position in the deformed body", "(2)"),
    ("c", "position of O, the origin of the floating frame, in the inertial frame", "(1)"),
    ("Q", "rotation tensor of the floating frame", "(1)"),
    ("omega", "angular velocity of the floating frame, in its own components", "(5)"),
    ("delta pi", "virtual rotation of the floating frame", "(6)"),
    ("Phi_i", "assumed mode i, a field over the body", "(14)"),
    ("alpha_i", "amplitude of the assumed mode i; bold, the column of all amplitudes", "(14)"),
)
INTEGRALS: tuple[Entry, ...] = (
    ("m", "mass of the body", "appendix"),
    ("c_1", "shape integral: first moment of the mass about O", "appendix"),
    ("c_2", "shape integral: first moments of the modes", "appendix"),
    ("C_3", "shape integral: inertia tensor of the undeformed body", "appendix"),
    ("C_4", "shape integral: mixed second moments of position and mode", "appendix"),
    ("C_5", "shape integral: second moments of two modes", "appendix"),
    ("c_6", "shape integral: moments of position and mode, antisymmetric part", "appendix"),
    ("c_7", "shape integral: moments of two modes, antisymmetric part", "appendix"),
    ("c_8", "shape integral: mass matrix of the modes", "appendix"),
    ("d_1", "first moment of the mass of the deformed body", "(15)"),
    ("D_2", "mixed moments of r and mode; S is the symmetric part", "(15)"),
    ("d_3", "antisymmetric part of these moments", "(15)"),
    ("J", "inertia tensor of the deformed body", "(15)"),
    ("K", "stiffness matrix of the modes; B is their damping matrix", "(13)"),
)
SECOND_ORDER: tuple[Entry, ...] = (
    ("Psi_{i j}", "field of second order of the modes i and j, beyond the paper", "second order"),
    ("r_{k,i}", "derivative of component k of r at a marker by the amplitude i", "second order"),
)
TRUNCATED: tuple[Entry, ...] = (
    ("c_9", "first moments of these fields", "second order"),
    ("c_10", "moments of position and these fields, antisymmetric part", "second order"),
    ("d_4", "first moments of the derivatives of r by the amplitudes", "second order"),
)
FULL: tuple[Entry, ...] = (
    ("theta_p", "field along the axis, of which the fields of second order are combinations", "second order"),
    ("z_{p i j}", "part of this field in that of the modes i and j", "second order"),
    ("beta_p", "amplitude of this field", "second order"),
    ("beta_{p,i}", "its derivative by the amplitude i", "second order"),
    ("beta''_p^0", "its second time derivative if no amplitude accelerates", "second order"),
)
SYSTEM: tuple[Entry, ...] = (
    ("M", "mass matrix", "(15)"),
    ("h", "forces: all terms without accelerations", "(15)"),
)
CONSTRAINTS: tuple[Entry, ...] = (
    ("g", "constraints on position level, one for each multiplier", ""),
    ("G", "constraint Jacobian with respect to the generalised velocities", ""),
    ("lambda", "multipliers: constraint reactions on body 2", ""),
)
FRAMES: tuple[Entry, ...] = (
    ("w", "angular velocity of the floating frame in components of the inertial frame", "(5)"),
    ("s", "vector Q r from O to a marker, in the inertial frame", "(2)"),
    ("A", "axes of a marker frame as columns, in the inertial frame", "markers"),
    ("v", "velocity of a marker relative to its floating frame, in the inertial frame", "(5)"),
    ("theta", "rotation vector of the section at a marker by deformation", "markers"),
    ("sigma", "scale of the rotation tensor of that section, 1/(1 + theta . theta / 4)", "markers"),
    ("nu", "angular velocity of that section relative to the floating frame, in the inertial frame", "markers"),
)
BOLD: dict[str, Name] = {
    "M": Name("M", style="tensor"),
    "G": Name("G", style="tensor"),
    **{letter: Name(letter, style="vector") for letter in ("h", "g", "lambda")},
}
"""Matrices and columns of the whole system, whose letters the formula reader takes for scalars."""


def nomenclature_blocks(
    constrained: bool, orders: Collection[DisplacementOrder] = (), frames: bool = False
) -> tuple[Block, ...]:
    """The table of symbols, and why the letter c occurs twice.

    constrained: whether there are multipliers. orders: those of the displacements. frames: whether markers are frames.
    """
    truncated, full = (order in orders for order in (DisplacementOrder.TRUNCATED, DisplacementOrder.FULL))
    entries = (
        *POSITION,
        *INTEGRALS,
        *(SECOND_ORDER if truncated or full else ()),
        *(TRUNCATED if truncated else ()),
        *(FULL if full else ()),
        *(FRAMES if frames else ()),
        *SYSTEM,
        *(CONSTRAINTS if constrained else ()),
    )
    return (
        Heading("Nomenclature", "nomenclature"),
        Paragraph(
            (
                *marked_text(
                    "The notation is that of the paper, in which the letter c has two meanings. $c$ without an index "
                    "is the position of the origin of the floating frame; its components are the coordinates "
                ),
                *marked_text("$c_1$, $c_2$ and $c_3$. ", scalars=True),
                *marked_text(
                    "$c_1$, $c_2$ to $c_8$ in bold are shape integrals, and so are their components, which have "
                    "further indices behind a comma: first the modes, then the component. In the code `c1` is a "
                    "coordinate, and `c1_1` is component 1 of the first shape integral."
                ),
            )
        ),
        Details(f"The {len(entries)} symbols", (table("Symbols", ("symbol", "meaning", "from"), _rows(entries)),)),
    )


def _rows(entries: Sequence[Entry]) -> list[list[Content]]:
    return [[BOLD.get(symbol) or formula(symbol), meaning, place] for symbol, meaning, place in entries]
