"""The assumptions that the paper makes in words, and the options of a specification that lift them."""

from __future__ import annotations

from derive.report.paper_audit.model import Assumption

NODES = "body.nodes"

ASSUMPTIONS = (
    Assumption(
        "No body force, $b = 0$",
        "under (7)",
        "No weight unless it is asked for.",
        ("beam.gravity", "body.gravity", "scene.gravity"),
        "Uniform gravity. Other forces per volume: none yet.",
    ),
    Assumption(
        "No load on the surface, $q = 0$",
        "under (12)",
        "The sum of each row of the equations of motion is zero.",
        ("beam.markers", "body.markers", "forces", "torques", "springs"),
        "In part: forces at markers (the functions `load_NAME` of the generated code), and in scenes forces, torques "
        "and springs there. Loads spread over the surface: none yet.",
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
        "viscous damping of the modes. Linear: none yet.",
    ),
    Assumption(
        "Strain energy by an approximation in place of (13)",
        "under (13)",
        "$U = 1/2 alpha^T K alpha$, of (22) for the beam; nothing of higher order in the strains.",
    ),
    Assumption(
        "Displacements linear in the amplitudes",
        "(14)",
        "Fields of first order: a deflection does not foreshorten the body, so that spin softens where it stiffens.",
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
        "An ansatz that is dependent, or that a frame leaves nothing of, is refused, and so is rigid motion that is "
        "left; the message names the combination.",
        ("beam.frame", "body.frame"),
        "The frames take rigid motion out of any fields. `given` takes fields as they stand, and refuses them where "
        "they hold a rigid motion.",
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
        "(17) and (19) as they stand. Other weights: none yet.",
    ),
    Assumption(
        "Centre of mass in O",
        "before (20)",
        "In the mean frame $c_1 = 0$.",
        ("body.frame", "bodies.*.centre"),
        "Bodies of nodes: O is the centre of mass in the frame `mean`, the node in the frame `point`, and the origin "
        "of the positions in `given`. Rigid bodies of a scene: anywhere. A beam: O is its centre.",
    ),
    Assumption(
        "Motion in a plane",
        "before (21)",
        "Coordinates $c_1$, $c_2$ and $phi$.",
        (NODES, "body.integrals"),
        "Bodies in space, of nodes or with shape integrals as parameters. Scenes: in the plane alone.",
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
        "A body of nodes may have any shape. Of a beam: none yet.",
    ),
    Assumption(
        "Bernoulli-Euler theory: no shear, the axis alone",
        "before (21)",
        "$u$ of the axis is all there is.",
        (NODES,),
        "A body of nodes shears as its elements do. Of a beam: none yet.",
    ),
    Assumption(
        "Inextensible axis",
        "before (21)",
        "No displacement along the axis, so inextensible to first order.",
        (NODES,),
        "A body of nodes may stretch. Of a beam: none yet, and no foreshortening either.",
    ),
    Assumption(
        "Rotary inertia of the cross-section neglected",
        "before (22)",
        "The mass lies on the axis.",
        (NODES,),
        "A body of nodes has it. Of a beam: none yet.",
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
