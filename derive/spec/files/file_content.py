"""The bytes of a file that a specification names; none of it is trusted."""

from __future__ import annotations

import os
from pathlib import Path

from derive.errors import printable, quoted
from derive.spec.parsing.values import WrongValueError


def file_content(name: str | os.PathLike[str], folder: Path, most: int, advice: str = "") -> bytes:
    """The bytes of a file, at most so many; its path begins at the folder of the specification."""
    text = os.fsdecode(name)
    try:
        with (folder / text).open("rb") as file:
            content = file.read(most + 1)
    except (OSError, ValueError) as error:
        why = printable(getattr(error, "strerror", None) or str(error))
        beside = "" if Path(text).is_absolute() else "; its path begins at the folder of the specification"
        raise WrongValueError(f"the file {quoted(text)} cannot be read: {why[:1].lower()}{why[1:]}{beside}") from None
    if len(content) > most:
        raise WrongValueError(f"the file {quoted(text)} has more than {most // 1_000_000} MB{advice}")
    return content
