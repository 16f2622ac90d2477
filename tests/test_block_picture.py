"""The picture of the tumbling block shows what the compiled code does now."""

from __future__ import annotations

import re
import runpy

import numpy as np

from conftest import ROOT
from free_block import Array, march, native, rubber, start


def curves(svg: str, name: str) -> list[Array]:
    """Points of the curves of a name, one for each panel, in pixels; they are written as steps."""
    found = re.findall(rf'<path class="{name}" d="M([\d.]+ [\d.]+)l([^"]+)"', svg)
    steps = [np.array(f"{first} {rest}".split(), dtype=float) for first, rest in found]
    return [np.cumsum(each.reshape(-1, 2), axis=0) for each in steps]


def test_the_picture_is_what_the_script_draws() -> None:
    """The first 5 of 24 seconds, to a quarter of a pixel, by loops where the script has written out code."""
    script = runpy.run_path(str(ROOT / "docs/tumbling.py"))
    svg = (ROOT / "docs/tumbling.svg").read_text(encoding="utf-8")
    assert len(svg) < 60_000 and all(title in svg for title in script["bodies"]())
    assert all(line in svg for line in script["legend"]())
    rigid = native(modes=0)
    models = [(rigid, rigid.setup()), rubber(4e-6, relaxation=0.06)]
    for panel, (block, k) in enumerate(models):
        _, vs = march(block, k, *start(block.nv - 6, script["SPIN"]), script["STEP"], 2000, script["EVERY"])
        top = script["TOP"] + panel * (script["HEIGHT"] + script["GAP"])
        for axis, name in enumerate(script["COLOURS"]):
            expected = top + script["HEIGHT"] / 2 * (1 - vs[:, 3 + axis] / script["FULL"])
            drawn = curves(svg, name)[panel]
            assert np.isclose(drawn[-1, 0], script["LEFT"] + script["WIDTH"], atol=0.2)
            assert np.abs(drawn[: len(expected), 1] - expected).max() < 0.25
