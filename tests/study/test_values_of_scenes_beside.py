"""`study accuracy --also`: the scenes beside the studied one get the values of `--set` that they have."""

from __future__ import annotations

from conftest import ROOT
from derive.cli.specifications import read_beside, read_changed_scene

EXAMPLES = ROOT / "examples"
BEAM, ELEMENTS = EXAMPLES / "spatial_crank_slider_beam.toml", EXAMPLES / "spatial_crank_slider.toml"


def test_scenes_beside_have_the_values_that_they_know_and_say_which_they_do_not() -> None:
    values = [
        ("bodies.slider.mass", "3"),
        ("bodies.rod.bending_stiffness", "40"),
        ("simulation.duration", "0.1"),
    ]
    scene, changes = read_changed_scene(BEAM, values)
    other, texts = read_beside(ELEMENTS, values, scene)
    masses = [{b.name: b for b in of.bodies}["slider"].mass for of in (scene, other)]
    assert masses[0] == masses[1] and masses[0].default == 3 and len(changes) == 3
    assert other.simulation == scene.simulation and other.simulation.duration == 0.1
    assert texts == (
        f"in {ELEMENTS}: bodies.slider.mass: 2 -> 3, the parameter slider_mass",
        f"in {ELEMENTS}: bodies.rod.bending_stiffness: it has no such parameter or key, and stays as it is",
    )
