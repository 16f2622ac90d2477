"""The line of progress in a notebook: an output of the cell that runs, whose text is replaced again and again.

IPython is not imported here: in a notebook it is there already.
"""

from __future__ import annotations

import sys
from html import escape
from typing import Any


class NotebookLine:
    """One output of the running cell; the first text after an empty one begins another output."""

    def __init__(self) -> None:
        self._handle: Any = None

    def show(self, text: str) -> None:
        """Replace the text; an empty one removes it, and the output ends."""
        if self._handle is None:
            if text:
                display = sys.modules["IPython.display"].display
                self._handle = display(_content(text), raw=True, display_id=True)
            return
        self._handle.update(_content(text), raw=True)
        if not text:
            self._handle = None


def _content(text: str) -> dict[str, str]:
    """A text as an output; the HTML of an empty one leaves no box on a page."""
    return {"text/plain": text, "text/html": f"<pre>{escape(text)}</pre>" if text else ""}


LINE = NotebookLine()
"""The line of progress of this process."""


def in_notebook() -> bool:
    """Whether a notebook runs this process: an IPython whose outputs go to the kernel of one."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None and "IPython.display" in sys.modules else None
    return getattr(shell, "kernel", None) is not None
