"""Run a command with limits of time and memory, and measure its CPU time and the memory of its largest process."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

MEMORY = 8000
"""The limit of the address space of a process, MB."""

CHILD = """
import json, resource, subprocess, sys
most = int(sys.argv.pop(1)) << 20
resource.setrlimit(resource.RLIMIT_AS, (most, most))
done = subprocess.run(sys.argv[1:], capture_output=True, text=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
seconds = used.ru_utime + used.ru_stime
print(json.dumps([done.returncode, seconds, used.ru_maxrss / 1024, done.stdout, done.stderr[-2000:]]))
"""


@dataclass(frozen=True)
class CommandResult:
    """The CPU time (s) of a command, the memory (MB) of its largest process, and its standard output."""

    seconds: float
    megabytes: float
    text: str


def limited(command: Sequence[str | Path], limit: float | None = None) -> CommandResult | None:
    """The result of a command, None if it takes longer than `limit` seconds. Raises RuntimeError if it fails."""
    process = subprocess.Popen(
        [sys.executable, "-c", CHILD, str(MEMORY), *map(str, command)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        out, error = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return None
    if process.returncode:
        raise RuntimeError(error)
    code, seconds, megabytes, text, errors = json.loads(out)
    if code:
        raise RuntimeError(f"{' '.join(map(str, command))}\n{errors}")
    return CommandResult(seconds, megabytes, text)
