"""The store of a sweep: a file to which finished samples are appended, from which an interrupted sweep continues.

Its first line has everything on which the results depend; a line for each sample follows, with hexadecimal numbers,
which are exact. Each line ends with its checksum. A process that is killed leaves an incomplete last line at most,
which is cut off; other lines that are damaged are left out, and their samples computed again.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from derive.artifacts import MARK, lock
from derive.errors import TisserandError
from derive.study.sweep.worker import Outcome


class StaleStore(TisserandError):
    """A store that belongs to another sweep, or that is not resumed."""


class SampleStore:
    """Finished samples in a file; identity: everything on which their values depend, by a name for each part.

    resume: whether the file of an earlier run of the same sweep is continued. damaged: the lines of it that are left
    out. Raises StaleStore if the file is of another sweep, or if it exists and is not to be continued; it is not
    changed then.
    """

    def __init__(self, path: Path, identity: Mapping[str, str], resume: bool) -> None:
        self.path, self._identity = path, dict(identity)
        self.finished: tuple[Outcome, ...] = ()
        self.damaged = 0
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists():
            self._file = path.open("r+b")
            self._lock()
            self.finished = self._read(resume)
            self._file.seek(0, os.SEEK_END)
        else:
            self._file = path.open("x+b")
            self._lock()
            self._write([{"generator": MARK, "identity": self._identity}])

    def _read(self, resume: bool) -> tuple[Outcome, ...]:
        data = self.path.read_bytes()
        complete = data[: data.rfind(b"\n") + 1]
        lines = complete.splitlines()
        try:
            known: dict[str, str] = _content(lines[0])["identity"]
        except (IndexError, ValueError):
            raise StaleStore(f"{self.path}: this is no store of a sweep; move it, or choose another --out") from None
        if not resume:
            raise StaleStore(
                f"{self.path}: an interrupted sweep has left {len(lines) - 1} finished samples; continue it with "
                "--resume, or remove the file"
            )
        if known != self._identity:
            changed = [part for part in self._identity if known.get(part) != self._identity[part]]
            raise StaleStore(
                f"{self.path}: {' and '.join(changed)} changed since these samples were finished, so that they are not "
                "used; remove the file, or choose another --out"
            )
        os.truncate(self.path, len(complete))
        finished = []
        for line in lines[1:]:
            try:
                finished.append(_outcome(_content(line)))
            except ValueError:
                self.damaged += 1
        return tuple(finished)

    def _lock(self) -> None:
        """Keep other sweeps from the file until it is closed, or this process ends; not on Windows."""
        try:
            lock(self._file, wait=False)
        except OSError:
            raise StaleStore(f"{self.path}: another sweep writes there; wait, or choose another --out") from None

    def append(self, outcomes: Sequence[Outcome]) -> None:
        """Add finished samples."""
        self._write([_plain(outcome) for outcome in outcomes])

    def _write(self, lines: Sequence[Mapping[str, Any]]) -> None:
        self._file.write(b"".join(_line(json.dumps(line).encode()) for line in lines))
        self._file.flush()

    def close(self) -> None:
        """Close the file, from which the sweep may continue."""
        self._file.close()

    def remove(self) -> None:
        """Remove the file: the results of the sweep are written."""
        self._file.close()
        self.path.unlink(missing_ok=True)


def _line(content: bytes) -> bytes:
    """A line of the file: its content, and the checksum of it."""
    return content + f" {zlib.crc32(content):08x}\n".encode()


def _content(line: bytes) -> Any:
    """The content of a line. Raises ValueError if the line is damaged."""
    content = line[:-9]
    if _line(content) != line + b"\n":
        raise ValueError("the checksum is that of another line")
    return json.loads(content)


def _plain(outcome: Outcome) -> dict[str, Any]:
    line: dict[str, Any] = {"n": outcome.number, "v": [value.hex() for value in outcome.values]}
    if outcome.failure:
        line["failure"] = outcome.failure
    if outcome.notes:
        line["notes"] = outcome.notes
    return line


def _outcome(line: Mapping[str, Any]) -> Outcome:
    values = tuple(map(float.fromhex, line["v"]))
    return Outcome(line["n"], values, line.get("failure", ""), tuple(line.get("notes", ())))
