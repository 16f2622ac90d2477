"""`tisserand study`: what the frame of the beams of a scene costs, and what it does to pivots."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from derive.artifacts import File, write
from derive.cli.simulate import scene_of
from derive.errors import Problem, SpecError
from derive.spec.model.scene import Scene
from derive.spec.toml.read import with_lines
from derive.study import frames, frames_table, pivots, pivots_table, states
from derive.study import frames_chart as chart
from derive.study.variants import rods, variant
from derive.terminal import show


def run(options: argparse.Namespace) -> int:
    """Run the study that was asked for."""
    scene = _scene(options.spec)
    try:
        return _frames(scene, options) if options.study == "frames" else _pivots(scene, options)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    finally:
        show()


def _scene(path: Path) -> Scene:
    """The scene of a file. SpecError if there is no beam in it, or nothing to simulate."""
    scene = scene_of(path, None)
    if not rods(scene):
        said = "there is no beam among them, and without one there is no frame to study; see scenes/crank_slider_3.toml"
        raise SpecError((Problem("bodies", said),), str(path))
    return scene


def _frames(scene: Scene, options: argparse.Namespace) -> int:
    names = options.frames
    rows = frames.study(scene, options.pieces, names, options.runs)
    show()
    target = options.chart or Path("results") / scene.name / "frames.svg"
    write([File(target.name, chart.svg(scene.name, names, rows))], target.parent)
    if options.json:
        print(json.dumps({**frames_table.plain(scene.name, names, rows), "files": [str(target)]}, indent=2))
    else:
        print(f"{frames_table.text(scene.name, names, rows)}\n\nwrote {target}")
    return 0


def _pivots(scene: Scene, options: argparse.Namespace) -> int:
    along = states.period(scene)[1]
    every = options.pieces or sorted({rod.pieces for rod in rods(scene)})
    found = []
    for n in every:
        first, second = (
            pivots.look(variant(scene, n, name), options.states, options.numberings) for name in options.frames
        )
        found.append((n, (first, second)))
    show()
    if options.json:
        print(json.dumps([pivots_table.plain(scene.name, n, both) for n, both in found], indent=2))
    else:
        blocks = [pivots_table.text(scene.name, n, along, both) for n, both in found]
        print("\n\n".join([*blocks, pivots_table.legend()]))
    return 0
