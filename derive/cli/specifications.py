"""Specification files of the commands: models built from several of them, and a scene that can be simulated."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from derive.errors import Problem, SpecError
from derive.progress_line import show_progress
from derive.remaining_time import RemainingTime
from derive.spec.model.body import NodalBody
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene, Specification
from derive.spec.set_values import SetValue, has_value, with_values
from derive.spec.toml.key_lines import lines
from derive.spec.toml.read import read, read_with_counts

if TYPE_CHECKING:
    from derive.pipeline import Built


def read_scene(path: Path) -> AnyScene:
    """Read the scene of a file. Raises SpecError if it is a body, or has no [simulation]."""
    return _scene(read(path), path)


def read_planar_scene(path: Path) -> Scene:
    """Read the planar scene of a file. Raises SpecError if it is another one; see `read_scene`."""
    scene = read(path)
    if isinstance(scene, SpatialScene):
        raise SpecError((Problem("", _in_space(scene, path)),), str(path))
    result = _scene(scene, path)
    assert isinstance(result, Scene)
    return result


def read_changed_scene(path: Path, assignments: Sequence[tuple[str, str]]) -> tuple[AnyScene, tuple[SetValue, ...]]:
    """The scene of a file with other values, and what has been replaced; see `read_changed` and `read_scene`."""
    spec, changes = read_changed(path, assignments)
    return _scene(spec, path), changes


def read_beside(
    path: Path, assignments: Sequence[tuple[str, str]], compared: AnyScene
) -> tuple[AnyScene, tuple[str, ...]]:
    """The scene of a file that is studied beside another one, with the same simulation and the values that it has.

    The texts say what has been replaced in it, and which names it does not have. Raises SpecError.
    """
    spec, counts = read_with_counts(path, dict(assignments))
    given = replace(_scene(spec, path), simulation=compared.simulation)
    others = {name: text for name, text in assignments if name not in counts}
    known = {name: text for name, text in others.items() if has_value(given, name, text)}
    scene, changes = with_values(given, known) if known else (given, ())
    replaced = (*(SetValue(name, str(counts[name]), text) for name, text in assignments if name in counts), *changes)
    texts = [str(change) for change in replaced if change.old != change.new]
    texts += [f"{name}: it has no such parameter or key, and stays as it is" for name in others if name not in known]
    return scene, tuple(f"in {path}: {text}" for text in texts)


def _scene(spec: Specification, path: Path) -> AnyScene:
    if not isinstance(spec, AnyScene):
        raise SpecError((Problem("", "a scene is needed, and this is a single body"),), str(path))
    from derive.simulation.simulate import with_simulation  # commands that simulate nothing do not need it, and SciPy

    with _file(path):
        return with_simulation(spec)


def _in_space(spec: SpatialScene, path: Path) -> str:
    """The message that a scene in space has no planar models to compare, with the commands that compare its runs."""
    from derive.simulation.observables.default_plots import output_columns

    flexible = [body.name for body in spec.bodies if isinstance(body, FlexibleBody)]
    column = "final:COLUMN" if not spec.outputs else f"final:{output_columns(spec.outputs[0], True)[0]}"
    commands = [f"tisserand simulate {path} --integrator rk4", f"tisserand modes {path}"]
    if spec.plots and any(isinstance(body, SpatialBeam) for body in spec.bodies):
        commands.insert(0, f"tisserand study accuracy {path} --own-reference --frames mean,chord,point,tangent")
    if flexible:
        commands.insert(0, f"tisserand sweep {path} --set bodies.{flexible[0]}.modes=1,2,3 --output {column}")
    return (
        "a planar scene is needed, and this is a scene in space: models of planar beams are what this command compares"
        f". What compares runs in space: {'; '.join(commands)}"
    )


def read_changed(path: Path, assignments: Sequence[tuple[str, str]]) -> tuple[Specification, tuple[SetValue, ...]]:
    """Read the specification of a file with other values, and what has been replaced; see `with_values`.

    assignments: pairs of a name and a value. Raises SpecError.
    """
    names = [name for name, _ in assignments]
    if repeated := sorted({name for name in names if names.count(name) > 1}):
        raise SpecError((Problem("", f"{', '.join(repeated)} has several values; give one"),), "--set")
    spec, counts = read_with_counts(path, dict(assignments))
    changes = tuple(SetValue(name, str(counts[name]), text) for name, text in assignments if name in counts)
    others = {name: text for name, text in assignments if name not in counts}
    changed, more = with_values(spec, others) if others else (spec, ())
    return changed, (*changes, *more)


def in_file_order(plots: Sequence[Plot], path: Path) -> tuple[Plot, ...]:
    """Plots in the order of a file, whether it has a table of the plot, or of the output that the plot shows."""
    known = lines(path.read_text(encoding="utf-8-sig"))

    def line(plot: Plot) -> float:
        return min(
            (known[table, plot.name] for table in ("plots", "outputs") if (table, plot.name) in known), default=math.inf
        )

    return tuple(sorted(plots, key=line))


def simulation_of(
    spec: Specification,
    path: Path,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    until: str | None = None,
) -> AnyScene | NodalBody:
    """The scene or body of a file with the given duration (s), interval of rows (s), tolerance and end condition.

    What is not given stays as it is. Raises SpecError if the specification cannot be simulated.
    """
    from derive.simulation.simulate import with_simulation
    from derive.simulation.simulated_scene import simulated

    with _file(path):
        return with_simulation(simulated(spec), duration, output, tolerance, until)


@contextmanager
def _file(path: Path) -> Iterator[None]:
    """Give the errors of a specification the file as their source."""
    try:
        yield
    except SpecError as error:
        raise SpecError(error.problems, str(path)) from None


def build_all(paths: Sequence[Path], sensitivities: bool = False, functions: Sequence[str] = ()) -> list[Built]:
    """Build every specification, with derivatives by the parameters if `sensitivities`, and with these `functions`.

    Raises SpecError with the problems of all files, also when two models would have the same name in C.
    """
    from derive.pipeline import build  # most commands do not need it

    built: list[Built] = []
    errors: list[SpecError] = []
    paths_by_name: dict[str, Path] = {}
    every = dict.fromkeys(paths)
    remaining = RemainingTime(len(every))
    for path in every:
        label = remaining.named(str(path))
        try:
            result = build(path, partial(_show_stage, label), sensitivities, functions)
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


def _show_stage(label: str, stage: str) -> None:
    show_progress(f"{label}: {stage} ...")


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
