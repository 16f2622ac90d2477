"""Beams as the models of a ladder have them: initial deflections that they do not have, masses, outputs."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from derive.cli.main import main
from derive.errors import SpecError
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import RigidBody
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.measurement import compiled
from derive.study.accuracy.models import model_scene, start_remainders

STRUCK = """
name = "struck"
[bodies.rod]
mass = 1
length = 2
bending_stiffness = 1
{keys}
markers = {{ left = -1, middle = 0, right = 1 }}
start = {start}
[outputs]
moment = {{ kind = "bending_moment", section = "rod.middle" }}
end = {{ kind = "position", marker = "rod.right" }}
[simulation]
duration = 0.01
output = 0.01
[plots.end]
y = ["end_2"]
"""
RATE = '{{ velocity = [0, 1], spin = 0.5, deflection_rate = "xi^2 + 3*xi^3/10"{} }}'
POLYNOMIALS = 'ansatz = ["1", "xi", "xi^2", "xi^3"]'
SINE = 'ansatz = { kind = "pinned", count = 1 }'
RIGID, SINES = LadderModel(Shapes.RIGID), LadderModel(Shapes.SINES, 2)
CLAMPED, PARABOLA = LadderModel(Shapes.CLAMPED_FREE, 2), LadderModel(Shapes.POLYNOMIALS, 1)
TRUNCATED = DisplacementOrder.TRUNCATED


def text(keys: str = POLYNOMIALS, guess: str = "") -> str:
    """A free rod that is struck."""
    return STRUCK.format(keys=keys, start=RATE.format(guess))


def struck(keys: str = POLYNOMIALS, guess: str = "") -> Scene:
    scene = parse(text(keys, guess))
    assert isinstance(scene, Scene)
    return scene


def shapes(model: LadderModel, xi: np.ndarray) -> list[np.ndarray]:
    """The shape functions without conditions of a frame."""
    match model.shapes:
        case Shapes.SINES:
            return [np.cos(np.pi * xi / 2), np.sin(np.pi * xi)]
        case Shapes.CLAMPED_FREE:
            result = []
            for b in (1.875104068711961, 4.694091132974175):
                x, s = b * (xi + 1) / 2, (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
                result.append(np.cosh(x) - np.cos(x) - s * (np.sinh(x) - np.sin(x)))
            return result
        case _:
            return [xi**n for n in range(2, model.count + 2)]


@pytest.mark.parametrize("model", [SINES, CLAMPED, PARABOLA, RIGID], ids=lambda model: model.label)
def test_a_start_that_shapes_do_not_have_is_replaced_by_the_nearest(model: LadderModel) -> None:
    """The velocities of the ends and the middle are those of a least-squares fit on a grid; the rest is stated."""
    scene = struck()
    of = compiled(scene, model, monitored=False)
    xi = (np.arange(8001) - 4000) / 4000
    basis = np.array([np.ones_like(xi), xi, *shapes(model, xi)])
    curve = xi**2 + 0.3 * xi**3
    nearest = np.linalg.lstsq(basis.T, curve, rcond=None)[0] @ basis
    for name, place in (("left", 0), ("middle", 4000), ("right", 8000)):
        _, velocity, _ = of.native.marker(f"rod_{name}", of.start.q, of.start.v, of.k)
        assert velocity[1] == pytest.approx(1 + 0.5 * xi[place] + nearest[place], abs=2e-3), name
    (line,) = start_remainders(scene, model)
    stated = re.search(r"deflection_rate: ([\d.]+) % of it", line)
    left = np.sqrt(np.mean((curve - nearest) ** 2) / np.mean(curve**2))
    assert stated is not None and float(stated[1]) / 100 == pytest.approx(left, rel=0.02)


def test_a_start_that_shapes_have_is_kept() -> None:
    model = LadderModel(Shapes.POLYNOMIALS, 2, TRUNCATED, "mean", 2)
    assert start_remainders(struck(), model) == ()
    assert all(not body.start.guess for body in model_scene(struck(), model).bodies)


def test_a_guess_takes_the_nearest_curve_and_a_run_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SpecError, match=r"cannot describe this curve.*or write `guess = true`, which takes"):
        struck(SINE)
    spec = tmp_path / "struck.toml"
    spec.write_text(text(SINE, ", guess = true").replace("moment =", "# moment ="))
    assert main(["simulate", str(spec), "--out", str(tmp_path)]) == 0
    assert re.search(r"deflection_rate: [\d.]+ % of it \(rms\) is not in the shapes of rod", capsys.readouterr().out)


def test_a_rigid_beam_keeps_its_attached_masses() -> None:
    masses = "[bodies.rod.masses]\ntip = { at = 1, mass = 0.5, inertia = 0.01 }\n[outputs]"
    scene = parse(text().replace("[outputs]", masses))
    assert isinstance(scene, Scene)
    rigid = next(body for body in model_scene(scene, RIGID).bodies if body.name == "rod")
    assert isinstance(rigid, RigidBody)
    mass, x, inertia = (float(value) for value in (rigid.mass, rigid.centre[0], rigid.inertia))  # type: ignore[arg-type]
    assert (mass, x) == pytest.approx((1.5, 1 / 3))
    assert inertia == pytest.approx(1 * 2**2 / 12 + 1 / 9 + 0.01 + 0.5 * (2 / 3) ** 2)


def test_outputs_that_no_plot_shows_do_not_matter() -> None:
    """A bending moment needs a beam, and must not remove the rigid one from a ladder unless it is compared."""
    scene = struck()
    assert [output.name for output in model_scene(scene, RIGID).outputs] == ["end"]
    of_moment = parse(text().replace('y = ["end_2"]', 'y = ["moment"]'))
    assert isinstance(of_moment, Scene)
    with pytest.raises(SpecError, match=r"outputs.moment.section: the body rod is no beam"):
        model_scene(of_moment, RIGID)


def test_beams_of_a_scene_have_models_of_their_own() -> None:
    both = mixed({"crank": RIGID, "rod": SINES, "coupler": RIGID})
    assert both.label == "crank, coupler: rigid; rod: 2 sines, first"
    assert both.of("crank") is RIGID and both.of("rod") is SINES and both.count == 2
    assert mixed({"crank": SINES, "rod": SINES}) is SINES
    body = next(body for body in model_scene(struck(), mixed({"rod": RIGID, "x": SINES})).bodies)
    assert isinstance(body, RigidBody)
