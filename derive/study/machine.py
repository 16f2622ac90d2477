"""What times depend on: compiler, flags, and the kind of machine."""

from __future__ import annotations

import platform
import subprocess
from pathlib import Path

from derive.runtime.compiler import FLAGS, compiler


def described() -> dict[str, str]:
    """Compiler, flags and processor, as they name themselves; no names of machines, no paths."""
    return {"compiler": _compiler(), "flags": " ".join(FLAGS), "machine": _machine()}


def _compiler() -> str:
    done = subprocess.run([*compiler(), "--version"], capture_output=True, text=True, check=False)
    return done.stdout.splitlines()[0] if done.stdout else "unknown"


def _machine() -> str:
    info = Path("/proc/cpuinfo")
    fields = dict(line.split(":", 1) for line in info.read_text().splitlines() if ":" in line) if info.exists() else {}
    model = {key.strip(): value.strip() for key, value in fields.items()}.get("model name", "")
    return ", ".join(part for part in (model, platform.system(), platform.machine()) if part)
