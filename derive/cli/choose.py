"""`tisserand choose`: select, explain and write the cheapest model of a scene that is accurate enough."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable
from pathlib import Path

from derive.artifacts import File, check_folder
from derive.cli.specifications import read_scene
from derive.errors import Problem, SpecError, TisserandError
from derive.remaining_time import ElapsedTime
from derive.simulation.inputs import with_functions
from derive.simulation.observables.beams import beam_bodies
from derive.spec.toml.read import parse, with_lines
from derive.study.accuracy.reference import compared_plot
from derive.study.choice.choice_text import choice_data, choice_text
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.screening import screening
from derive.study.choice.search import Choice, choose
from derive.study.choice.written_specification import WrittenSpecification, chosen_specification
from derive.study.computed_ahead import available_workers
from derive.terminal import show_progress, show_result

EXPECTED_SIZE = 100_000
"""The approximate size that a specification has at most, in bytes."""


class ExistingFile(TisserandError):
    """A file that would be overwritten."""


def run(options: argparse.Namespace) -> int:
    """Search, print the result, and write the specification. The exit code is 1 if no model is accurate enough."""
    scene = read_scene(options.spec)
    target = options.out or options.spec.with_name(f"{options.spec.stem}_chosen.toml")
    if os.path.lexists(target):
        raise ExistingFile(f"{target} exists, and is not overwritten; move it, or give another file with --out")
    check_folder([File(target.name, "")], target.parent, EXPECTED_SIZE)
    runs = None
    try:
        if not beam_bodies(scene):
            raise SpecError((Problem("bodies", "there is no beam here, and nothing to choose"),))
        plots = [compared_plot(scene, name) for name in dict.fromkeys(options.plot or [None])]
        runs = ModelRuns(with_functions(scene, {}), plots, _shown(), available_workers())
        screened = screening(runs)
        choice = choose(runs, options.error, show_result)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    finally:
        if runs is not None:
            runs.close()
        show_progress()
    written = None if choice.chosen is None else _written(options.spec, target, choice)
    if options.json:
        data = choice_data(scene.name, [plot.name for plot in plots], screened, choice)
        target_data = {
            "specification": str(target) if written else None,
            "notes": list(written.notes) if written else [],
        }
        print(json.dumps({**data, **target_data}, indent=2))
    else:
        print(choice_text(scene.name, [plot.name for plot in plots], screened, choice))
        if written:
            print("\n".join(["", f"wrote {target}", *(f"  {note}" for note in written.notes)]))
    return 0 if written else 1


def _shown() -> Callable[[str], None]:
    """The line of progress of a search, whose number of steps is not known before: with the time so far."""
    elapsed = ElapsedTime()
    return lambda text: show_progress(f"{text.removesuffix(' ...')}{elapsed.text} ...")


def _written(spec: Path, target: Path, choice: Choice) -> WrittenSpecification:
    """Write the specification of the chosen model, after its text has been parsed once more."""
    assert choice.chosen is not None
    line, point = choice.chosen
    source = spec.read_text(encoding="utf-8-sig")
    written = chosen_specification(source, spec, target, read_scene(spec), line.model, point.tolerance)
    target.parent.mkdir(parents=True, exist_ok=True)  # paths of files beside the specification are relative to it
    parse(written.text, str(target))
    with target.open("x", encoding="utf-8") as file:  # another process may have made it meanwhile
        file.write(written.text)
    return written
