"""A second `tisserand simulate` of a scene loads no library that only the first one needs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT
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
[bodies.block]
mass = 1
inertia = 1
markers = { centre = [0, 0] }
[joints.slide]
kind = "translational"
between = ["ground.hook", "block.centre"]
axis = [1, 2]
start = { displacement = 0.1, speed = 1 }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "rod.left"]
[drives.motor]
joint = "hinge"
speed = "sin(5*t)*t"
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
UNUSED = ("sympy", "casadi", "scipy.interpolate", "scipy.optimize", "scipy.integrate")


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
    assert main(arguments) == 0  # derives the model, which is then kept
    assert not set(UNUSED) & set(loaded(*arguments))
    assert "deviation" in (tmp_path / "out/swing/bending.svg").read_text()


AT_REST = """
name = "held"
[scene]
gravity = [0, -9.81]
start = "equilibrium"
[ground.markers]
hook = [0, 0]
[bodies.rod]
length = 1
mass = 1
bending_stiffness = 20
frame = "mean"
ansatz = ["1", "xi", "xi^2"]
markers = { left = -1 }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "rod.left"]
[drives.motor]
joint = "hinge"
motion = "0.5 + t^3*sin(3*t)"
[simulation]
duration = 0.02
output = 0.002
"""


def assert_kept(folder: Path, specification: Path, *options: str) -> None:
    """A second run of a specification loads neither SymPy nor CasADi."""
    arguments = ("simulate", str(specification), "--out", str(folder / "out"), *options)
    assert main(arguments) == 0
    assert not {"sympy", "casadi"} & set(loaded(*arguments))


@pytest.mark.long
def test_equilibria_with_drives_at_rest_are_found_without_them(tmp_path: Path) -> None:
    (tmp_path / "held.toml").write_text(AT_REST)
    assert_kept(tmp_path, tmp_path / "held.toml")


SIMULATED = [
    path.relative_to(ROOT)
    for folder in ("scenes", "examples")
    for path in sorted((ROOT / folder).glob("*.toml"))
    if "[simulation]" in path.read_text() and path.name != "chain_1000.toml"  # that of 100 beams takes a tenth of it
]


@pytest.mark.long
@pytest.mark.parametrize("specification", SIMULATED, ids=str)
def test_no_second_run_of_a_scene_or_an_example_loads_them(specification: Path, tmp_path: Path) -> None:
    assert_kept(tmp_path, ROOT / specification, "--duration", "0.002", "--output", "0.001")


SPATIAL = """
name = "top"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
hook = { at = [0, 0, 0] }
[bodies.rotor]
mass = 2
inertia = [0.1, 0.2, 0.3, 0, 0, 0]
markers.tip = { at = [0, 0, -1] }
[joints.ball]
kind = "spherical"
between = ["ground.hook", "rotor.tip"]
[outputs.turn]
kind = "rotation"
marker = "rotor.tip"
[simulation]
duration = 0.02
output = 0.002
"""


@pytest.mark.long
def test_a_kept_model_in_space_is_simulated_without_them(tmp_path: Path) -> None:
    (tmp_path / "top.toml").write_text(SPATIAL)
    arguments = ("simulate", str(tmp_path / "top.toml"), "--out", str(tmp_path / "out"))
    assert "sympy" in loaded(*arguments)
    assert not set(UNUSED) & set(loaded(*arguments))


def test_the_pipeline_is_imported_without_what_it_may_not_need() -> None:
    """It derives and writes when it is called."""
    code = "import sys, derive.pipeline; print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    parts = {".".join(name.split(".")[:2]) for name in modules}
    assert "derive.pipeline" in modules
    assert not {"sympy", "casadi", "scipy", "jinja2", "derive.lowering", "derive.mechanics"} & parts


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
