"""Kinematics, equations of motion and discretisation of a body: (1) to (15)."""

from __future__ import annotations

from derive.report.paper_audit import derived_space as derived
from derive.report.paper_audit.model import AuditRow, AuditSection, tests
from derive.report.sections import kinematics

CONTINUUM = "test_continuum.py"
DIFFERENTIATED = "test_printed_against_brute_force.py"
PLANE = "test_derived_kinematics.py"
SPACE = "test_body_in_space.py"
GENERAL = "test_general_body.py"


KINEMATICS = (
    AuditRow(
        "1",
        "Place of a material point",
        ("x(X, t) = c(t) + Q(t) . {X + u(X, t)}",),
        kind="definition",
        derived=lambda: (kinematics.position(),),
        note="Defines $c$, $Q$ and $u$; $r$ stands for $X + u$.",
        where=("derive/mechanics/motion/kinematics.py::position", "derive/mechanics/motion/body_motion.py::position"),
        tests=tests(SPACE, "test_place_of_a_material_point_is_1_with_14"),
    ),
    AuditRow(
        "2",
        "Vector between two points",
        ("dx = Q(t) . {dX + u(X + dX, t) - u(X, t)}",),
        stated=("dx = x(X + dX, t) - x(X, t)",),
        note="The difference of (1) for a polynomial $u$.",
        tests=tests(CONTINUUM, "test_difference_of_1_is_2"),
    ),
    AuditRow(
        "3",
        "The same for near points",
        ("dx = F . dX",),
        stated=("dx = (partial/partial h) x(X + h dX, t) for h = 0",),
        note="The limit of (2), with $F$ of (4).",
        tests=tests(CONTINUUM, "test_2_is_3_with_4_for_near_points"),
    ),
    AuditRow(
        "4",
        "Deformation tensor",
        ("F = Q . {I + (nabla u)^c}",),
        stated=("F = (nabla x)^c",),
        note="The gradient of (1), for a rotation by three angles and fields with free gradients.",
        tests=(
            *tests(DIFFERENTIATED, "test_4_is_the_gradient_of_1"),
            *tests(CONTINUUM, "test_2_is_3_with_4_for_near_points"),
        ),
    ),
    AuditRow(
        "5",
        "Acceleration of a material point",
        ("x'' = c'' + Q . {omega >< [omega >< (X + u)] + omega' >< (X + u) + 2 omega >< u' + u''}",),
        derived=lambda: (kinematics.acceleration(),),
        tests=(
            *tests(SPACE, "test_acceleration_in_space_is_5"),
            *tests(PLANE, "test_acceleration_is_5"),
            *tests(DIFFERENTIATED, "test_5_is_the_second_derivative_of_1", "test_5_of_a_point_on_a_turntable"),
        ),
    ),
    AuditRow(
        "6",
        "Virtual displacement of a material point",
        ("delta x = delta c + Q . {delta pi >< (X + u) + delta u}",),
        derived=lambda: (kinematics.virtual_displacement(),),
        misread=(
            ("delta x", "delta x''"),
            ("delta c", "delta c''"),
            ("delta u", "delta u''"),
        ),
        correction="The text puts two dots on $x$, $c$ and $u$ that do not belong there: these are variations, no "
        "rates.",
        note="As derived for the variation of one amplitude, $delta u = Phi_i delta alpha_i$.",
        tests=(
            *tests(SPACE, "test_virtual_displacement_in_space_is_6"),
            *tests(PLANE, "test_virtual_displacement_is_6"),
            *tests(DIFFERENTIATED, "test_6_is_the_variation_of_1"),
        ),
    ),
)

MOTION = (
    AuditRow(
        "7",
        "Balance of momentum",
        ("nabla . (T . F^c) + rho b = rho x''",),
        stated=("int_Gamma F . T . n dGamma + int_Omega rho b dOmega = int_Omega rho x'' dOmega",),
        note="Newton's law for a brick whose faces bear the load (12), with fields that are in no equilibrium: both "
        "say the same. The derivation begins with the virtual work of (13).",
        tests=tests(CONTINUUM, "test_7_is_the_balance_of_momentum_of_a_brick"),
    ),
    AuditRow(
        "8",
        "Material",
        ("T = 2 mu E + lambda tr(E) I",),
        kind="assumption",
        stated=("delta U = sum_{i j} delta alpha_i K_{i j} alpha_j",),
        by_user=True,
        note="Isotropic, linear elastic, without stress in the reference configuration. Here a body brings a "
        "stiffness, whatever material it comes from.",
        where=("derive/mechanics/generic_forces.py::FORCES",),
        tests=tests(CONTINUUM, "test_13_is_11_with_the_stress_8_and_a_free_surface"),
    ),
    AuditRow(
        "9",
        "Strain",
        ("E = 1/2 {F^c . F - I}",),
        stated=("dX . E . dX = 1/2 {dx . dx - dX . dX}",),
        note="For every line element of a body with free gradients; blind to the rotation.",
        tests=tests(DIFFERENTIATED, "test_9_is_the_stretch_of_line_elements"),
    ),
    AuditRow(
        "10",
        "Virtual work of (7)",
        ("int_Omega {nabla . (T . F^c) - rho x''} . delta x dOmega = 0",),
        stated=("int_Omega {nabla . (T . F^c) + rho b - rho x''} . delta x dOmega = 0 for b = 0",),
        tests=tests(
            CONTINUUM,
            "test_10_is_7_without_b_times_a_virtual_displacement",
            "test_11_is_10_by_the_divergence_theorem",
        ),
    ),
    AuditRow(
        "11",
        "The same with the work on the surface",
        ("int_Omega T : delta E dOmega + int_Omega rho x'' . delta x dOmega = int_Gamma (F . T . n) . delta x dGamma",),
        stated=(
            "int_Omega T : delta E dOmega + int_Omega rho x'' . delta x dOmega - "
            "int_Gamma (F . T . n) . delta x dGamma = - int_Omega {nabla . (T . F^c) - rho x''} . delta x dOmega",
        ),
        note="For fields that meet neither (10) nor (11), integrated exactly over a brick and its faces.",
        tests=tests(CONTINUUM, "test_11_is_10_by_the_divergence_theorem"),
    ),
    AuditRow(
        "12",
        "Load on the surface",
        ("q = F . T . n",),
        stated=("q dGamma = (1/det F) F . T . F^c . n dA",),
        note="The force of the Cauchy stress on the deformed surface $dA$, with its own normal $n$, per undeformed "
        "area.",
        tests=tests(
            CONTINUUM, "test_12_is_the_force_of_the_cauchy_stress", "test_the_surface_term_of_11_is_the_work_of_12"
        ),
    ),
    AuditRow(
        "13",
        "Virtual work of a free body",
        ("int_Omega {2 mu E + lambda tr(E) I} : delta E dOmega + int_Omega rho x'' . delta x dOmega = 0",),
        stated=("delta int_Omega {mu E : E + 1/2 lambda tr(E) tr(E)} dOmega + int_Omega rho x'' . delta x dOmega = 0",),
        note="(8) in (11) without load. The derivation takes the second integral with (5), (6) and (14), and of the "
        "first that it is the variation of $U$.",
        tests=tests(
            CONTINUUM,
            "test_13_is_11_with_the_stress_8_and_a_free_surface",
            "test_the_first_term_of_13_is_the_variation_of_the_strain_energy",
        ),
    ),
)

DISCRETE = (
    AuditRow(
        "14",
        "Assumed displacement fields",
        ("u(X, t) = sum_{i=1}^N alpha_i(t) Phi_i(X) = alpha^T(t) Phi(X)",),
        kind="definition",
        derived=lambda: (derived.series("d1"),),
        note="Defines $alpha$ and $Phi$. The derivation uses it in every moment of $r = X + u$; as derived, the first "
        "one.",
        where=(
            "derive/mechanics/motion/spatial.py::spatial_moment_sums",
            "derive/mechanics/motion/planar.py::planar_moment_sums",
        ),
        tests=tests(SPACE, "test_place_of_a_material_point_is_1_with_14"),
    ),
    AuditRow(
        "15",
        "Equations of motion of any body",
        (
            "delta c: m c'' + Q . [omega >< (omega >< d_1) + omega' >< d_1 "
            "+ 2 omega >< (alpha'^T c_2) + alpha''^T c_2]",
            "delta pi: d_1 >< (Q^c . c'') + omega >< (J . omega) + J . omega' "
            "+ 2 (alpha'^T D_2) . omega + alpha''^T d_3",
            "delta alpha^T: c'' . (Q . c_2) - omega . (D_2 . omega) + omega' . d_3 "
            "- 2 omega . (c_7 alpha') + c_8 alpha''",
        ),
        derived=derived.equations_of_motion,
        misread=(
            ("alpha''^T c_2", "alpha^T c_2"),
            ("Q^c . c''", "Q^c . c"),
            ("alpha''^T d_3", "alpha^T d_3"),
            ("c'' . (Q", "c . (Q"),
            ("c_7 alpha'", "c_7 alpha"),
            ("c_8 alpha''", "c_8 alpha"),
        ),
        correction="At six places dots are lost: the accelerations are $c''$ and $alpha''$ in all three rows, and "
        "the Coriolis term of the last row is $- 2 omega . (c_7 alpha')$, with the rate.",
        note="$delta U$ stands before the three rows. With free shape integrals, for 0 to 3 shapes; turning or leaving "
        "out any one term is noticed.",
        tests=tests(GENERAL, "test_equations_are_15", "test_a_changed_term_of_15_is_noticed"),
    ),
)

SECTIONS = (
    AuditSection("The kinematics of a deformable body", "kinematics", KINEMATICS),
    AuditSection("The equations of motion", "motion", MOTION),
    AuditSection("Discretisation of the body", "discretisation", DISCRETE),
)
