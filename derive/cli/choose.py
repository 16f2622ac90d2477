"""`tisserand choose`: select, explain and write the cheapest model of a scene that is accurate enough."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path

from derive.artifacts import File, check_folder
from derive.cli.arguments.keywords import keywords
from derive.cli.specifications import read_scene
from derive.errors import SpecError, TisserandError
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import parse, with_lines
from derive.study.choice.choice_text import choice_data, choice_text
from derive.study.choice.choose import choose
from derive.study.choice.search import Choice
from derive.study.choice.written_specification import WrittenSpecification, chosen_specification
from derive.study.studied_scene import has_flexible_body

EXPECTED_SIZE = 100_000
"""The approximate size that a specification has at most, in bytes."""


RIGID = (
    "nothing to choose, and no file written: all bodies are rigid, so that there is one model; [scene] coordinates and "
    "lowering change how fast its code is and not its motion, and `tisserand build` tells which are taken and why"
)
"""The line on a scene of rigid bodies."""


class ExistingFile(TisserandError):
    """A file that would be overwritten."""


def run(options: argparse.Namespace) -> int:
    """Search, print the result, and write the specification. The exit code is 1 if no model is accurate enough.

    Of rigid bodies there is one model, which is no error: a line says so.
    """
    scene = read_scene(options.spec)
    if isinstance(scene, AnyScene) and not has_flexible_body(scene):
        data = {"name": scene.name, "notes": [RIGID]}
        print(json.dumps(data, indent=2) if options.json else f"{scene.name}: {RIGID}")
        return 0
    target = options.out or options.spec.with_name(f"{options.spec.stem}_chosen.toml")
    if os.path.lexists(target):
        raise ExistingFile(f"{target} exists, and is not overwritten; move it, or give another file with --out")
    check_folder([File(target.name, "")], target.parent, EXPECTED_SIZE)
    try:
        choice = choose(scene, **keywords(choose, options), progress=True)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    if not options.json:
        print(choice_text(choice), flush=True)  # a search is long: it is told whatever happens to the file
    written = None if choice.chosen is None else _written(options.spec, target, choice)
    if options.json:
        data = choice_data(choice)
        target_data = {
            "specification": str(target) if written else None,
            "notes": list(written.notes) if written else [],
        }
        print(json.dumps({**data, **target_data}, indent=2))
    elif written:
        print("\n".join(["", f"wrote {target}", *(f"  {note}" for note in written.notes)]))
    return 0 if written else 1


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
