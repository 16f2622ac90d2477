"""Conditions that prevent rigid body motion, and what they leave of (15): (16) to (20)."""

from __future__ import annotations

from fractions import Fraction

from derive.report.paper_audit import derived_beam as beam
from derive.report.paper_audit import derived_space as derived
from derive.report.paper_audit.model import AuditRow, AuditSection, tests
from derive.spec.model.beam_parts import Frame

SPACE = "test_body_in_space.py"
MEAN = "test_mean_equations.py"

ROWS = (
    AuditRow(
        "16",
        "A point that is not displaced",
        ("Phi_i(P_c) = 0",),
        derived=lambda: beam.condition(Frame("point", Fraction(1, 2)), 0),
        note="For all $i$. As derived for the beam and a point at 1/2; of a body of nodes, the node of the frame is "
        "fixed.",
        tests=tests(SPACE, "test_a_point_of_the_beam_meets_16", "test_a_node_that_holds_the_frame_meets_16"),
    ),
    AuditRow(
        "17",
        "No mean displacement",
        ("(1/m) int_Omega rho Phi_i dOmega = 0",),
        derived=lambda: (*beam.condition(Frame("mean"), 0), derived.vanishing("c2")),
        note="For all $i$. As derived for the beam, and of any body: $c_2$ of the appendix vanishes.",
        tests=tests(
            SPACE, "test_mean_conditions_of_the_beam_are_17_and_19", "test_modes_in_the_mean_frame_meet_17_and_19"
        ),
    ),
    AuditRow(
        "18",
        "Small rotation about O",
        ("u_{rotation} = chi e >< X",),
        derived=derived.rotation,
        note="The derivative of the rotation tensor of a quaternion; also the rotations that are taken out of modes.",
        tests=tests(SPACE, "test_18_is_a_small_turn_of_the_rotation_tensor", "test_rigid_fields_of_nodes_are_18"),
    ),
    AuditRow(
        "19",
        "No mean rotation",
        ("int_Omega rho X >< Phi_i dOmega = 0",),
        derived=lambda: (*beam.condition(Frame("mean"), 1), derived.vanishing("c6")),
        note="For all $i$. As derived for the beam, and of any body: $c_6$ of the appendix vanishes.",
        tests=tests(
            SPACE, "test_mean_conditions_of_the_beam_are_17_and_19", "test_modes_in_the_mean_frame_meet_17_and_19"
        ),
    ),
    AuditRow(
        "20",
        "Equations of motion in the mean frame",
        (
            "delta c: m c''",
            "delta pi: omega >< (J . omega) + J . omega' + 2 (alpha'^T D_2) . omega + alpha''^T d_3",
            "delta alpha^T: - omega . (D_2 . omega) - omega' . (c_7 alpha) - 2 omega . (c_7 alpha') + c_8 alpha''",
        ),
        derived=derived.mean_equations_of_motion,
        misread=(
            ("m c''", "m c"),
            ("2 omega . (c_7 alpha')", "2 omega' . (c_7 alpha')"),
        ),
        correction="The dots over $c$ are lost, and the Coriolis term of the last row has a dot too many: it is "
        "$- 2 omega . (c_7 alpha')$.",
        note="$delta U$ stands before the rows. As derived with $d_3$, of which (19) leaves $- c_7 alpha$.",
        tests=tests(MEAN, "test_equations_in_the_mean_frame_are_20", "test_a_changed_term_of_20_is_noticed"),
    ),
)

SECTIONS = (AuditSection("Preventing rigid body motion", "frames", ROWS),)
