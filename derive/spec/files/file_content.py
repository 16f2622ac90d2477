"""The bytes of files that a user or a specification names; none of it is trusted."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from derive.errors import Problem, SpecError, printable, quoted
from derive.spec.parsing.values import WrongValueError


def file_content(name: str | os.PathLike[str], folder: Path, most: int, advice: str = "") -> bytes:
    """The bytes of a file, at most `most`; its path is relative to the folder of the specification."""
    text = os.fsdecode(name)
    try:
        content = regular_file_start(folder / text, most + 1)
    except (OSError, ValueError) as error:
        beside = "" if Path(text).is_absolute() else "; its path begins at the folder of the specification"
        raise WrongValueError(f"{unreadable(error, text)}{beside}") from None
    if len(content) > most:
        raise WrongValueError(f"the file {quoted(text)} has more than {most // 1_000_000} MB{advice}")
    return content


def regular_file_start(path: Path, count: int) -> bytes:
    """The first `count` bytes of a regular file. Raises OSError and ValueError, as `open` does.

    A pipe or a device is refused: to open a pipe that nobody writes to blocks for ever, and so may reading a device.
    """
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        mode = os.fstat(descriptor).st_mode
        if not stat.S_ISREG(mode):
            raise ValueError("is a directory" if stat.S_ISDIR(mode) else "it is a pipe or a device, not a file")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            return file.read(count)
    finally:
        os.close(descriptor)


def unreadable(error: OSError | ValueError, name: str = "") -> str:
    """A message on an error of `regular_file_start`, with the name of the file if its reader does not see that."""
    why, file = (
        printable(getattr(error, "strerror", None) or str(error)),
        f"the file {quoted(name)}" if name else "the file",
    )
    return f"{file} cannot be read: {why[:1].lower()}{why[1:]}"


def specification_bytes(source: str, most: int, too_large: str) -> bytes:
    """The bytes of a file that a command reads, at most `most`. Raises SpecError, with `too_large` if it has more."""
    try:
        content = regular_file_start(Path(source), most + 1)
    except (OSError, ValueError) as error:
        raise SpecError((Problem("", unreadable(error)),), source) from None
    if len(content) > most:
        raise SpecError((Problem("", too_large),), source)
    return content
