"""Scenes on which the estimates of the monitors are calibrated: what bends beams in the plane, from little to too much.

Each has beams of mass, length and bending stiffness 1 unless it is a mechanism of the project. The models of their
beams are put in by `bench/monitors.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import derive
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

SCENES = Path(__file__).parent.parent / "scenes"
POLYNOMIALS = ["1", "xi", "xi^2", "xi^3"]


def beam(length: float = 1, stiffness: float = 1, mass: float = 1, **more: Any) -> dict[str, Any]:
    """A beam with markers at its ends and in its middle."""
    markers = {"left": -1, "middle": 0, "right": 1}
    shape = {"ansatz": POLYNOMIALS, "frame": "mean", "markers": markers}
    return {**shape, "mass": mass, "length": length, "bending_stiffness": stiffness, **more}


def scene(name: str, duration: float, **parts: Any) -> Scene:
    """A scene with 400 rows."""
    return derive.scene(name, simulation={"duration": duration, "output": duration / 400}, **parts)


def at(x: float, y: float = 0, **more: Any) -> dict[str, Any]:
    """A start at this position."""
    return {"start": {"position": [x, y], **more}}


def struck(rate: float, duration: float, spin: float = 0) -> Scene:
    """A free beam whose initial deflection rate is P2."""
    start = {"deflection_rate": f"{rate}*(3/2*xi^2 - 1/2)", **({"spin": spin} if spin else {})}
    name = f"struck_{rate}_{duration}" + (f"_{spin}" if spin else "")
    return scene(name.replace(".", "_"), duration, bodies={"rod": beam(start=start)})


def knocked(spin: float, force: float) -> Scene:
    """A free beam that spins and receives a blow in its middle."""
    blow = {"at": "rod.middle", "components": [0, f"{force}/(1 + (50*t)^2)^2"]}
    name = f"knocked_{spin}_{force}".replace(".", "_")
    return scene(name, 1.0, bodies={"rod": beam(start={"spin": spin})}, forces={"blow": blow})


def pendulum(stiffness: float, duration: float = 1.5) -> Scene:
    """A beam that falls from the horizontal about a pin."""
    return scene(
        f"pendulum_{stiffness}".replace(".", "_"),
        duration,
        gravity=[0, -9.81],
        ground={"pin": [0, 0]},
        bodies={"rod": beam(stiffness=stiffness, **at(0.5))},
        joints={"pin": {"kind": "revolute", "between": ["ground.pin", "rod.left"]}},
    )


def clamped(name: str, duration: float, across: str = "0", along: str = "0", **more: Any) -> Scene:
    """A cantilever with a force on its tip."""
    return scene(
        name,
        duration,
        ground={"wall": [0, 0]},
        bodies={"rod": beam(**at(0.5))},
        joints={"clamp": {"kind": "weld", "between": ["ground.wall", "rod.left"]}},
        forces={"load": {"at": "rod.right", "components": [along, across]}},
        **more,
    )


def between_pins(name: str, duration: float, along: str, across: str, left: str = "revolute") -> Scene:
    """A beam between a support and a head that slides along its axis."""
    return scene(
        name,
        duration,
        ground={"foot": [0, 0]},
        bodies={
            "rod": beam(**at(0.5)),
            "head": {"mass": 0.01, "inertia": 1e-4, "markers": {"pin": [0, 0]}, **at(1)},
        },
        joints={
            "foot": {"kind": left, "between": ["ground.foot", "rod.left"]},
            "top": {"kind": "revolute", "between": ["rod.right", "head.pin"]},
            "guide": {"kind": "translational", "between": ["ground.foot", "head.pin"], "axis": [1, 0]},
        },
        forces={
            "load": {"at": "head.pin", "components": [along, 0]},
            "push": {"at": "rod.middle", "components": [0, across]},
        },
    )


def arm(name: str, angle: float, time: float, tip: float) -> Scene:
    """A beam that a drive turns from rest to rest, with a mass at its tip, and then rings."""
    motion = f"{angle}*piecewise(t < {time}, t/{time} - sin(2*pi*t/{time})/(2*pi), 1)"
    return scene(
        name,
        2 * time,
        ground={"axis": [0, 0]},
        bodies={
            "rod": beam(**at(0.5)),
            "load": {"mass": tip, "inertia": 1e-4, "markers": {"pin": [0, 0]}, **at(1)},
        },
        joints={
            "shaft": {"kind": "revolute", "between": ["ground.axis", "rod.left"]},
            "grip": {"kind": "revolute", "between": ["rod.right", "load.pin"]},
        },
        drives={"motor": {"joint": "shaft", "motion": motion}},
    )


def own(file: str, name: str, duration: float, *changes: tuple[str, str]) -> Scene:
    """A scene of the project over another time, with other text in some places."""
    text = (SCENES / f"{file}.toml").read_text().split("[plots")[0]
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    known = parse(text)
    assert known.simulation is not None
    return replace(known, name=name, simulation=replace(known.simulation, duration=duration, output=duration / 400))


def scenes() -> Iterator[Scene]:
    """All of them."""
    for rate, duration in ((0.3, 1.1), (1.0, 0.6), (1.4, 1.1), (1.95, 1.1), (3.5, 0.6)):
        yield struck(rate, duration)
    yield struck(0.5, 0.6, 10)
    for spin, force in ((2, 5), (6, 5), (10, 5), (20, 5)):
        yield knocked(spin, force)
    for stiffness in (1, 3, 10, 50, 300):
        yield pendulum(stiffness)
    for load in (0.1, 0.5, 1.0, 2.0):
        yield clamped(f"step_{load}".replace(".", "_"), 3.6, across=f"{load}")
    for load in (0.5, 1.5, 3.0):
        yield clamped(f"slow_{load}".replace(".", "_"), 20.0, across=f"{load}*t/20")
    for load in (-0.2, -1.0, 2.0):
        yield clamped(f"strut_{load}".replace(".", "_").replace("-", "m"), 3.6, across="0.1", along=f"{load}")
    for load in (-0.2, -0.5, -2.0, -5.0, 5.0):
        yield between_pins(f"column_{load}".replace(".", "_").replace("-", "m"), 1.3, f"{load}", "0.5")
    for push in (2.0, 5.0, 10.0):
        yield between_pins(f"push_{push}".replace(".", "_"), 1.3, "0", f"{push}")
    yield between_pins("slow_push", 10.0, "0", "8*t/10")
    yield between_pins("propped", 1.0, "-1", "3*sin(5*t)", "weld")
    for angle, time, tip in ((0.5, 2.0, 0.2), (1.5, 2.0, 0.0001), (1.5, 4.0, 1.0), (6.28, 3.0, 0.1)):
        yield arm(f"arm_{angle}_{time}_{tip}".replace(".", "_"), angle, time, tip)
    for spin in (1, 3, 6):
        yield own("spun_up_cantilever", f"spun_up_{spin}", 18.0, ("6/15", f"{spin}/15"))
    yield own("spun_up_cantilever", "spinning_up_6", 9.0)
    for speed in (50, 100, 150, 250):
        yield own("crank_slider_3", f"slider_{speed}", 15.0 / speed, ("speed = 150", f"speed = {speed}"))
    for speed in (1, 2):
        yield own("four_bar", f"four_bar_{speed}", 2.0 / speed, ("4*pi*t/3", f"{speed}*4*pi*t/3"))
    yield own("double_pendulum", "double_pendulum_short", 0.6)
    yield own("double_pendulum", "double_pendulum_long", 2.0)
    yield own("double_pendulum", "double_pendulum_stiff", 1.0, ("2.5132741", "40"))
