"""Compiled scenes for the numerics: the paper's crank-slider, one that is pushed at its slider, bars in parallel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache

import numpy as np

import derive
from conftest import QUICK, ROOT
from derive.generated_models import generated, generated_explicit
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.loading import load_scene
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.closest_consistent_state import closest_consistent_state
from derive.simulation.initial.initial_guess import initial_guess
from derive.simulation.initial.initial_state import InitialState
from derive.spec.model.beam_parts import Frame
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse


@dataclass(frozen=True, eq=False)
class Compiled:
    """A scene, its kernels and the constants of its default parameters."""

    scene: Scene
    native: NativeScene
    k: Vector

    def start(self, t: float = 0.0) -> InitialState:
        """The consistent state closest to what the specification says, at the time t (s)."""
        return closest_consistent_state(self.native, self.k, *initial_guess(self.scene, self.native), t)


@cache
def crank_slider(pieces: int, frame: str = "mean", complete: bool = False) -> Compiled:
    """Set A with the rod in so many beams, each in the mean frame or in that of its middle."""
    scene = derive.read(ROOT / "scenes/crank_slider_3.toml")
    assert isinstance(scene, Scene)
    frames = {"mean": Frame("mean"), "point": Frame("point", Fraction(0))}
    bodies = tuple(
        replace(b, pieces=pieces, beam=replace(b.beam, frame=frames[frame])) if isinstance(b, BeamBody) else b
        for b in scene.bodies
    )
    return compiled(replace(scene, bodies=bodies), complete)


@cache
def pushed() -> Compiled:
    """A rigid crank-slider, crank 0.15 m, rod 0.3 m, whose slider is pushed to 0.3 m + 1 m/s t; it begins in line."""
    bodies = {
        "crank": (0.075, "hub = [-0.075, 0], pin = [0.075, 0]"),
        "rod": (0.3, "left = [-0.15, 0], right = [0.15, 0]"),
        "slider": (0.45, "pin = [0, 0]"),
    }
    text = 'name = "pushed"\n[ground.markers]\nbearing = [0, 0]\n'
    for name, (x, markers) in bodies.items():
        text += f"[bodies.{name}]\nmass = 0.1\ninertia = 1e-3\nmarkers = {{ {markers} }}\n"
        text += f"start = {{ position = [{x}, 0] }}\n"
    for name, first, second in (
        ("bearing", "ground.bearing", "crank.hub"),
        ("crank_pin", "crank.pin", "rod.left"),
        ("slider_pin", "rod.right", "slider.pin"),
    ):
        text += f'[joints.{name}]\nkind = "revolute"\nbetween = ["{first}", "{second}"]\n'
    text += '[joints.guide]\nkind = "translational"\nbetween = ["ground.bearing", "slider.pin"]\n'
    return compiled(parse(f'{text}[drives.push]\njoint = "guide"\nmotion = "0.3 + t"\n'), complete=True)


@cache
def bars(names: str) -> Compiled:
    """A coupler of 1 m on bars of 0.5 m that stay parallel; one is driven."""
    text = 'name = "bars"\n[bodies.coupler]\nmass = 1\ninertia = 0.1\nstart = { position = [0.77, 0.42] }\nmarkers = { '
    places = dict(zip(names, np.linspace(0, 1, len(names)), strict=True))
    text += ", ".join(f"{n} = [{x - 0.5}, 0]" for n, x in places.items()) + " }\n[ground.markers]\n"
    text += "".join(f"{n} = [{x}, 0]\n" for n, x in places.items())
    for n, x in places.items():
        text += f"[bodies.bar_{n}]\nmass = 0.5\ninertia = 0.01\nmarkers = {{ foot = [-0.25, 0], head = [0.25, 0] }}\n"
        text += f"start = {{ position = [{x + 0.135}, 0.21], angle = 1 }}\n"
        text += f'[joints.foot_{n}]\nkind = "revolute"\nbetween = ["ground.{n}", "bar_{n}.foot"]\n'
        text += f'[joints.head_{n}]\nkind = "revolute"\nbetween = ["bar_{n}.head", "coupler.{n}"]\n'
    return compiled(parse(f'{text}[drives.motor]\njoint = "foot_{names[0]}"\nmotion = "1 + 0.1*sin(t)"\n'))


@cache
def clamped(kind: str) -> Compiled:
    """A rod of 0.3 m, held at its left end, there turned by 0.05 if it is fixed; its right end slides along a line."""
    text = f"""name = "clamped"
[ground.markers]
a = [0, 0]
[bodies.rod]
mass = 0.1
length = 0.3
bending_stiffness = 10
markers = {{ left = -1, right = 1 }}
[bodies.slider]
mass = 0.1
inertia = 1e-4
markers = {{ pin = [0, 0] }}
[joints.left]
kind = "{kind}"
between = ["ground.a", "rod.left"]
{"angle = 0.05" if kind == "fixed" else ""}
[joints.right]
kind = "revolute"
between = ["rod.right", "slider.pin"]
[joints.guide]
kind = "translational"
between = ["ground.a", "slider.pin"]
"""
    return compiled(parse(text))


def compiled(scene: object, complete: bool = False) -> Compiled:
    """complete: with the functions that explicit integration does not call, which takes twice the time."""
    assert isinstance(scene, Scene)
    if complete:
        native = load_scene(generated(scene)[1], QUICK)
    else:
        model, files = generated_explicit(scene)
        native = with_iteration_matrix(load_scene(files, (*QUICK, *ESSENTIAL)), model)
    return Compiled(scene, native, native.setup())
