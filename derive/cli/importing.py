"""`tisserand import`: write the specification of a robot (URDF), or of a part from a finite-element program."""

from __future__ import annotations

import argparse
import json
import os
import shlex
from dataclasses import dataclass
from pathlib import Path

from derive.artifacts import File, ForeignFile, check_folder
from derive.errors import Problem, SpecError, quoted
from derive.fem.imported_body import BodyOptions, imported_body
from derive.fem.readers import READERS
from derive.fem.written_body import SI, FileUnits
from derive.spec.files.node_format import LENGTHS, MASSES, TIMES
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.parsing.faults import did_you_mean
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot
from derive.urdf.repairs import with_locked_joints
from derive.urdf.written_scene import written_scene

ROBOTS = (".urdf", ".xml", ".xacro", "")
"""The suffixes of descriptions of robots; the first is the usual one."""
OF_ROBOTS = ("base", "lock", "repair_inertia", "keep_angles")
OF_PARTS = ("interface", "modes", "error", "up_to", "component_modes", "units", "scene", "second_order")
"""The options that one of both kinds of files has alone."""


@dataclass(frozen=True)
class Imported:
    """A specification with lines on it, the content of its file of nodes, and the command that comes next."""

    name: str
    doc: str
    text: str
    notes: tuple[str, ...]
    next: tuple[str, ...]
    nodes: bytes | None = None


def run(options: argparse.Namespace) -> int:
    """Write the specification, which must not exist yet, after its text has been checked."""
    part = options.file.suffix.lower() in READERS
    if not part and options.file.suffix.lower() not in ROBOTS:
        known = ", ".join((*ROBOTS[:1], *READERS))
        why = f"files of the kind {quoted(options.file.suffix)} are not read; those that are end in {known}"
        raise SpecError((Problem("", why),), str(options.file))
    _check_options(options, OF_ROBOTS if part else OF_PARTS, "a robot" if part else "a part")
    imported = _part(options) if part else _robot(options)
    target: Path = options.out or Path(f"{imported.name}.toml")
    targets = [target] if imported.nodes is None else [nodes_file(target), target]
    for path in targets:
        if os.path.lexists(path):
            raise ForeignFile(f"{path}: this file exists and is left alone; give another file with --out")
    size = len(imported.text) + len(imported.nodes or b"")
    check_folder([File(target.name, "")], target.parent, size)
    target.parent.mkdir(parents=True, exist_ok=True)  # paths of meshes lead through it
    if imported.nodes is not None:
        with nodes_file(target).open("xb") as nodes:
            nodes.write(imported.nodes)
    try:
        parse(imported.text, str(target))
    except SpecError:
        if imported.nodes is not None:
            nodes_file(target).unlink()
        raise
    with target.open("x", encoding="utf-8") as text:  # another process may have made it meanwhile
        text.write(imported.text)
    written = [str(file) for file in targets]
    if options.json:
        notes = {"specification": str(target), "files": written, "notes": list(imported.notes)}
        print(json.dumps({"name": imported.name, **notes}, indent=2))
        return 0
    lines = [f"{imported.name}: {imported.doc}", *(f"  {note}" for note in imported.notes)]
    print("\n".join([*lines, *(f"wrote {file}" for file in written)]))
    print(f"next: {shlex.join(['tisserand', imported.next[0], str(target), *imported.next[1:]])}")
    return 0


def nodes_file(target: Path) -> Path:
    """The file of nodes beside a specification."""
    return target.with_suffix(".npz")


def _check_options(options: argparse.Namespace, others: tuple[str, ...], kind: str) -> None:
    """Refuse options that belong to files of the other kind."""
    wrong = [f"--{name.replace('_', '-')}" for name in others if getattr(options, name)]
    if wrong:
        problems = tuple(
            Problem(name, f"this is for {kind}, which {quoted(options.file.name)} is not") for name in wrong
        )
        raise SpecError(problems)


def _robot(options: argparse.Namespace) -> Imported:
    folder = options.out.parent if options.out else Path()
    source = str(options.file)
    robot = with_locked_joints(read_robot(options.file, options.keep_angles), options.lock, source)
    scene = written_scene(robot, options.base or "fixed", source, folder, options.repair_inertia)
    return Imported(scene.name, scene.doc, scene.text, scene.notes, ("run", "--open"))


def _part(options: argparse.Namespace) -> Imported:
    reader = READERS[options.file.suffix.lower()]
    units = _units(options.units)
    model = reader.read(options.file)
    own = BodyOptions(
        options.interface or (), _modes(options), options.component_modes, units, options.scene, options.second_order
    )
    out = nodes_file(options.out).name if options.out else ""
    body = imported_body(model, own, str(options.file), out)
    following = ("run", "--open") if options.scene else ("build",)
    return Imported(body.name, body.doc, body.text, body.notes, following, body.archive)


def _modes(options: argparse.Namespace) -> int | ModeSelection | None:
    """The number of modes, or the error that chooses them. Raises SpecError."""
    if options.error is None and options.up_to is None:
        return None if options.modes is None else int(options.modes)
    if options.modes is not None:
        raise SpecError((Problem("--modes", "the error chooses the number of modes; leave one of them out"),))
    if options.error is None or options.up_to is None:
        text = "an error needs the frequencies that it is for: --error 0.01 --up-to 500, in Hz"
        raise SpecError((Problem("--error" if options.up_to is None else "--up-to", text),))
    return ModeSelection(options.error, options.up_to)


def _units(text: str | None) -> FileUnits:
    """The units of the option: length, mass and time. Raises SpecError."""
    if text is None:
        return SI
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 3:
        problem = Problem("--units", f"length, mass and time are needed, such as mm,t,s, not {quoted(text)}")
        raise SpecError((problem,))
    problems = []
    for part, known in zip(parts, (LENGTHS, MASSES, TIMES), strict=True):
        if part not in known:
            hint = did_you_mean(part, known, f"the units here are {', '.join(known)}")
            problems.append(Problem("--units", f"there is no unit {quoted(part)}{hint}"))
    if problems:
        raise SpecError(tuple(problems))
    return FileUnits(*parts)
