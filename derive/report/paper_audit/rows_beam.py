"""The free uniform beam: (21) to (27)."""

from __future__ import annotations

from derive.report.paper_audit import derived_beam as derived
from derive.report.paper_audit.model import AuditRow, AuditSection, tests

BEAM = "test_beam.py"
DIFFERENTIATED = "test_printed_against_brute_force.py"
PLANE = "test_derived_kinematics.py"
PLACES = tests(BEAM, "test_places_of_markers_are_1_with_23_to_26")

ROWS = (
    AuditRow(
        "21",
        "Lateral displacement",
        ("v(xi, t) = a_0(t) + a_1(t) xi + a_2(t) xi^2 + a_3(t) xi^3",),
        kind="definition",
        derived=derived.ansatz,
        by_user=True,
        note="What a beam has where its specification says nothing; any polynomials may stand there.",
        where=("derive/spec/model/beam_parts.py::DEFAULT_ANSATZ",),
        tests=tests(BEAM, "test_ansatz_without_a_specification_is_21"),
        scalars=True,
    ),
    AuditRow(
        "22",
        "Strain energy",
        ("U = (4 EI/l^3) int_{-1}^1 (partial^2 v/partial xi^2)^2 dxi",),
        derived=derived.strain_energy,
        note="As derived with the shapes of both frames. It is half of $EI$ times the squared curvature along the "
        "beam.",
        tests=(
            *tests(BEAM, "test_strain_energy_is_22"),
            *tests(DIFFERENTIATED, "test_22_is_the_energy_of_curvature", "test_22_of_a_uniform_curvature"),
        ),
        scalars=True,
    ),
    AuditRow(
        "23",
        "Translation in components",
        ("c = c_1 e_1 + c_2 e_2",),
        kind="definition",
        derived=derived.translation,
        where=("derive/mechanics/motion/planar.py::_coordinates",),
        tests=(*tests(BEAM, "test_translation_is_23"), *PLACES),
        scalars=True,
    ),
    AuditRow(
        "24",
        "Place in the reference configuration",
        ("X = 1/2 xi l e_1",),
        kind="definition",
        derived=derived.points,
        note="As derived for three points of the beam.",
        where=("derive/mechanics/bodies/beam.py::beam_point",),
        tests=PLACES,
        scalars=True,
    ),
    AuditRow(
        "25",
        "Displacement due to deformation",
        ("u = v(xi, t) e_2",),
        kind="definition",
        derived=derived.displacements,
        note="As derived for the same points, in the mean frame.",
        where=("derive/mechanics/bodies/beam.py::beam_point",),
        tests=PLACES,
        scalars=True,
    ),
    AuditRow(
        "26",
        "Rotation tensor",
        ("Q = (e_1 e_1 + e_2 e_2) cos phi + (e_2 e_1 - e_1 e_2) sin phi + e_3 e_3",),
        derived=derived.rotation,
        note="The rotation tensor of a quaternion, for a turn about the third axis, is the same.",
        tests=(
            *tests(BEAM, "test_rotation_tensor_of_a_turn_about_e3_is_26"),
            *tests(PLANE, "test_rotation_is_26_and_its_axis_27"),
            *tests(DIFFERENTIATED, "test_26_turns_the_axis_of_the_beam"),
        ),
        scalars=True,
    ),
    AuditRow(
        "27",
        "Angular velocity and virtual rotation",
        ("omega = phi' e_3", "delta pi = delta phi e_3"),
        derived=derived.spin,
        note="As derived by differentiation of (26): skew tensors with these axial vectors.",
        tests=tests(BEAM, "test_rates_and_variations_of_the_turn_have_the_axis_27"),
        scalars=True,
    ),
)

SECTIONS = (AuditSection("Free uniform beam", "beam", ROWS),)
