"""`tisserand import`: write the specification of a robot from its URDF."""

from __future__ import annotations

import argparse
import json
import os
import shlex
from pathlib import Path

from derive.artifacts import File, ForeignFile, check_folder
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot
from derive.urdf.repairs import with_locked_joints
from derive.urdf.written_scene import written_scene


def run(options: argparse.Namespace) -> int:
    """Write the specification, which must not exist yet, after its text has been checked."""
    folder = options.out.parent if options.out else Path()
    source = str(options.robot)
    robot = with_locked_joints(read_robot(options.robot, options.keep_angles), options.lock, source)
    scene = written_scene(robot, options.base, source, folder, options.repair_inertia)
    target: Path = options.out or Path(f"{scene.name}.toml")
    if os.path.lexists(target):
        raise ForeignFile(f"{target}: this file exists and is left alone; give another file with --out")
    check_folder([File(target.name, "")], target.parent, len(scene.text))
    target.parent.mkdir(parents=True, exist_ok=True)  # paths of meshes lead through it
    parse(scene.text, str(target))
    with target.open("x", encoding="utf-8") as file:  # another process may have made it meanwhile
        file.write(scene.text)
    if options.json:
        print(json.dumps({"name": scene.name, "specification": str(target), "notes": list(scene.notes)}, indent=2))
        return 0
    print("\n".join([f"{scene.name}: {scene.doc}", *(f"  {note}" for note in scene.notes), f"wrote {target}"]))
    print(f"next: {shlex.join(['tisserand', 'run', str(target), '--open'])}")
    return 0
