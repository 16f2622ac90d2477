"""The crank-slider with parameter set A, whose rod is of second order: one beam is enough, if it has the shapes.

Errors are those of the deflection of the middle, in % of its peak, over 0.1 s, against a nonlinear finite-element
run, which is itself good to 0.1 %: below that a figure says only that the model is within the error of the reference.
"""

from __future__ import annotations

import numpy as np
import pytest
from rod_models import compiled_scene

from conftest import ROOT
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.observables.marker_positions import deflection
from derive.simulation.observables.motion import SceneMotion
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

SCENE = ROOT / "scenes" / "crank_slider_3.toml"


SINE, PINNED = '{ kind = "pinned", count = 1 }', 'ends = "pinned"'


def legendre(highest: int) -> str:
    """The ansatz of polynomials up to a degree."""
    return str([f"xi^{n}" for n in range(highest + 1)])


def changed(pieces: int, ansatz: str, order: str, keys: str = "") -> Scene:
    """The scene with the rod in so many beams, with an ansatz, an order and more keys."""
    text = SCENE.read_text()
    changes = {
        "pieces = 3 ": f"pieces = {pieces} ",
        'ansatz = ["1", "xi", "xi^2", "xi^3"] ': f"ansatz = {ansatz}\n{order}\n{keys} ",
        'cut = "rod"': "",
        "pieces = [1, 2, 3]": "",
        **({'frame = "mean"': ""} if ansatz == SINE else {}),  # sines have a frame of their own
    }
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    scene = parse(text, str(SCENE))
    assert isinstance(scene, Scene)
    return scene


FIRST, TRUNCATED, FULL = "", 'order = 2\nterms = "truncated"', 'order = 2\nterms = "full"'


@pytest.mark.long
@pytest.mark.parametrize(
    ("pieces", "ansatz", "order", "keys", "rms", "worst"),
    [
        pytest.param(1, legendre(3), TRUNCATED, "", 21.8, 54.8, marks=pytest.mark.long),
        (1, legendre(4), TRUNCATED, "", 0.068, 0.16),
        pytest.param(1, legendre(4), FULL, "", 0.082, 0.24, marks=pytest.mark.long),
        pytest.param(2, legendre(3), TRUNCATED, "", 2.55, 6.38, marks=pytest.mark.long),
        pytest.param(1, SINE, FIRST, "", 12.53, 27.5, marks=pytest.mark.long),
        (1, SINE, TRUNCATED, "", 0.267, 0.823),
        pytest.param(1, SINE, FULL, "", 0.295, 0.921, marks=pytest.mark.long),
        pytest.param(1, legendre(4), FIRST, PINNED, 12.3, 26.2, marks=pytest.mark.long),
        (1, legendre(4), TRUNCATED, PINNED, 0.342, 0.873),
        pytest.param(1, legendre(4), FULL, PINNED, 0.306, 0.763, marks=pytest.mark.long),
    ],
)
def test_deflections(pieces: int, ansatz: str, order: str, keys: str, rms: float, worst: float) -> None:
    """P2, P3 in one frame is not rescued by second order: its pinned frequency is 11 % high. P4 is what it lacks.

    One shape that fits pinned ends is enough: a half sine wave in the chord frame, or xi^4 - 6 xi^2 + 9/5. With first
    order the rows of polynomials are 20.6, 12.4 and 3.0 % rms.
    """
    scene = changed(pieces, ansatz, order, keys)
    native = compiled_scene(scene)
    k = native.setup()
    start = initial_state(scene, native, k)
    found = integrate(native, k, start.q, start.v, np.linspace(0, 0.1, 1001), tolerance=1e-6)
    (plot,) = scene.plots
    bent = deflection(SceneMotion(scene, native, k, found.t, found.q, found.v), plot.quantity)
    assert plot.reference is not None
    angle, reference = np.array(plot.reference.rows).T
    error = 100 * np.abs(bent - np.interp(150 * found.t, angle, reference)) / np.abs(reference).max()
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, rel=0.01)
    assert error.max() == pytest.approx(worst, rel=0.02)
