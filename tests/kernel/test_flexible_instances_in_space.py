"""Loops over beams and finite-element bodies in space compute what straight-line code computes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from both_lowerings import TOLERANCE, both, check, difference
from test_instances_in_space import BEAMS

import derive
from derive.lowering.instances.classes.body_classes import body_classes
from derive.spec.toml.read import parse
from some_functions import only

ROD = Path(__file__).parents[2] / "examples" / "spatial_rod.npz"
RODS = """
name = "rods"
[scene]
gravity = [0.5, 0, -9.81]
lowering = "instances"
[ground.markers]
hook = [0, 0, 0]
[bodies.rod]
count = 3
nodes = "{rod}"
units = "SI"
modes = 2
[bodies.rod.markers]
left = {{ nodes = [0, 1, 2, 3, 4, 5, 6, 7, 8] }}
right = {{ nodes = [108, 109, 110, 111, 112, 113, 114, 115, 116], rotation = {{ x = [0, 0, 1], z = [0, 1, 0] }} }}
[joints.hook]
kind = "{kind}"
between = ["ground.hook", "rod[0].left"]
[joints.hinge]
count = 2
kind = "{kind}"
between = ["rod[i].right", "rod[i+1].left"]
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("order", "frame", "kind"),
    [(1, "mean", "revolute"), (1, "tangent", "spherical"), (2, "mean", "spherical")],
)
def test_chains_of_beams(order: int, frame: str, kind: str) -> None:
    """Three beams, which differ in their masses."""
    of_frame = '{ kind = "tangent", at = -1 }' if frame == "tangent" else f'"{frame}"'
    check(both(parse(BEAMS.format(order=order, frame=of_frame, kind=kind)), True))


@pytest.mark.parametrize("kind", ["spherical", pytest.param("fixed", marks=pytest.mark.long)])
def test_chains_of_finite_element_bodies(kind: str) -> None:
    """Three bodies of one file."""
    check(both(parse(RODS.format(rod=ROD, kind=kind)), True))


def test_bodies_of_different_files_have_one_code(tmp_path: Path) -> None:
    """Finite-element bodies in space whose numbers differ, also those of their markers, are of one class."""
    arrays = dict(np.load(ROD))
    np.savez(tmp_path / "other.npz", **{**arrays, "positions": 1.01 * arrays["positions"]})
    text = RODS.format(rod=ROD, kind="spherical").replace("count = 3\n", "", 1)
    bodies = text[text.index("[bodies.rod]") : text.index("[joints.hook]")]
    other = bodies.replace("bodies.rod", "bodies.more").replace(str(ROD), str(tmp_path / "other.npz"))
    scene = parse(text[: text.index("[bodies.rod]")] + bodies + other)
    (of,) = body_classes(derive.derive(scene))
    assert len(of.members) == 2
    first, second = ([c.value for c in m.instance.component.point_constants] for m in of.members)
    assert first != second


DAMPED = """
name = "damped"
[scene]
gravity = [0, 1, -9.81]
lowering = "instances"
[ground.markers]
hook = { at = [0, 0, 0] }
[bodies.rod]
length = 1
mass = 0.5
bending_stiffness = 5
rotary_inertia = 1e-4
ansatz = ["1", "xi", "xi^2"]
torsion = { stiffness = 3, ansatz = ["xi"] }
pieces = 2
damping = { ratio = 0.05 }
markers = { left = -1, inner = 0.25 }
[joints.ball]
kind = "spherical"
between = ["ground.hook", "rod.left"]
[outputs.flow]
kind = "power"
"""


def test_damping_between_the_pieces_of_a_beam_and_section_forces() -> None:
    """Section forces of beams with parameters have constants of their own."""
    section = DAMPED + '[outputs.cut]\nkind = "shear_force"\nsection = "rod.inner"\n'
    check(both(parse(section), True))
    with_parameter = section.replace("mass = 0.5", 'mass = { symbol = "m", default = 0.5 }')
    with only("outputs"):
        of = both(parse(with_parameter), True)
    assert difference(of, of.flat.kernel("outputs")) <= TOLERANCE
