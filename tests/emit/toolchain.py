"""Compilers and the tools that look at what they make; a tool that is missing is an error where CI is set."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import beams
import derive

HERE = Path(__file__).parent
SCENES = HERE.parent.parent / "scenes"

WARNINGS = ("-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Werror")
C99 = ("-std=c99", *WARNINGS)
CPP11 = ("-x", "c++", "-std=c++11", *WARNINGS)


def tool(name: str) -> str:
    """The path of a tool; without it the test is skipped, and fails in CI, where nothing may go unnoticed."""
    if path := shutil.which(name):
        return path
    if os.environ.get("CI"):
        pytest.fail(f"{name} is missing", pytrace=False)
    pytest.skip(f"{name} is missing")


def run(*command: str | Path, cwd: Path | None = None) -> str:
    """The standard output of a command that has to succeed."""
    done = subprocess.run([str(c) for c in command], cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}"
    return done.stdout


def run_together(commands: Sequence[Sequence[str | Path]]) -> None:
    """Run commands that have to succeed, all at the same time."""
    started = [
        subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for command in commands
    ]
    said = [process.communicate()[0] for process in started]
    for command, process, text in zip(commands, started, said, strict=True):
        assert process.returncode == 0, f"{' '.join(map(str, command))}\n{text}"


def written(files: Sequence[derive.File], folder: Path) -> list[Path]:
    """The C files among generated files, written below a folder."""
    derive.write(files, folder)
    return [folder / file.path for file in files if file.path.endswith(".c")]


def text_of(made: beams.Made, ending: str) -> str:
    """The one generated file whose name ends so."""
    (text,) = (file.text for file in made.files if file.path.endswith(ending))
    return text


@cache
def scene(name: str) -> beams.Made:
    """A model of the folder `scenes`."""
    return beams.build(derive.read(SCENES / f"{name}.toml"))


@cache
def special(name: str) -> beams.Made:
    """One of SPECIAL, built once a session."""
    return beams.build(beams.beam(**SPECIAL[name]))


FOLDED = {"mass": "7/3", "length": 0.7, "bending_stiffness": 2}
SPECIAL: Mapping[str, dict[str, object]] = {
    "folded_mean": {"frame": "mean", **FOLDED},
    "folded_point": {"frame": "point", **FOLDED},
    "half_folded": {"frame": "chord", "length": "1/3"},
    "no_markers": {"frame": "tangent", "markers": {}},
    "folded_no_markers": {"frame": "mean", "n": 1, "markers": {}, **FOLDED},
    "many_markers": {"frame": "point", "markers": {f"at_{k}": f"{k}/4" for k in range(5)} | {"tip": 1}},
    # Symbols and markers that the code uses for other things.
    "unlucky_names": {
        "frame": "point",
        "mass": {"symbol": "c8_1_1"},
        "length": {"symbol": "t"},
        "bending_stiffness": {"symbol": "phi"},
        "markers": {"mass": -1, "k": 1, "t1": "1/2"},
    },
}
SHAPES = {"mean": (1, 2, 5, 8), "point": (1, 2, 8), "point_off_centre": (2, 5), "chord": (2,), "tangent": (2, 5)}

BODIES: Mapping[str, dict[str, object]] = {
    "rigid_loops": {"modes": 0, "frame": "given", "lowering": "loops"},
    "given_1_loops": {"modes": 1, "frame": "given", "damping": True, "lowering": "loops"},
    "given_3_loops": {"modes": 3, "frame": "given", "damping": True, "lowering": "loops", "gravity": [0, 1, "1/3"]},
    "given_13_loops": {"modes": 13, "frame": "given", "lowering": "loops"},
    "mean_3_loops": {
        "modes": 3,
        "damping": True,
        "lowering": "loops",
        "gravity": [0, 0, {"symbol": "g3", "default": -9.81}],
    },
    "mean_20_loops": {"modes": 20, "lowering": "loops"},
    "given_2_flat": {"modes": 2, "frame": "given", "damping": True, "lowering": "flat", "gravity": [0, 1, "1/3"]},
    "mean_2_flat": {"modes": 2, "lowering": "flat"},
}
"""Bodies in space whose integrals are parameters."""


@cache
def body(name: str) -> beams.Made:
    """One of BODIES, built once a session."""
    return beams.build(derive.symbolic_body(name, **BODIES[name]))


@cache
def block(lowering: str) -> beams.Made:
    """The block of the scenes with 3 of its modes, and its markers."""
    spec = replace(derive.read(SCENES / "block.toml"), lowering=lowering, modes=3, name=f"block_{lowering}")
    return beams.build(spec)


MODELS: dict[str, Callable[[], beams.Made]] = {
    **{f"{frame}_{n}": lambda frame=frame, n=n: beams.made(frame, n) for frame, of in SHAPES.items() for n in of},
    **{name: lambda name=name: special(name) for name in SPECIAL},
    **{name: lambda name=name: body(name) for name in BODIES},
    "crank_slider_3": lambda: scene("crank_slider_3"),
    **{f"block_{lowering}": lambda lowering=lowering: block(lowering) for lowering in ("flat", "loops")},
}
"""The models that the tests of this folder go through: every frame with few and many shapes, and special ones."""

OTHERS = (
    *("mean_1", "mean_5", "mean_8", "point_1", "point_8", "point_off_centre_2", "point_off_centre_5", "chord_2"),
    *("tangent_5", "folded_mean", "no_markers", "many_markers", "given_3_loops", "mean_20_loops", "mean_2_flat"),
)
"""Models whose code consists of what that of the other ones consists of, for tests with the mark `long`.

They have other numbers of shapes or of markers, or the integrals of another frame.
"""

EVERY_MODEL = [pytest.param(name, marks=pytest.mark.long if name in OTHERS else ()) for name in MODELS]
