"""The output of the five lines of Python in the README, which the start page shows below them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

MARK = "<!-- what the five lines print -->"
"""The place of the output on a page."""


def with_output(page: str, readme: str, root: Path) -> str:
    """The page with the output of the README's example at its mark; the example is run for it."""
    code = readme.split("```python\n")[1].split("```", maxsplit=1)[0]
    environment = {**os.environ, "PYTHONPATH": str(root)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert MARK in page
    shown = f"The last line prints the accelerations of the five coordinates:\n\n```text\n{done.stdout.strip()}\n```"
    return page.replace(MARK, shown)
