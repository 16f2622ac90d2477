"""The assumptions that the paper makes in words, and the options of a specification that lift them."""

from __future__ import annotations

from derive.report.paper_audit.model import Assumption

NODES = "body.nodes"

ASSUMPTIONS = (
    Assumption(
        "No body force, $b = 0$",
        "under (7)",
        "No weight unless the specification has gravity.",
        ("beam.gravity", "body.gravity", "scene.gravity"),
        "Uniform gravity. Other forces per volume are not available.",
    ),
    Assumption(
        "No load on the surface, $q = 0$",
        "under (12)",
        "The sum of each row of the equations of motion is zero.",
        ("beam.markers", "body.markers", "forces", "torques", "springs"),
        "In part: forces at markers (the functions `load_NAME` of the generated code), and in scenes forces, torques "
        "and springs there. Loads that are spread over the surface are not available.",
    ),
    Assumption(
        "No stress in the reference configuration",
        "before (8)",
        "The strain energy has no terms of first order in $alpha$.",
    ),
    Assumption(
        "Isotropic linear elastic material",
        "(8)",
        "$U$ is quadratic in $alpha$, with constant stiffness $K$.",
        ("body.nodes", "body.damping"),
        "Isotropic: any stiffness matrix of a finite-element program, also of anisotropic or layered bodies. Elastic: "
        "viscous damping of the modes. Nonlinear materials are not available.",
    ),
    Assumption(
        "Strain energy by an approximation in place of (13)",
        "under (13)",
        "$U = 1/2 alpha^T K alpha$, of (22) for the beam; nothing of higher order in the strains.",
    ),
    Assumption(
        "Displacements linear in the amplitudes",
        "(14)",
        "A deflection does not foreshorten the body, so the model softens under spin where a real body stiffens.",
        ("beam.order", "body.order"),
        "With order 2 the displacements are quadratic in the amplitudes.",
    ),
    Assumption(
        "A combination of assumed fields, few of them",
        "under (14)",
        "$N$ fields over the whole body.",
        ("beam.ansatz", "body.modes", "bodies.*.pieces"),
        "Any polynomials of a beam; any number of modes of a body, computed or given. A rod of a scene may be cut into "
        "beams of equal length that are welded together.",
    ),
    Assumption(
        "Independent fields without rigid body motion",
        "before (16)",
        "Three things are refused: an ansatz with dependent fields, a frame that leaves no field, and fields with a "
        "rigid motion. The message names the combination.",
        ("beam.frame", "body.frame"),
        "The frames remove rigid motion from any fields. `given` takes fields as they are, and refuses them if they "
        "contain a rigid motion.",
    ),
    Assumption(
        "Fixed at one point, its rotation too",
        "under (16)",
        "The middle of the beam, as in (28) and (29).",
        ("beam.frame.at", "body.frame.node"),
        "Any point of the beam, an end with its tangent, or the chord between the ends; a node of a body with its "
        "neighbours.",
    ),
    Assumption(
        "Mean conditions weighted with the density",
        "under (19)",
        "(17) and (19) as they stand. Other weights are not available.",
    ),
    Assumption(
        "Centre of mass in O",
        "before (20)",
        "In the mean frame $c_1 = 0$.",
        ("body.frame", "bodies.*.centre"),
        "Bodies of nodes: O is the centre of mass in the frame `mean`, the node in the frame `point`, and the origin "
        "of the positions in `given`. In rigid bodies of a scene O may be anywhere. In a beam O is its centre.",
    ),
    Assumption(
        "Motion in a plane",
        "before (21)",
        "Coordinates $c_1$, $c_2$ and $phi$.",
        (NODES, "body.integrals"),
        "Bodies in space, of nodes or with shape integrals as parameters; scenes in the plane and in space.",
    ),
    Assumption(
        "Cubic deflection",
        "(21)",
        "The default of a beam.",
        ("beam.ansatz",),
        "Any polynomials.",
    ),
    Assumption(
        "Uniform cross-section and mass, straight axis",
        "before (21)",
        "$int_Omega rho dOmega$ is $(m/2) int_{-1}^1 dxi$.",
        (NODES,),
        "A body of nodes may have any shape. A beam may have attached masses, but is uniform otherwise.",
    ),
    Assumption(
        "Bernoulli-Euler theory: no shear, the axis alone",
        "before (21)",
        "The displacement of the axis determines that of every point.",
        (NODES,),
        "A body of nodes shears as its elements do. A beam does not shear.",
    ),
    Assumption(
        "Inextensible axis",
        "before (21)",
        "No displacement along the axis, so inextensible to first order.",
        (NODES, "beam.axial", "beam.order"),
        "A body of nodes may stretch, and so may a beam with axial shapes. With order 2 a beam shortens as it bends.",
    ),
    Assumption(
        "Rotary inertia of the cross-section neglected",
        "before (22)",
        "The mass lies on the axis.",
        (NODES,),
        "A body of nodes has rotary inertia. A beam has none, except that of attached masses.",
    ),
    Assumption(
        "Small curvature in (22)",
        "(22)",
        "The curvature is the second derivative of $v$.",
    ),
    Assumption(
        "Rigid crank and slider",
        "Numerical results",
        "As in the scene `crank_slider_3`.",
        ("bodies",),
        "Any body of a scene may be a flexible rod.",
    ),
)
