"""Instructions inside one function, counted by callgrind: its own, and those of the C library that it calls."""

from __future__ import annotations

import os
import subprocess
from collections import Counter
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Count:
    """Machine instructions an evaluation: of the function itself, and of the libraries behind it."""

    own: float
    library: float

    @property
    def total(self) -> float:
        return self.own + self.library


def count(program: Path, function: str, evaluations: int) -> Count:
    """Run a program that calls a function so many times; only what happens inside it is counted.

    The count is of the simulated processor, hence the same in every run. Symbols are bound before the program starts.
    """
    out = program.with_suffix(".callgrind")
    options = (f"--toggle-collect={function}", f"--callgrind-out-file={out}", "--compress-strings=no")
    command = ["valgrind", "--tool=callgrind", *options, "--compress-pos=no", str(program), str(evaluations)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "LD_BIND_NOW": "1"})
    if done.returncode:
        raise RuntimeError(done.stderr)
    costs = self_costs(out.read_text())
    own = sum(n for (owner, name), n in costs.items() if owner == program.name and not is_stub(name))
    return Count(own / evaluations, (sum(costs.values()) - own) / evaluations)


def is_stub(name: str) -> bool:
    """Whether callgrind names a jump into a shared library, which has no symbol of its own."""
    return name.startswith("0x")


def self_costs(text: str) -> Counter[tuple[str, str]]:
    """Exclusive costs by object file and function. The line after `calls=` is the callee's and is left out."""
    costs: Counter[tuple[str, str]] = Counter()
    owner = name = ""
    callee = False
    for line in text.splitlines():
        key, _, value = line.partition("=")
        if key == "ob":
            owner = Path(value).name
        elif key == "fn":
            name = value
        elif key == "calls":
            callee = True
        elif line[:1].isdigit():
            if not callee:
                costs[owner, name] += int(line.split()[1])
            callee = False
    return costs
