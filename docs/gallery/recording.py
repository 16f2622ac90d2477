"""Runs one example, in a process of its own, and keeps all that it shows: text, number, pictures and motion."""

from __future__ import annotations

import importlib.util
import inspect
import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import derive
from docs.gallery.entries import ROOT, Entry
from docs.gallery.numbers import number_texts

RESULT, OUTPUT, MESSAGES = "result.json", "output.txt", "messages.txt"
MOTION, DRAWING = "motion.html", "drawing.svg"
"""The names of the files of a run; pictures and reports have their own."""


def record(entry: Entry, folder: Path) -> None:
    """Run an example and write its files into an empty folder, with what is in them in `RESULT`.

    What the process prints goes to `OUTPUT` and `MESSAGES`. Raises what the example raises.
    """
    before = os.times()
    # The commands are run as the pages print them: from a folder that looks like a checkout.
    work = folder / "work"
    work.mkdir()
    for name in ("examples", "scenes", "generated", "templates"):
        (work / name).symlink_to(ROOT / name)
    os.chdir(work)
    with _printing_to(folder / OUTPUT, 1), _printing_to(folder / MESSAGES, 2):
        run = {"py": _script, "toml": _scene, "c": _program}[entry.kind]
        result = run(entry, folder)
    os.chdir(folder)
    shutil.rmtree(work)
    times = zip(os.times()[:4], before[:4], strict=True)
    result["seconds"] = round(sum(now - earlier for now, earlier in times), 2)
    (folder / RESULT).write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


@contextmanager
def _printing_to(path: Path, stream: int) -> Iterator[None]:
    """Write what this process and its children print to a stream, 1 or 2, to a file."""
    redirect = {1: redirect_stdout, 2: redirect_stderr}[stream]
    kept = os.dup(stream)
    with path.open("w", buffering=1, encoding="utf-8") as file, redirect(file):
        os.dup2(file.fileno(), stream)
        try:
            yield
        finally:
            os.dup2(kept, stream)
            os.close(kept)


def _script(entry: Entry, folder: Path) -> dict[str, Any]:
    """Call `main` of a script in the style of all pictures; keep the last motion that it simulates."""
    from docs.gallery.pictures import house_style, in_page_style

    motions: list[derive.Trajectory] = []

    def recorded(*arguments: Any, **options: Any) -> derive.Trajectory:
        from derive.simulation.simulate import simulate

        motions.append(simulate(*arguments, **options))
        return motions[-1]

    derive.simulate = recorded
    spec = importlib.util.spec_from_file_location(entry.name, ROOT / entry.path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.dont_write_bytecode = True  # bytecode is that of a second and a length, which two versions may share
    with house_style():
        spec.loader.exec_module(module)
        value = module.main(".") if inspect.signature(module.main).parameters else module.main()
    pictures = []
    for path in sorted(Path().glob("*.svg")):
        (folder / path.name).write_text(in_page_style(path.read_text(), module.__doc__.splitlines()[0]))
        pictures.append(path.name)
    return {"numbers": number_texts(value), "pictures": pictures, **_moving(motions[-1:], folder)}


def _scene(entry: Entry, folder: Path) -> dict[str, Any]:
    """Run the commands of a scene; keep its pictures, its player and its report with the shapes of its beams."""
    from derive.cli.main import main

    with _recorded_runs() as motions:
        for command in entry.commands:
            words = entry.words(command)
            print(f"$ tisserand {' '.join(words)}", flush=True)
            if code := main(list(words)):
                raise RuntimeError(f"tisserand {' '.join(words)} ends with exit code {code}")
    pictures = []
    report = None
    for path in sorted(Path("results").rglob("*.*")):
        if path.suffix == ".svg":
            shutil.copy(path, folder)
            pictures.append(path.name)
        elif path.name.endswith(".report.html"):
            report = shutil.copy(path, folder / "report.html").name
    moving = _moving(motions[:1], folder)
    if moving["motion"]:  # the page of the command has the curves of all plots
        shutil.copy(f"results/{entry.name}/{entry.name}.html", folder / MOTION)
    shapes = _shapes(entry, folder) if report else []
    return {"numbers": [], "pictures": pictures, **moving, "report": report, "shapes": shapes}


def _shapes(entry: Entry, folder: Path) -> list[dict[str, str]]:
    """Write the pictures of the shape functions of beams; their names and captions."""
    from derive.cli.specifications import read_scene
    from derive.report.document.page import Picture
    from derive.report.sections.beam_shapes import beam_shapes_of_scene

    drawn = [block for block in beam_shapes_of_scene(read_scene(ROOT / entry.path)) if isinstance(block, Picture)]
    names = [f"shapes_{k}.svg" for k in range(1, len(drawn) + 1)]
    for name, picture in zip(names, drawn, strict=True):
        (folder / name).write_text(picture.svg)
    return [{"name": name, "alt": picture.alt} for name, picture in zip(names, drawn, strict=True)]


@contextmanager
def _recorded_runs() -> Iterator[list[derive.Trajectory]]:
    """The motions that commands simulate in this context, in their order."""
    from derive.simulation.prepared_run import PreparedRun

    motions: list[derive.Trajectory] = []
    own = PreparedRun.trajectory

    def recorded(*arguments: Any, **options: Any) -> derive.Trajectory:
        motions.append(own(*arguments, **options))
        return motions[-1]

    PreparedRun.trajectory = recorded  # type: ignore[method-assign]
    try:
        yield motions
    finally:
        PreparedRun.trajectory = own  # type: ignore[method-assign]


def _program(entry: Entry, _: Path) -> dict[str, Any]:
    """Compile a C program with its model, and run it."""
    for command in entry.compilation():
        subprocess.run(shlex.split(" ".join(command)), check=True)
    return {"numbers": [], "pictures": [], "motion": None, "drawing": None}


def _moving(motions: list[derive.Trajectory], folder: Path) -> dict[str, Any]:
    """Write the player and the drawing of a motion, if there is one."""
    if not motions:
        return {"motion": None, "drawing": None}
    from docs.gallery.motion import drawing, player

    (folder / MOTION).write_text(player(motions[0]))
    (folder / DRAWING).write_text(drawing(motions[0]))
    return {"motion": MOTION, "drawing": DRAWING}
