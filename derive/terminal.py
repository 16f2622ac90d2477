"""One line on the terminal that tells what is being done; nothing where stderr is no terminal."""

from __future__ import annotations

import sys


def show(what: str = "") -> None:
    """Say what is being done, in place of what was said before; nothing at all removes the line."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{what}\x1b[K")
        sys.stderr.flush()
