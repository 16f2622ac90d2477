"""Loops over the states of a batch become vectors, also where several pivots decide on the code of a state."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import derive
from derive.backends.c.source import CBackend
from derive.runtime.compiler import compiler
from derive.spec.toml.read import parse

BODY = """
[bodies.{0}]
mass = 1
centre = [0.1, 0.2, 0.3]
inertia = [1, 1, 1, 0.1, 0, 0]
markers = {{ near = [0, 0, 1], far = {{ at = [0.5, 0, 0], rotation = {{ axis = [1, 1, 0], angle = 1 }} }} }}
[joints.{0}_turns]
kind = "revolute"
between = ["{1}", "{0}.near"]
"""
ARM = 'name = "arm"\nscene.coordinates = "relative"\nground.markers.base = [0, 0, 0]\n' + "".join(
    BODY.format(*names) for names in (("a", "ground.base"), ("b", "a.far"), ("c", "b.far"))
)


def test_accelerations_of_a_batch_are_vectors(tmp_path: Path) -> None:
    """gcc makes no vectors of a loop where it computes behind a branch what a later choice drops."""
    version = subprocess.run([*compiler(), "--version"], capture_output=True, text=True, check=True).stdout
    if "Free Software" not in version:
        pytest.skip("only gcc says which loops are vectors")
    for file in CBackend().files(derive.lower(derive.derive(parse(ARM)), explicit=True), "a test"):
        (tmp_path / Path(file.path).name).write_text(file.text)
    flags = ["-O3", "-fno-tree-slp-vectorize", "-w", "-fopt-info-vec-optimized", "-c", "arm.c", "-o", "arm.o"]
    done = subprocess.run([*compiler(), *flags], capture_output=True, text=True, check=True, cwd=tmp_path)
    vectors = {int(line.split(":")[1]) for line in done.stderr.splitlines() if "loop vectorized" in line}
    lines = (tmp_path / "arm.c").read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("static int arm_accel_states("))
    loop = next(i for i, line in enumerate(lines) if i > start and "TISSERAND_STATES for" in line)
    assert loop + 1 in vectors
