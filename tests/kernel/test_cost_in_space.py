"""Operations of mechanisms in space are asserted, so that no optimisation can rot; a smaller number is progress."""

from __future__ import annotations

from math import ceil, log2
from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive.ir.expressions import Expr, Number, Operation, Operator, walk
from derive.ir.model import Model
from derive.ir.statements import Require, Requirement
from derive.spec.toml.read import parse

EXAMPLE = ROOT / "examples" / "spatial_crank_slider.toml"
RIGID_ROD = """\
[bodies.rod]
mass = 0.07536
inertia = [5e-7, 5.653e-4, 5.656e-4, 0, 0, 0]
markers.ball = [-0.15, 0, 0]
markers.middle = [0, 0, 0]
markers.yoke = { at = [0.15, 0, 0], rotation = { x = [0, 0, 1], z = [0, 1, 0] } }
start = { guess = true, position = [0.1, 0.1, 0.05], rotation = { axis = [0, 0, 1], angle = -0.8 } }

"""

FLEXIBLE = {
    "mass": 47,
    "force": 202,
    "mass_force": 206,
    "accel": 1517,
    "constraints": 115,
    "constraint_jacobian": 200,
    "constraint_bias": 291,
}
RIGID = {"mass": 0, "mass_force": 15, "accel": 485, "constraint_jacobian": 105, "constraint_bias": 118}
SPHERICAL = {"mass": 0, "mass_force": 108, "accel": 1528, "constraint_jacobian": 315, "constraint_bias": 330}
REVOLUTE = {"mass": 0, "mass_force": 108, "accel": 1693, "constraint_jacobian": 495, "constraint_bias": 453}
WELDED = {"mass": 0, "mass_force": 108, "accel": 921, "constraint_jacobian": 585, "constraint_bias": 600}
"""Operations by function."""


def lowered(path: Path, *functions: str) -> Model:
    """The model of explicit integration, which has markers if functions of them are requested."""
    return derive.lower(derive.derive(derive.read(path)), explicit=True, functions=functions)


def counts(model: Model, names: dict[str, int]) -> dict[str, int]:
    return {name: model.kernel(name).operations for name in names}


@pytest.fixture(scope="module")
def flexible() -> Model:
    return lowered(EXAMPLE, "marker_rotations")


def test_a_flexible_rod(flexible: Model) -> None:
    assert counts(flexible, FLEXIBLE) == FLEXIBLE


def test_results_are_added_as_a_tree_to_be_checked(flexible: Model) -> None:
    """A chain of sums would be the last to wait for: the processor begins no further evaluation before its end."""

    def sums(expr: Expr) -> int:
        """The longest chain of sums and differences from the value of an expression on."""
        added = isinstance(expr, Operation) and expr.kind in (Operator.ADD, Operator.SUB)
        return 1 + max(map(sums, expr.args)) if added else 0

    (total,) = (
        s.expr for s in flexible.kernel("solve").statements if isinstance(s, Require) and s.kind is Requirement.FINITE
    )
    results = sum(out.size for out in flexible.kernel("solve").outputs)
    assert sums(total) <= ceil(log2(results))


def test_markers_have_no_rounding_errors(flexible: Model) -> None:
    """The ends of the rod are means over nodes, in which what cancels leaves no digits behind."""
    statements = flexible.kernel("marker_rod_ball").statements
    numbers = {abs(float(part.value)) for s in statements for part in walk(s.expr) if isinstance(part, Number)}
    assert min(numbers - {0.0}) > 1e-6


def test_explicit_integration_has_no_markers() -> None:
    """In space, where nothing calls them, and robots have dozens; a model with all kernels has them."""
    text = EXAMPLE.read_text()
    start, end = text.index("[bodies.rod]"), text.index("[bodies.slider]")
    scene = derive.derive(parse(text[:start] + RIGID_ROD + text[end:]))
    for explicit in (True, False):
        model = derive.lower(scene, explicit=explicit)
        assert bool(model.markers) == any(k.name.startswith("marker_") for k in model.kernels) == (not explicit)


def test_three_rigid_bodies_take_pairs(tmp_path: Path) -> None:
    """Translations of the rod and of the slider leave the system with the constraints that determine them."""
    text = EXAMPLE.read_text().replace("[scene]", '[scene]\ncoordinates = "absolute"')
    start, end = text.index("[bodies.rod]"), text.index("[bodies.slider]")
    path = tmp_path / "rigid.toml"
    path.write_text(text[:start] + RIGID_ROD + text[end:])
    assert counts(lowered(path), RIGID) == RIGID


def chain(kind: str, path: Path) -> Model:
    """A chain of three rigid bodies with joints of a kind."""
    bodies = "".join(
        f"[bodies.link{i}]\nmass = 1\ninertia = [0.1, 0.2, 0.25, 0.01, 0.02, 0.03]\nkeep_coordinates = true\n"
        "markers = { left = [-0.1, 0.2, 0.3], right = [0.3, 0.1, -0.2] }\n"
        for i in range(3)
    )
    ends = ["ground.base", "link0.right", "link1.right"]
    joints = "".join(
        f'[joints.joint{i}]\nkind = "{kind}"\nbetween = ["{end}", "link{i}.left"]\n' for i, end in enumerate(ends)
    )
    head = 'name = "chain"\n[scene]\nlowering = "flat"\ngravity = [0, 0, -9.81]\n[ground.markers]\nbase = [0, 0, 0]\n'
    path.write_text(head + bodies + joints)
    return lowered(path)


def test_a_chain_with_spherical_joints_takes_none(tmp_path: Path) -> None:
    """Its rotations would be coupled with each other."""
    assert counts(chain("spherical", tmp_path / "chain.toml"), SPHERICAL) == SPHERICAL


@pytest.mark.parametrize(("kind", "expected"), [("revolute", REVOLUTE), ("fixed", WELDED)])
def test_chains_whose_rotations_are_relative(kind: str, expected: dict[str, int], tmp_path: Path) -> None:
    """One rotation is left of each hinge, and none of a weld."""
    assert counts(chain(kind, tmp_path / "chain.toml"), expected) == expected


def test_constraints_that_pairs_imply_are_redundant(tmp_path: Path) -> None:
    """Two joints at the centre of mass: without pairs as with them, the second one has a multiplier of least norm."""
    path = tmp_path / "twice.toml"
    joint = '[joints.{}]\nkind = "spherical"\nbetween = ["ground.base", "body.centre"]\n'
    path.write_text(
        'name = "twice"\n[scene]\ngravity = [0, 0, -9.81]\n[ground.markers]\nbase = [0, 0, 0]\n[bodies.body]\n'
        "mass = 1\ninertia = [0.1, 0.2, 0.25, 0, 0, 0]\nkeep_coordinates = true\nmarkers = { centre = [0, 0, 0] }\n"
        + joint.format("first")
        + joint.format("second")
    )
    model = lowered(path)
    assert model.proximal and len(model.multipliers) == 6
