"""All checks of one scene of the corpus: every command, and the physics of its motion."""

from __future__ import annotations

import json
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from corpus import commands
from corpus.commands import Finding
from corpus.coordinate_forms import forms, has_flexible_trees
from corpus.generator import CorpusScene, corpus_scene
from corpus.physics import physics
from corpus.refusals import refusal
from corpus.spatial_physics import physics_in_space
from corpus.spatial_scenes import FIRST
from derive import TisserandError
from derive.short_text import full_text

COMPILER = '#!/bin/sh\nexec cc "$@" -O0\n'
"""Compiles in a fifth of the time of -O2, and gives the same bits."""


@dataclass(frozen=True)
class SceneResult:
    """The results of the checks of a scene: findings, the legitimate refusals by command, and CPU seconds by command.

    errors: of each model of `study accuracy`, its name, the measured error, that which a monitor implies, None without
    a warning, and the beam of the warning; with the error of the reference, and the marker of the plot.
    """

    seed: int
    linkage: str
    findings: tuple[Finding, ...]
    refusals: dict[str, str]
    seconds: dict[str, float]
    errors: tuple[Any, ...] = ()

    @property
    def data(self) -> dict[str, Any]:
        """The result as plain data."""
        return asdict(self)


def quick_compiler(folder: Path) -> str:
    """A compiler for the environment variable CC that does not optimise, as a script in the folder."""
    script = folder / "cc"
    script.write_text(COMPILER)
    script.chmod(0o755)
    return str(script)


@contextmanager
def derived_once() -> Iterator[None]:
    """Let the commands of a scene share equations and kernels of the same specification: a third of their time."""
    equations, kernels = import_module("derive.derivation").derive, import_module("derive.model_lowering").lower
    derived: dict[str, Any] = {}
    lowered: dict[tuple[int, bool, bool], Any] = {}

    def derive(spec: Any) -> Any:
        key = full_text(spec)
        if key not in derived:
            derived[key] = equations(spec)
        return derived[key]

    def lower(of: Any, sensitivities: bool = False, explicit: bool = False, functions: Any = ()) -> Any:
        key = id(of), sensitivities, explicit, tuple(functions)
        if key not in lowered:
            lowered[key] = (
                of,
                kernels(of, sensitivities, explicit, functions=functions),
            )  # keeps id(of)
        return lowered[key][1]

    with pytest.MonkeyPatch.context() as patch:
        for name, module in list(sys.modules.items()):
            if name.startswith("derive."):
                for function, shared in (("derive", derive), ("lower", lower)):
                    if getattr(module, function, None) in (equations, kernels):
                        patch.setattr(module, function, shared)
        yield


def check_scene(seed: int) -> SceneResult:
    """Run all commands and checks on the scene of a seed."""
    scene = corpus_scene(seed)
    with tempfile.TemporaryDirectory(prefix="corpus-") as name, derived_once():
        folder = Path(name)
        path = scene.write(folder / "scene")
        out = folder / "out"
        out.mkdir()
        found, refusals, seconds = [], {}, {}
        for arguments in commands.arguments_of(scene, path, out):
            outcome = commands.run(arguments, out)
            short = " ".join([word for word in arguments if str(folder) not in word][:3])
            seconds[short] = round(outcome.seconds, 3)
            found += commands.findings(scene, outcome, out)
            if outcome.code == 2 and (pattern := commands.refusal(outcome.error)):
                refusals[short] = pattern
        if seed >= FIRST:
            found += commands.other_motions(seed, out)
        before = commands.cpu()
        found += _checked((physics_in_space if seed >= FIRST else physics)(scene, path))
        seconds["physics"] = round(commands.cpu() - before, 3)
        if has_flexible_trees(scene):
            found += _checked(forms(path))
            seconds["forms"] = round(commands.cpu() - before - seconds["physics"], 3)
        errors = tuple(_errors(scene, out))
    return SceneResult(seed, scene.linkage, tuple(found), refusals, seconds, errors)


def _errors(scene: CorpusScene, out: Path) -> Iterator[Any]:
    """Measured and implied errors of the models of `study accuracy`."""
    for file in out.rglob("accuracy.json"):
        study = json.loads(file.read_text())
        plot = scene.tables.get("plots", {}).get(study["plot"], {}).get("deflection", "")  # or that of a study
        for model in study["models"]:
            if model["runs"]:
                warning = model["warning"] or {}
                implied = warning.get("error"), warning.get("beam"), warning.get("quantity")
                yield model["model"], model["runs"][0]["rms_error"], *implied, study["reference"]["error"], plot


def _checked(check: Iterator[Finding]) -> Iterator[Finding]:
    """The findings of a check, one of which is that it fails."""
    try:
        yield from check
    except TisserandError as failure:
        if refusal(str(failure)) is None:
            yield Finding("physics", f"refused: {commands.general(str(failure))}", str(failure))
    except Exception as failure:
        yield Finding("physics", commands.cause(failure), traceback.format_exc(limit=-6))
