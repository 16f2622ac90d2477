"""Chains of any number of flexible beams, as in examples/chain_100.toml."""

from __future__ import annotations

import tomllib
from pathlib import Path

import derive
from derive.spec.checks.validation import validate

EXAMPLE = Path(__file__).parents[1] / "examples" / "chain_100.toml"


def chain(
    count: int,
    name: str = "chain",
    kind: str = "weld",
    duration: float = 1.0,
    output: float = 0.01,
    free: bool = False,
    closed: bool = False,
) -> derive.Scene:
    """The scene of `EXAMPLE` with another number of beams, another name, and other joints between beams.

    duration, output: the time and the interval between rows, s. free: without the hinge on the ground and without
    gravity; the transverse velocities of the beams grow with the square of the distance from one end. closed: without
    both as well, and with the last beam welded to the first one; the beams have no initial state.
    """
    data = tomllib.loads(EXAMPLE.read_text())
    data["name"] = name
    data["simulation"] = {"duration": duration, "output": output}
    data["bodies"]["link"]["count"] = count
    data["joints"]["weld"] |= {"count": count - 1, "kind": kind}
    if count == 1:
        del data["joints"]["weld"]
    if free or closed:
        del data["joints"]["hinge"], data["ground"]
        data["scene"]["gravity"] = [0, 0]
    if closed:
        del data["bodies"]["link"]["start"]
        data["joints"]["closing"] = {"kind": kind, "between": [f"link[{count - 1}].right", "link[0].left"]}
    if free:
        data["bodies"]["link"]["start"]["velocity"] = [0.3, "0.02*(0.05 + 0.1*i)^2"]
    scene = validate(data)
    assert isinstance(scene, derive.Scene)
    return scene
