"""`tisserand sid`: print a finite-element body as standard input data (SID), which other multibody programs read."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace

from derive.derivation import modal, reduced_bodies
from derive.errors import Problem, SpecError, quoted
from derive.sid import write
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.parsing.faults import did_you_mean
from derive.spec.toml.read import read, with_lines


def run(options: argparse.Namespace) -> int:
    """Print the SID of a body."""
    spec = read(options.spec)
    try:
        text = write(modal(spec)) if isinstance(spec, NodalBody) else _of_scene(spec, options.body)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    sys.stdout.write(text)
    return 0


def _of_scene(spec: object, name: str | None) -> str:
    """The SID of the finite-element body of a scene, of this name if there are several; markers are its nodes."""
    bodies = reduced_bodies(spec) if isinstance(spec, SpatialScene) else {}
    if not bodies:
        message = "SID describes a body given by nodes, and this specification has none; see scenes/block.toml"
        raise SpecError((Problem("", message),))
    if name not in bodies and (name is not None or len(bodies) > 1):
        known = f"the finite-element bodies are {', '.join(bodies)}"
        text = f"{known}; name one: --body {next(iter(bodies))}"
        if name is not None:
            text = f"there is no finite-element body {quoted(name)}{did_you_mean(name, bodies, known)}"
        raise SpecError((Problem("bodies", text),))
    reduced = bodies[name] if name is not None else next(iter(bodies.values()))
    points = tuple(frame.point for frame in reduced.frames)
    frames = {frame.point.name: frame for frame in reduced.frames}
    return write(replace(reduced.body, points=points), frames=frames)
