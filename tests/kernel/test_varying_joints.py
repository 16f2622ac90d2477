"""Loops over bodies where joints depend on both of their bodies, or where both ends of joints and springs are known.

Straight-line code of the same scenes is the measure, as it is for random graphs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from both_lowerings import check, results
from random_graphs import Graph, lowered

import derive

BEAM = {
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "bending_stiffness": 3,
    "mass": 1,
    "length": 1,
    "markers": {"left": -1, "middle": 0, "right": 1},
}
RIGID = {"mass": 2, "inertia": 0.1, "markers": {"left": [-0.4, 0], "right": [0.5, 0]}}
GROUND = {"origin": [0, 0], "aside": [1, 0.5]}


def made(bodies: dict[str, Any], joints: dict[str, Any], redundant: int = 0, **more: Any) -> Graph:
    """A scene lowered both ways."""
    result = lowered(derive.scene("scene", ground=GROUND, bodies=bodies, joints=joints, **more), "", 3, True, redundant)
    assert result
    return result


def between(kind: str, first: str, second: str, **keys: Any) -> dict[str, Any]:
    return {"kind": kind, "between": [first, second], **keys}


def test_outputs_of_bodies_that_slide_along_each_other() -> None:
    """The reaction at the bearing of an arm, and the bending moment in a beam, contain those of what slides on them."""
    of = made(
        {"arm": RIGID, "carriage": RIGID, "beam": BEAM, "far": BEAM},
        {
            "bearing": between("revolute", "ground.origin", "arm.left"),
            "guide": between("translational", "arm.right", "beam.left", axis=[1, 2]),
            "rail": between("translational", "arm.right", "carriage.left", axis=[1, 2]),
            "slide": between("translational", "carriage.right", "beam.right"),
            "pin": between("revolute", "ground.aside", "far.left"),
        },
        outputs={
            "held": {"kind": "reaction", "joint": "bearing"},
            "bent": {"kind": "bending_moment", "section": "beam.middle"},
            "pushed": {"kind": "reaction", "joint": "slide"},
            "away": {"kind": "distance", "between": ["carriage.right", "ground.aside"]},
        },
    )
    assert [c.name for c in of.flat.coordinates][:1] == ["arm_phi"], "the bearing is a constraint"
    check(of)
    names = {name for kernel in of.instances.kernels for name in kernel.used}
    assert not any("far" in name for name in names if "output" in name), "an output reads a body that it does not need"


def test_springs_and_forces_between_markers_whose_motion_is_known() -> None:
    """They store energy if neither end moves, and are part of what drives and bearings exert.

    Outputs depend on the input that drives the arm through its motion alone.
    """
    of = made(
        {"arm": RIGID, "post": RIGID, "beam": BEAM},
        {
            "bearing": between("revolute", "ground.origin", "arm.left"),
            "foot": between("weld", "ground.aside", "post.left"),
            "pin": between("revolute", "arm.right", "beam.left"),
        },
        inputs={"turn": {"unit": "rad", "value": 0}},
        drives={"motor": {"joint": "bearing", "motion": {"input": "turn"}}},
        springs={
            "moved": between("linear", "ground.aside", "arm.right", stiffness=3, rest=0.1, damping=0.2),
            "still": between(
                "linear", "ground.origin", "post.right", stiffness={"symbol": "c", "default": 2.0}, rest=0.1
            ),
            "both": between("linear", "arm.left", "post.right", stiffness=2),
        },
        forces={"push": {"at": "arm.right", "components": ["sin(t)", 1]}},
        outputs={
            "turned": {"kind": "drive", "drive": "motor"},
            "held": {"kind": "reaction", "joint": "foot"},
            "pulled": {"kind": "spring", "spring": "still"},
            "energies": {"kind": "energy"},
            "powers": {"kind": "power"},
        },
    )
    check(of)
    of.state["q"] = [0.0] * len(of.state["q"])
    length = np.hypot(1.9, 0.5)  # from the origin, where the arm is held as well, to the end of the post
    energy = 2 * (length - 0.1) ** 2 / 2 + 2 * length**2 / 2
    assert results(of, of.instances, "energy")["energy"][1] == pytest.approx(energy)


@pytest.mark.parametrize("kind", ["translational", "weld"])
def test_joints_between_bodies_without_coordinates(kind: str) -> None:
    """They are redundant, and no body takes part in them; their reactions of least norm vanish."""
    of = made(
        {"post": RIGID, "arm": RIGID, "beam": BEAM},
        {
            "foot": between("weld", "ground.origin", "post.left"),
            "head": between("weld", "post.right", "arm.left"),
            "idle": between(kind, "post.right", "arm.left"),
            "pin": between("revolute", "arm.right", "beam.left"),
        },
        redundant={"translational": 2, "weld": 3}[kind],
        outputs={"idle": {"kind": "reaction", "joint": "idle"}, "held": {"kind": "reaction", "joint": "foot"}},
    )
    assert of.instances.proximal
    check(of)
    assert np.array_equal(results(of, of.instances, "solve")["lam"][:-2], np.zeros(len(of.flat.multipliers) - 2))
