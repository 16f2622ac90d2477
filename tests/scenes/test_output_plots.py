"""The plots of outputs, which a scene shows unless its own plots show them."""

from __future__ import annotations

import pytest
from test_outputs import DRIVEN

import derive
from derive.simulation.observables.default_plots import default_plots
from derive.spec.toml.read import parse


def shown(text: str) -> dict[str, tuple[str, ...]]:
    """The columns of the default plots of a scene."""
    scene = parse(text)
    return {plot.name: plot.quantity.y for plot in default_plots(scene, derive.lower(derive.derive(scene)))}


def test_outputs_that_no_plot_shows_have_plots_of_their_own():
    assert shown(DRIVEN + '[plots.all]\ny = ["tip_1", "rod_phi"]\n') == {"torque": ("torque",)}


@pytest.mark.parametrize(
    ("plot", "expected"),
    [
        ('bow]\ndeflection = "rod.right"\nchord = ["ground.o", "rod.left"]\ndivided_by = 0.6', {}),
        ('bend]\ndeflection = "rod.right"\nchord = ["ground.o", "rod.left"]', {"bend_output": ("bend",)}),
        ('bend]\ny = ["rod_phi"]', {"bend_output": ("bend",)}),
    ],
    ids=["the same deflection", "its name, another deflection", "its name, a column"],
)
def test_an_output_is_plotted_unless_a_plot_shows_it_whatever_their_names(plot, expected):
    outputs = '[outputs.bend]\nkind = "deflection"\nmarker = "rod.right"\nchord = ["ground.o", "rod.left"]\n'
    text = DRIVEN.split("[outputs.tip]", maxsplit=1)[0] + f"{outputs}divided_by = 0.6\n[plots.{plot}\n"
    assert shown(text) == expected


def test_a_scene_without_outputs_and_plots_shows_its_coordinates():
    assert shown(DRIVEN.split("[outputs.tip]", maxsplit=1)[0]) == {
        "angles": ("rod_phi",),
        "positions": ("rod_c1", "rod_c2"),
        "deformations": ("rod_alpha1", "rod_alpha2"),
    }
