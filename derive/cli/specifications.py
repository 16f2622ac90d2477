"""Specification files of the commands: models built from several of them, and a scene that can be simulated."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from derive.errors import Problem, SpecError
from derive.pipeline import Built, build
from derive.simulation.simulate import simulation_settings
from derive.spec.model.scene import Scene
from derive.spec.tables.simulation import MAX_STEPS
from derive.spec.toml.read import read
from derive.terminal import show_progress


def read_scene(path: Path, duration: float | None = None) -> Scene:
    """Read the scene of a file, with another `duration` (s) if given. Raises SpecError if it cannot be simulated."""
    scene = read(path)
    if not isinstance(scene, Scene):
        message = "a scene is needed, and this is a single body; put it into [bodies], see scenes/spinning_beam.toml"
        raise SpecError((Problem("", message),), str(path))
    try:
        simulation = simulation_settings(scene, duration)
    except SpecError as error:
        raise SpecError(error.problems, str(path)) from None
    if simulation.duration > MAX_STEPS * simulation.output:
        message = f"--duration {duration:g} would give more than {MAX_STEPS} rows; make `output` longer"
        raise SpecError((Problem("simulation.output", message),), str(path))
    return replace(scene, simulation=simulation)


def build_all(paths: Sequence[Path]) -> list[Built]:
    """Build every specification.

    Raises SpecError with the problems of all files, also when two models would have the same name in C.
    """
    built: list[Built] = []
    errors: list[SpecError] = []
    paths_by_name: dict[str, Path] = {}
    for path in dict.fromkeys(paths):
        try:
            result = build(path, partial(_show_stage, path))
        except SpecError as error:
            errors.append(error)
            continue
        if conflict := _name_conflict(result.model.name, paths_by_name):
            errors.append(SpecError((Problem("name", conflict),), str(path)))
        paths_by_name[result.model.name] = path
        built.append(result)
    show_progress()
    if errors:
        raise errors[0] if len(errors) == 1 else SeveralSpecErrors(errors)
    return built


def _show_stage(path: Path, stage: str) -> None:
    show_progress(f"{path}: {stage} ...")


def _name_conflict(name: str, paths_by_name: dict[str, Path]) -> str:
    """The reason why a model cannot have this name beside the other models; empty if it can."""
    for other, path in paths_by_name.items():
        if name.lower() == other.lower():
            return f"the name {name!r} is taken by {path}; choose a name that differs in more than case"
        short, long = sorted((name.lower(), other.lower()), key=len)
        if re.match(rf"{short}_(marker|pattern|table|colptr|rowidx|sparsity|p|k|nnz)(_|$)", long):
            return f"the names {name!r} and {other!r} of {path} make the same names in C; choose another name"
    return ""


class SeveralSpecErrors(SpecError):
    """The errors of several specifications."""

    def __init__(self, errors: list[SpecError]) -> None:
        super().__init__(tuple(p for e in errors for p in e.problems), None)
        self.errors = errors

    def __str__(self) -> str:
        return "\n".join(map(str, self.errors))
