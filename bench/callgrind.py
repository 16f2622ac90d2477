"""The instructions of a function and of the C library functions that it calls, counted by callgrind."""

from __future__ import annotations

import os
import subprocess
from collections import Counter
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Count:
    """Machine instructions of an evaluation: those of the function itself, and those of library functions."""

    own: float
    library: float

    @property
    def total(self) -> float:
        return self.own + self.library


def count(program: Path, function: str, evaluations: int) -> Count:
    """The instructions of a function that a program calls `evaluations` times, without those of the program itself.

    Callgrind simulates the processor, so that every run has the same count. Symbols are bound at the start. Raises
    RuntimeError if valgrind fails.
    """
    out = program.with_suffix(".callgrind")
    options = (f"--toggle-collect={function}", f"--callgrind-out-file={out}", "--compress-strings=no")
    command = ["valgrind", "--tool=callgrind", *options, "--compress-pos=no", str(program), str(evaluations)]
    result = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "LD_BIND_NOW": "1"}
    )
    if result.returncode:
        raise RuntimeError(result.stderr)
    costs = self_costs(out.read_text())
    own = sum(n for (owner, name), n in costs.items() if owner == program.name and not is_stub(name))
    return Count(own / evaluations, (sum(costs.values()) - own) / evaluations)


def is_stub(name: str) -> bool:
    """Whether a name in the output of callgrind is a jump into a shared library, which has no symbol."""
    return name.startswith("0x")


def self_costs(text: str) -> Counter[tuple[str, str]]:
    """Exclusive costs by object file and function, without the costs of callees in the lines after `calls=`."""
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
