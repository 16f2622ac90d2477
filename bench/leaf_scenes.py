"""Mechanisms in space with flexible bodies on trees of rigid ones: arms, satellites, a crane, and a linkage."""

from __future__ import annotations

from typing import Any

import derive
from derive.spec.model.spatial_scene import SpatialScene

Table = dict[str, Any]
TURNED = {"x": [1, 0, 0], "z": [0, -1, 0]}
"""Axes whose z is -y of the body: the axes of an arm are parallel and normal to each other."""


def beam(modes: int, length: float = 0.6, mass: float = 1.5, **markers: Any) -> Table:
    """A beam with half of its modes in each of two planes, and torsion for an odd number."""
    bending = ["1", "xi", *(f"xi^{power}" for power in range(2, 2 + modes // 2))]
    table = {
        "length": length,
        "mass": mass,
        "rotary_inertia": 1e-3,
        "bending_stiffness": 60,
        "ansatz": bending,
        "lateral": {"bending_stiffness": 40},
        "markers": {"left": -1, "right": 1, **markers},
    }
    return table | ({"torsion": {"ansatz": ["xi"], "stiffness": 20}} if modes % 2 else {})


def rigid(mass: float, **markers: Any) -> Table:
    """A rigid body with its centre beside the joint."""
    inertia = [0.02 * mass, 0.03 * mass, 0.04 * mass, 0.001, 0.002, 0]
    return {"mass": mass, "centre": [0.1, 0, 0.02], "inertia": inertia, "markers": {"root": [0, 0, 0], **markers}}


def arm(modes: int) -> SpatialScene:
    """Six hinges: five rigid links, and a flexible one behind the sixth hinge."""
    bodies: Table = {f"link{k}": rigid(6 - k, tip=_turned([0.3, 0, 0.1], k)) for k in range(1, 6)}
    hinge = {"at": -1, "rotation": {"x": [0, 1, 0], "z": [0, 0, 1]}}
    bodies["link6"] = beam(modes, left=hinge)
    joints = {f"joint{k}": _joint("revolute", f"link{k - 1}.tip", f"link{k}.root") for k in range(2, 6)}
    joints |= {
        "joint1": _joint("revolute", "ground.root", "link1.root"),
        "joint6": _joint("revolute", "link5.tip", "link6.left"),
    }
    return _scene(f"arm_{modes}", bodies, joints)


def satellite(modes: int) -> SpatialScene:
    """A free body with a wheel, and two flexible panels behind hinges."""
    sides = {"port": -1, "starboard": 1}
    hinges = {side: {"at": [0, 0.5 * s, 0], "rotation": {"z": [0, s, 0], "x": [1, 0, 0]}} for side, s in sides.items()}
    bodies = {"hub": rigid(60, wheel=[0, 0, 0.2], **hinges), "wheel": rigid(2)}
    own = {"at": -1, "rotation": {"z": [1, 0, 0], "x": [0, 1, 0]}}
    joints = {"axle": _joint("revolute", "hub.wheel", "wheel.root")}
    for side in sides:
        bodies[f"{side}_panel"] = beam(modes, 3, 8, left=own)
        joints[f"{side}_hinge"] = _joint("revolute", f"hub.{side}", f"{side}_panel.left")
    return _scene(f"satellite_{modes}", bodies, joints, [0, 0, 0])


def linkage(modes: int) -> SpatialScene:
    """A four-bar linkage in space, two hinges and two ball joints, with a flexible coupler."""
    bodies = {"crank": rigid(1, tip=[0.1, 0, 0]), "rocker": rigid(2, tip=[0.3, 0, 0]), "coupler": beam(modes)}
    joints = {
        "crank_hinge": _joint("revolute", "ground.root", "crank.root"),
        "rocker_hinge": _joint("revolute", "ground.far", "rocker.root"),
        "first_ball": _joint("spherical", "crank.tip", "coupler.left"),
        "second_ball": _joint("spherical", "rocker.tip", "coupler.right"),
    }
    return _scene(f"linkage_{modes}", bodies, joints)


def crane(modes: int) -> SpatialScene:
    """A column that turns, a flexible boom that a cylinder lifts, and a load that hangs at its end."""
    across, along = {"z": [0, -1, 0], "x": [1, 0, 0]}, {"z": [1, 0, 0], "x": [0, 1, 0]}
    bodies = {
        "column": rigid(100, foot={"at": [0, 0, 1], "rotation": across}, low={"at": [0.2, 0, 0], "rotation": across}),
        "barrel": {**rigid(5, bore={"at": [0.2, 0, 0], "rotation": along})},
        "piston": {
            **rigid(4, eye={"at": [0.3, 0, 0]}),
            "markers": {"root": {"at": [0, 0, 0], "rotation": along}, "eye": [0.3, 0, 0]},
        },
        "boom": beam(modes, 4, 60, left={"at": -1, "rotation": {"z": [0, -1, 0], "x": [1, 0, 0]}}, lug="-1/2"),
        "load": rigid(50),
    }
    joints = {
        "slew": _joint("revolute", "ground.root", "column.root"),
        "foot": _joint("revolute", "column.foot", "boom.left"),
        "low": _joint("revolute", "column.low", "barrel.root"),
        "stroke": _joint("prismatic", "barrel.bore", "piston.root"),
        "lug": _joint("spherical", "piston.eye", "boom.lug"),
        "hook": _joint("spherical", "boom.right", "load.root"),
    }
    return _scene(f"crane_{modes}", bodies, joints)


SCENES = {"arm": arm, "satellite": satellite, "linkage": linkage, "crane": crane}


def leaf_scene(name: str) -> SpatialScene:
    """The scene of a name such as arm_4, which ends with the number of modes of each flexible body."""
    kind, modes = name.rsplit("_", 1)
    return SCENES[kind](int(modes))


def _scene(name: str, bodies: Table, joints: Table, gravity: list[float] | None = None) -> SpatialScene:
    ground: Table = {"root": [0, 0, 0], "far": {"at": [0.5, 0.1, 0], "rotation": TURNED}}
    return derive.spatial_scene(
        name,
        ground=ground,
        gravity=[0, 0, -9.81] if gravity is None else gravity,
        bodies=bodies,
        joints=joints,
        forces={
            "push": {
                "at": "boom.right" if "boom" in bodies else next(f"{b}.left" for b in bodies if "length" in bodies[b]),
                "force": [1, 2, 3],
            }
        },
    )


def _joint(kind: str, first: str, second: str) -> Table:
    return {"kind": kind, "between": [first, second]}


def _turned(at: list[float], k: int) -> Table:
    return {"at": at, "rotation": TURNED} if k % 2 else {"at": at}
