"""The parts of a timed program besides its calls, which are collected from several makers of code."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field
from pathlib import Path

from interleaved import Array
from limited import CommandResult, limited

from derive.runtime.compiler import compiler


@dataclass
class Program:
    """The parts of the timed program of a scene, besides its calls."""

    folder: Path
    flags: str
    objects: list[Path] = field(default_factory=list)
    declare: list[str] = field(default_factory=list)
    once: list[str] = field(default_factory=list)
    arrays: dict[str, Array] = field(default_factory=dict)
    scratch: dict[str, int] = field(default_factory=dict)
    libraries: list[str] = field(default_factory=list)

    def compile(self, source: Path, options: str = "", target: str = "") -> CommandResult | None:
        """Compile a file and add its object."""
        out = self.folder / f"{target or source.stem}.o"
        done = limited([*compiler(), *shlex.split(f"{self.flags} {options} -w -c"), str(source), "-o", str(out)])
        self.objects.append(out)
        return done
