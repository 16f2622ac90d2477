"""Two models of one name in one process: each calls its own functions, however their libraries are opened."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import derive
from derive.artifacts import File
from derive.export.casadi.loading import casadi_function
from derive.export.host_model import host_model
from derive.generated_models import generated
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import compile_shared
from derive.runtime.loading import load
from derive.spec.toml.read import parse

ARM = """
name = "namesake"
ground.markers = {{ o = [0, 0] }}
[scene]
gravity = [0, -9.81]
[bodies.arm]
mass = {}
inertia = 0.1
centre = [0.5, 0]
markers = {{ pin = [0, 0] }}
[joints.hinge]
kind = "revolute"
between = ["ground.o", "arm.pin"]
"""
MASSES = (1, 3)


def files(mass: int) -> Sequence[File]:
    scene = parse(ARM.format(mass))
    return generated(scene)[1]


def exact(mass: int) -> float:
    """The acceleration of the arm at rest, rad/s^2."""
    return -mass * 0.5 * 9.81 / (0.1 + mass * 0.25)


def acceleration(native: Native) -> float:
    zero = np.zeros(1)
    k = native.setup()
    mass, force = native.mass_force(0.0, zero, zero, k)
    accelerations = native.accel(0.0, zero, zero, k)
    assert accelerations[0] == pytest.approx(-force[0] / mass[0], rel=1e-12)
    return float(accelerations[0])


def test_libraries_of_this_package() -> None:
    natives = [load(files(mass), ("-O0",)) for mass in MASSES]
    assert [acceleration(native) for native in natives] == pytest.approx(list(map(exact, MASSES)), rel=1e-12)


def test_a_library_that_the_process_has_opened_for_all_to_see(tmp_path: Path) -> None:
    """Octave and other hosts open libraries so: the functions of a later one must not become those of the first."""
    first, second = map(files, MASSES)
    derive.write(first, tmp_path)
    source = next(tmp_path / file.path for file in first if file.path.endswith(".c"))
    library = compile_shared([source], tmp_path / "seen.so", ("-O0",))
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    assert acceleration(load(second, ("-O0",))) == pytest.approx(exact(3), rel=1e-12)
    assert acceleration(load(first, ("-O0",))) == pytest.approx(exact(1), rel=1e-12)


def test_functions_of_casadi() -> None:
    functions = [casadi_function(host_model(parse(ARM.format(mass)), sensitivities=True)) for mass in MASSES]
    for function, mass in zip(functions, MASSES, strict=True):
        nothing = [ca.DM.zeros(*function.sparsity_in(i).shape) for i in (2, 3)]
        xdot, _ = function.call([0.0, ca.DM.zeros(2), *nothing])
        assert float(xdot[1]) == pytest.approx(exact(mass), rel=1e-12)
