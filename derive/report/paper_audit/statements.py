"""The statements of the paper outside of its equations, and whether they are true."""

from __future__ import annotations

from derive.report.paper_audit.model import Statement, tests

MEAN = "test_mean_equations.py"
BEAM = "test_beam.py"
SPACE = "test_body_in_space.py"
CONTINUUM = "test_continuum.py"
DIFFERENTIATED = "test_printed_against_brute_force.py"

STATEMENTS = (
    Statement(
        "sentence under (6)",
        "$omega$ is the axial vector of $Q^c . Q$, and $delta pi$ that of $Q^c . delta Q$.",
        "holds after the correction",
        "A dot is lost: $omega$ is that of $Q^c . Q'$.",
        tests(DIFFERENTIATED, "test_5_is_the_second_derivative_of_1", "test_6_is_the_variation_of_1"),
    ),
    Statement(
        "sentence under (13)",
        "The first term of (13) is the variation of the strain energy.",
        "holds",
        "For the energy of (8), exactly, at any strain.",
        tests(CONTINUUM, "test_the_first_term_of_13_is_the_variation_of_the_strain_energy"),
    ),
    Statement(
        "sentence after (17)",
        "Under (17), $c$ is the translation of the centre of mass.",
        "holds after the correction",
        "It takes the choice of O as well: with (17) alone the centre of mass is at $c + (1/m) Q . c_1$. The paper "
        "chooses O a few lines further on.",
        tests(MEAN, "test_c_is_the_translation_of_the_centre_of_mass_when_o_is_there"),
    ),
    Statement(
        "remark under (19)",
        "$rho$ as a weight cancels $c_3$, and $d_3$ becomes proportional with $alpha_2$.",
        "holds after the correction",
        "It is $c_6$ that cancels, and $d_3 = - c_7 alpha$ is proportional with the column $alpha$.",
        tests(MEAN, "test_19_cancels_c6_and_leaves_d3_proportional_to_alpha"),
    ),
    Statement(
        "sentence under (19)",
        "Modes of free vibration meet (17) and (19).",
        "holds",
        "Those of masses joined by springs, computed without this tool.",
        tests(SPACE, "test_modes_of_free_vibration_meet_17_and_19"),
    ),
    Statement(
        "sentence before (20)",
        "With (17) and the centre of mass in O, all terms with $d_1$ and $c_2$ cancel, and (15) becomes (20).",
        "holds after the correction",
        "The terms do cancel. For (20) it takes (19) besides, or $omega' . c_6$ stays in the rows of the fields.",
        tests(MEAN, "test_17_and_the_choice_of_o_cancel_d1_and_c2", "test_20_needs_19_as_well"),
    ),
    Statement(
        "sentence after (20)",
        "The mass matrix becomes more sparse.",
        "holds",
        "The accelerations of $c$ stand in their own rows alone; of the beam 5 of 25 entries are left, against 15.",
        (
            *tests(MEAN, "test_the_mass_matrix_is_sparser_in_the_mean_frame"),
            *tests(BEAM, "test_5_of_25_entries_are_left_in_41_and_15_in_33"),
        ),
    ),
    Statement(
        "sentence under (41)",
        "In (41) translation does not couple with deformation, and rotation couples in a nonlinear way.",
        "holds",
        "The amplitudes stand in second order in the row of $phi$. In their own rows they stand in first order, with "
        "$phi'^2$.",
        tests(
            BEAM,
            "test_translation_does_not_couple_with_deformation_in_41",
            "test_rotation_couples_with_deformation_in_products_alone_in_41",
        ),
    ),
    Statement(
        "Numerical results, the fields of the rod",
        "The deformation fields of the crank-slider are (38) and (39).",
        "holds after the correction",
        "(39) and (40) are meant: (38) is the expansion into them.",
        tests(BEAM, "test_displacement_in_the_mean_frame_is_38"),
    ),
    Statement(
        "Numerical results, figure 3",
        "The deflection of the middle of the rod for one, two and three beams.",
        "not compared",
        "The paper gives no parameters, and its figure no values. `tisserand simulate scenes/crank_slider_3.toml` "
        "takes a set of the literature, and says which.",
    ),
    Statement(
        "Numerical results, CPU times",
        "The times of the revised program are .97, .93 and .92 of those of the standard one.",
        "not compared",
        "They belong to a program and a machine of 1988. `tisserand study frames` counts and times what is left today.",
    ),
    Statement(
        "Concluding remarks",
        "More zeros in the mass matrix are expected to make symbolic factorisation more stable.",
        "not compared",
        "No equation says it. `tisserand study pivots` measures pivots.",
    ),
)
