"""Models in systems of Exudyn: exported, compiled, added and solved."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any

from host_models import EVERYWHERE, PUSHED, SPATIAL, STEERED
from programs import program, run

import derive
from conftest import ROOT
from derive.export.host_model import HostModel, host_model
from derive.export.interface import exported_files
from derive.export.registry import INTERFACES
from derive.spec.model.simulation import SpatialStart
from derive.spec.toml.read import parse

WARNINGS = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
LADEN = (
    PUSHED.replace('"pushed"', '"laden"')
    + """
[bodies.ball]
mass = 0.2
inertia = 1e-9
markers = { pin = [0, 0] }

[joints.pin]
kind = "revolute"
between = ["rod.tip", "ball.pin"]
"""
)
"""A mass at the tip, as a body of the scene."""


def tumbling() -> derive.NodalBody:
    """The block as soft as rubber, so that its spin deforms it, with straight-line code."""
    block = derive.read(ROOT / "scenes/block.toml")
    soft = replace(block.data, stiffness=None, modal_stiffness=1e-4 * block.data.modal_stiffness)
    start = SpatialStart(velocity=(0.5, 0.0, 0.0), angular_velocity=(3.0, 20.0, -5.0), amplitudes=(1e-3,))
    return replace(block, data=soft, lowering="flat", start=start)


MODELS: dict[str, Callable[[], Any]] = {
    "pushed": lambda: parse(PUSHED),
    "steered": lambda: parse(STEERED),
    "double_pendulum": lambda: derive.read(ROOT / "scenes/double_pendulum.toml"),
    "crank_slider_3": lambda: derive.read(ROOT / "scenes/crank_slider_3.toml"),
    "block": tumbling,
    **{name: partial(parse, text) for name, text in EVERYWHERE.items()},
    "kept": lambda: parse(KEPT),
}
"""A force and a prescribed motion as inputs, scenes without ports, a soft body that tumbles in space, scenes there."""
KEPT = SPATIAL.replace('"turning"', '"kept"')
KEPT = KEPT.replace("mass = 0.12", "mass = 0.12\nkeep_coordinates = true")
KEPT = KEPT.replace("mass = 2", "mass = 2\nkeep_coordinates = true")
KEPT = KEPT.replace("[simulation]", '[outputs.at]\nkind = "acceleration"\nmarker = "rod.ball"\n[simulation]')
KEPT = KEPT.replace("[simulation]", '[outputs.hub]\nkind = "reaction"\njoint = "bearing"\n[simulation]')
"""The slider-crank in space with three quaternions, and with an acceleration and the reaction of a joint as outputs."""


@cache
def host_of(name: str) -> HostModel:
    return host_model(MODELS[name]())


@cache
def exported(name: str, folder: Path) -> tuple[ModuleType, Path]:
    """The module of a model and its shared library, compiled without warnings."""
    return compiled(host_of(name), folder)


def compiled(host: HostModel, folder: Path) -> tuple[ModuleType, Path]:
    """The compiled object of any model."""
    name = host.name
    derive.write(exported_files(host, "exudyn", INTERFACES["exudyn"]), folder)
    own, library = folder / f"{name}-exudyn", folder / f"{name}.so"
    run(program("gcc"), *WARNINGS, "-O2", "-shared", "-fPIC", *own.glob("*.c"), "-o", library, "-lm")
    found = importlib.util.spec_from_file_location(f"{name}_exudyn", own / f"{name}_exudyn.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module, library


def solved(exu: ModuleType, mbs: Any, duration: float, steps: int, keep_accelerations: bool = False) -> None:
    """Integrate by the implicit trapezoidal rule of index 2."""
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime, integration.verboseMode = steps, duration, 0
    integration.generalizedAlpha.useNewmark = integration.generalizedAlpha.useIndex2Constraints = True
    integration.generalizedAlpha.computeInitialAccelerations = not keep_accelerations
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = duration
    mbs.SolveDynamic(settings)


def added(exu: ModuleType, name: str, folder: Path, **given: Any) -> tuple[Any, Any]:
    """A system with the model, and its `Body`."""
    module, library = exported(name, folder)
    mbs = exu.SystemContainer().AddSystem()
    return mbs, module.add(mbs, library, **given)
