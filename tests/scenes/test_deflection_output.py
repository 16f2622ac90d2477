"""The deflection as an output: that of the positions of its markers, in C and Python, and the curve of a plot of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made import close, make, state

import derive
from derive.simulation.observables.plots import plot_curves, plot_text
from derive.spec.as_tables import scene_tables
from derive.spec.model.scene import Scene
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from explicit_motion import moved

PENDULUM = """
name = "bent"
ground.markers = { o = [0, 0] }
scene.gravity = [0, -9.81]
[bodies.rod]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = "mean"
mass = 0.4
length = 0.8
bending_stiffness = 3
pieces = PIECES
markers = { left = -1, middle = "1/3", right = 1 }
start = { angle = 0.3 }
[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]
[outputs.bend]
kind = "deflection"
marker = "rod.middle"
chord = ["rod.left", "rod.right"]
[outputs.ratio]
kind = "deflection"
marker = "rod.middle"
chord = ["ground.o", "rod.right"]
divided_by = 0.8
[outputs.middle]
kind = "position"
marker = "rod.middle"
[outputs.right]
kind = "position"
marker = "rod.right"
[outputs.left]
kind = "position"
marker = "rod.left"
[plots.bend]
deflection = "rod.middle"
chord = ["rod.left", "rod.right"]
[plots.ratio]
deflection = "rod.middle"
chord = ["ground.o", "rod.right"]
divided_by = 0.8
[simulation]
duration = 0.1
output = 0.01
"""


def scene(pieces: int = 1) -> Scene:
    result = parse(PENDULUM.replace("PIECES", str(pieces)))
    assert isinstance(result, Scene)
    return result


@pytest.mark.parametrize("pieces", [1, 2])
def test_it_is_the_distance_from_the_line_of_the_chord(pieces: int) -> None:
    made = make(scene(pieces), complete=True)
    native, k = made.native, made.native.setup()
    t, q, v = state(native, 4)
    values = native.evaluate_outputs(t, q, v, *native.solve(t, q, v, k), k)
    outputs = dict(zip(native.outputs, values, strict=True))
    middle, right, left = (complex(outputs[f"{name}_1"], outputs[f"{name}_2"]) for name in ("middle", "right", "left"))
    close([outputs["bend"]], [((middle - left) / (right - left) * abs(right - left)).imag], 1e-13)
    close([outputs["ratio"]], [(middle / right * abs(right)).imag / 0.8], 1e-13)
    close(made.python["outputs"](t, q, v, *native.solve(t, q, v, k), k), values, 1e-13)


def test_a_plot_shows_the_column() -> None:
    spec = scene()
    run = moved(spec)
    assert np.abs(run["bend"]).max() > 1e-3
    for plot, unit, label in zip(spec.plots, ("m", ""), ("deflection", "deflection / 0.8 m"), strict=True):
        (curve,) = plot_curves(plot, run, "")
        close(curve.y, run[plot.name], 1e-13)
        assert (curve.unit, curve.quantity) == (unit, label)
        assert run.units[plot.name] == unit
    assert plot_text(spec.plots[1], spec, run.units).doc == (
        "deflection of rod.middle from the chord ground.o to rod.right, divided by 0.8 m"
    )


def test_it_is_written_back_and_set() -> None:
    tables = scene_tables(scene())
    assert tables["plots"] == {
        "bend": {"deflection": "rod.middle", "chord": ["rod.left", "rod.right"]},
        "ratio": {"deflection": "rod.middle", "chord": ["ground.o", "rod.right"], "divided_by": 0.8},
    }
    changed, _ = with_values(scene(), {"outputs.ratio.divided_by": "2"})
    assert changed.outputs[1].values["divided_by"] == 2


@pytest.mark.parametrize("section", ["outputs", "plots"])
def test_both_ends_of_a_chord_differ(section: str) -> None:
    before, after = PENDULUM.replace("PIECES", "1").split(f"[{section}.bend]")
    text = before + f"[{section}.bend]" + after.replace('"rod.right"]', '"rod.left"]', 1)
    with pytest.raises(derive.SpecError, match=rf"{section}.bend.chord: a chord is between two markers, and these are"):
        parse(text, str(Path("bent.toml")))


@pytest.mark.parametrize("section", ["outputs", "plots"])
def test_no_joint_holds_both_ends_of_a_chord_at_one_place(section: str) -> None:
    before, after = PENDULUM.replace("PIECES", "1").split(f"[{section}.bend]")
    text = before + f"[{section}.bend]" + after.replace('"rod.right"]', '"ground.o"]', 1)
    with pytest.raises(derive.SpecError, match=rf"{section}.bend.chord: the joint .* holds both markers at one place"):
        parse(text, str(Path("bent.toml")))
