"""The crank-slider with parameter set A: what the rest of PHYSICS section 3 says, beside `tests/simulation`.

Deflections are those of the middle of the rod from its chord, over its length, in 0.1 s. The reference is a nonlinear
finite-element run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from made import of, text_of

import derive
from conftest import ROOT
from derive.spec.toml.read import parse

SCENE = ROOT / "scenes" / "crank_slider_3.toml"

CUBIC = 'ansatz = ["1", "xi", "xi^2", "xi^3"] '


@dataclass(frozen=True)
class Rod:
    """The text of the scene with the rod in so many beams, in a frame, with polynomials up to a degree."""

    pieces: int
    frame: str
    highest: int = 3

    def __call__(self, text: str) -> str:
        ansatz = ", ".join(f'"xi^{n}"' for n in range(self.highest + 1))
        changes = {
            "pieces = 3 ": f"pieces = {self.pieces} ",
            CUBIC: f"ansatz = [{ansatz}] ",
            'frame = "mean"': f'frame = "{self.frame}"',
        }
        for old, new in changes.items():
            assert text.count(old) == 1
            text = text.replace(old, new)
        return text


@pytest.mark.parametrize(("pieces", "mean", "point"), [(1, 6, 16), (2, 11, 31), (3, 16, 46)])
def test_non_zeros_of_the_mass_matrix(pieces: int, mean: int, point: int) -> None:
    """Beams and slider. A beam has 5 of 25 entries in the mean frame and 15 in that of its middle."""
    for frame, expected in (("mean", mean), ("point", point)):
        equations = derive.derive(parse(Rod(pieces, frame)(text_of("crank_slider_3")), str(SCENE))).expanded()
        assert sum(entry != 0 for entry in equations.mass) == expected


@pytest.mark.parametrize(
    ("pieces", "frame", "highest", "most", "least", "rms", "worst"),
    [
        pytest.param(1, "point", 3, 0.0142163, -0.0141417, 20.6, 53, marks=pytest.mark.long),
        pytest.param(3, "point", 3, 0.0156091, -0.0157287, 0.9, 2.8, marks=pytest.mark.long),
        (1, "mean", 7, 0.0187900, -0.0186983, 12.5, 27),
    ],
)
def test_deflections(
    pieces: int, frame: str, highest: int, most: float, least: float, rms: float, worst: float
) -> None:
    """An independent prototype has the same digits. More shapes in one frame do not come to the reference; beams do."""
    made = of("crank_slider_3", Rod(pieces, frame, highest))
    found = made.run(np.linspace(0, 0.1, 1001))
    bent = made.bent(found, "deflection")
    assert (bent.max(), bent.min()) == (pytest.approx(most, abs=2e-7), pytest.approx(least, abs=2e-7))
    (plot,) = made.spec.plots
    assert plot.reference is not None
    angle, reference = np.array(plot.reference.rows).T
    error = 100 * np.abs(bent - np.interp(150 * found.t, angle, reference)) / np.abs(reference).max()
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, abs=0.06)
    assert error.max() == pytest.approx(worst, rel=0.03)
