"""A second `tisserand simulate` of a scene loads no library that only the first one needs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from derive.cli.main import main

SCENE = """
name = "swing"
[scene]
gravity = [0, -9.81]
[ground.markers]
hook = [0, 0]
[bodies.rod]
mass = 1
length = 1
bending_stiffness = 2
frame = "mean"
ansatz = ["1", "xi", "xi^2"]
markers = { left = -1, middle = 0, right = 1 }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "rod.left"]
[simulation]
duration = 0.02
output = 0.002
[plots.bending]
deflection = "rod.middle"
chord = ["rod.left", "rod.right"]
divided_by = 1
reference = { file = "known.csv", x = "t", y = "w" }
"""
LOADED = """
import sys
from derive.cli.main import main
code = main(sys.argv[1:])
print(*sys.modules if not code else [], file=sys.stderr)
sys.exit(code)
"""
UNUSED = ("casadi", "scipy.interpolate", "scipy.optimize", "scipy.integrate")


LOOPS = ("derive.lowering.instances.lower", "derive.lowering.loops.body_functions")
"""The lowerings that straight-line code does without."""


def loaded(*arguments: str) -> list[str]:
    """The modules that a command loads."""
    done = subprocess.run([sys.executable, "-c", LOADED, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:1000]
    return done.stderr.split()


def test_a_kept_model_is_simulated_without_the_libraries_that_derive(tmp_path: Path) -> None:
    (tmp_path / "swing.toml").write_text(SCENE)
    (tmp_path / "known.csv").write_text("t,w\n0,0\n0.01,0.001\n0.02,0.002\n")
    arguments = ("simulate", str(tmp_path / "swing.toml"), "--out", str(tmp_path / "out"))
    assert "casadi" in loaded(*arguments)  # to derive the model, which is then kept
    assert not set(UNUSED) & set(loaded(*arguments))
    assert "deviation" in (tmp_path / "out/swing/bending.svg").read_text()


def test_a_beam_is_built_without_scipy_and_what_reduces_finite_elements(tmp_path: Path) -> None:
    (tmp_path / "beam.toml").write_text('name = "b"\n[beam]\nframe = "mean"\nansatz = ["1", "xi", "xi^2"]\n')
    modules = loaded("build", str(tmp_path / "beam.toml"), "--out", str(tmp_path))
    assert "casadi" in modules and not {"derive.reduction", "scipy", *LOOPS} & set(modules)


@pytest.mark.parametrize("given", [None, "2"])
def test_small_matrices_need_no_threads(given: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless the user asks for them."""
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", given or "")
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    assert main(["schema"]) == 0
    assert os.environ["OPENBLAS_NUM_THREADS"] == (given or "1")
