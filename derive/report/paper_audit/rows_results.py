"""The beam in its two frames: conditions, shapes and equations of motion, (28) to (41)."""

from __future__ import annotations

from functools import partial

from derive.report.paper_audit import derived_beam as derived
from derive.report.paper_audit.model import AuditRow, AuditSection, Derived, tests

BEAM = "test_beam.py"
CHAIN = "test_derived.py"
BRUTE = "test_printed_against_brute_force.py"
PLANE = "test_derived_kinematics.py"

CUBIC = tests(PLANE, "test_conditions_on_the_cubic_are_the_printed_ones")
SHAPES = tests(CHAIN, "test_shapes_are_the_printed_ones")
MIDDLE = (*CUBIC, *tests(BRUTE, "test_28_and_29_say_that_the_middle_neither_moves_nor_turns"))
LEFT_BY_POINT = (*SHAPES, *tests(BRUTE, "test_31_and_32_are_what_28_and_29_leave"))
MEANS = tests(BEAM, "test_mean_conditions_are_34_and_36")
BY_HAND = tests(BRUTE, "test_35_and_37_are_34_and_36_of_21")
LEFT_BY_MEAN = (*SHAPES, *tests(BRUTE, "test_39_and_40_are_what_35_and_37_leave"))
ALL_OF_IT = tests(BEAM, "test_what_the_conditions_leave_of_21_is_30_and_38")
WHOLE = (
    *tests(
        CHAIN,
        "test_equations_are_the_printed_ones",
        "test_a_changed_term_is_noticed",
        "test_compiled_c_is_the_printed_equation",
    ),
    *tests(BRUTE, "test_printed_rows_equal_brute_force"),
)


def _row(number: str, title: str, line: str, result: Derived, proof: tuple[str, ...], note: str = "") -> AuditRow:
    return AuditRow(number, title, (line,), derived=result, note=note, tests=proof, scalars=True)


EXPANSION = "v(xi, t) = alpha_1(t) ϕ_1(xi) + alpha_2(t) ϕ_2(xi)"
FACTOR = "As derived in whole numbers without a common divisor."

POINT = (
    _row(
        "28",
        "The middle is not displaced",
        "a_0 = 0",
        partial(derived.on_the_cubic, "point", 0),
        MIDDLE,
        "Condition (16) on (21).",
    ),
    _row("29", "The middle does not turn", "a_1 = 0", partial(derived.on_the_cubic, "point", 1), MIDDLE),
    _row(
        "30",
        "Displacement without rigid motion",
        EXPANSION,
        partial(derived.expansion, "point"),
        (
            *tests(BEAM, "test_displacement_in_the_frame_of_the_middle_is_30"),
            *ALL_OF_IT,
            *tests(BRUTE, "test_30_has_no_rigid_motion_left"),
        ),
        "With (31) and (32): all that (28) and (29) leave of (21), and no rigid motion.",
    ),
    _row("31", "First shape", "ϕ_1(xi) = xi^2", partial(derived.shape, "point", 1), LEFT_BY_POINT),
    _row("32", "Second shape", "ϕ_2(xi) = xi^3", partial(derived.shape, "point", 2), LEFT_BY_POINT),
    AuditRow(
        "33",
        "Equations of motion in the frame of the middle",
        (
            "delta c_1: m {c''_1 - [alpha_1 (phi'' cos phi - phi'^2 sin phi) + 2 phi' alpha'_1 cos phi "
            "+ alpha''_1 sin phi]/3}",
            "delta c_2: m {c''_2 - [alpha_1 (phi'' sin phi + phi'^2 cos phi) + 2 phi' alpha'_1 sin phi "
            "- alpha''_1 cos phi]/3}",
            "delta phi: m {- alpha_1 (c''_1 cos phi + c''_2 sin phi)/3 + phi'' (l^2/12 + alpha_1^2/5 + alpha_2^2/7) "
            "+ 2 phi' (alpha_1 alpha'_1/5 + alpha_2 alpha'_2/7) + l alpha''_2/10}",
            "delta alpha_1: m {(- c''_1 sin phi + c''_2 cos phi)/3 - phi'^2 alpha_1/5 + alpha''_1/5} "
            "+ 64 alpha_1 EI/l^3",
            "delta alpha_2: m {l phi''/10 - phi'^2 alpha_2/7 + alpha''_2/7} + 192 alpha_2 EI/l^3",
        ),
        derived=partial(derived.rows, "point"),
        misread=(
            ("c''_1", "c_1"),
            ("c''_2", "c_2"),
            ("phi'' cos", "phi' cos"),
            ("phi'' sin", "phi' sin"),
            ("phi'' (l", "phi' (l"),
        ),
        correction="$c_1$ and $c_2$ stand under an arrow or a bar where they have two dots, and the angle has one dot "
        "in place of two in the acceleration terms of the first three rows. Exact as printed with the dots restored.",
        note="Derived, in the kernels, in the generated Python and in the compiled C; each of the 27 terms is needed.",
        tests=WHOLE,
        scalars=True,
    ),
)

MEAN = (
    _row(
        "34",
        "No mean displacement",
        "int_{-1}^1 v(xi, t) dxi = 0",
        partial(derived.condition, derived.FRAMES["mean"], 0),
        (*MEANS, *BY_HAND),
        "Condition (17) for the beam.",
    ),
    _row(
        "35",
        "The same for (21)",
        "3 a_0 + a_2 = 0",
        partial(derived.on_the_cubic, "mean", 0),
        (*CUBIC, *BY_HAND),
        FACTOR,
    ),
    _row(
        "36",
        "No mean rotation",
        "int_{-1}^1 xi v(xi, t) dxi = 0",
        partial(derived.condition, derived.FRAMES["mean"], 1),
        (*MEANS, *BY_HAND),
        "Condition (19) for the beam.",
    ),
    _row(
        "37",
        "The same for (21)",
        "5 a_1 + 3 a_3 = 0",
        partial(derived.on_the_cubic, "mean", 1),
        (*CUBIC, *BY_HAND),
        FACTOR,
    ),
    _row(
        "38",
        "Displacement without rigid motion",
        EXPANSION,
        partial(derived.expansion, "mean"),
        (*tests(BEAM, "test_displacement_in_the_mean_frame_is_38"), *ALL_OF_IT),
        "With (39) and (40): all that (35) and (37) leave of (21).",
    ),
    _row("39", "First shape", "ϕ_1(xi) = 1/2 (-1 + 3 xi^2)", partial(derived.shape, "mean", 1), LEFT_BY_MEAN),
    _row("40", "Second shape", "ϕ_2(xi) = 1/2 (-3 xi + 5 xi^3)", partial(derived.shape, "mean", 2), LEFT_BY_MEAN),
    AuditRow(
        "41",
        "Equations of motion in the mean frame",
        (
            "delta c_1: m c''_1",
            "delta c_2: m c''_2",
            "delta phi: m {phi'' (l^2/12 + alpha_1^2/5 + alpha_2^2/7) "
            "+ 2 phi' (alpha_1 alpha'_1/5 + alpha_2 alpha'_2/7)}",
            "delta alpha_1: (m/5) (alpha''_1 - phi'^2 alpha_1) + 144 alpha_1 EI/l^3",
            "delta alpha_2: (m/7) (alpha''_2 - phi'^2 alpha_2) + 1200 alpha_2 EI/l^3",
        ),
        derived=partial(derived.rows, "mean"),
        misread=(
            ("c''_1", "c_1"),
            ("c''_2", "c_2"),
            ("phi'' (l", "phi' (l"),
        ),
        correction="$c_1$ and $c_2$ stand under a bar where they have two dots, and the first term of the third row "
        "has one dot in place of two. Exact as printed with the dots restored.",
        note="Derived, in the kernels, in the generated Python and in the compiled C; each of the 13 terms is needed.",
        tests=WHOLE,
        scalars=True,
    ),
)

SECTIONS = (
    AuditSection("The beam in the frame of its middle", "point", POINT),
    AuditSection("The beam in the mean frame", "mean", MEAN),
)
