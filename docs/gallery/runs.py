"""Runs the examples, two at a time, each in a process of its own, and keeps the results until something changes."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import multiprocessing
import shutil
import sys
import traceback
from collections.abc import Iterable
from dataclasses import dataclass, replace
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from derive.errors import TisserandError
from derive.kept_objects import package_hash
from docs.gallery.entries import ROOT, Entry
from docs.gallery.recording import MESSAGES, OUTPUT, RESULT, record

AT_ONCE = 2
KEY = "key"
"""The file with the hash of all that a result depends on."""


RECORDING = ("recording", "motion", "numbers", "pictures", "stroboscope")
"""The modules that a result depends on."""


class ExamplesFail(TisserandError):
    """Some examples end with an error."""


@dataclass(frozen=True)
class Run:
    """The result of an example: its files are in `folder`, and `data` names them; None if it was not run.

    output: the text that it prints. seconds: of processor time.
    """

    entry: Entry
    folder: Path
    data: dict[str, Any] | None = None
    output: str = ""

    def file(self, kind: str) -> Path | None:
        """The file "motion", "drawing" or "report", if there is one."""
        name = self.data and self.data.get(kind)
        return self.folder / name if name else None

    @property
    def pictures(self) -> list[Path]:
        """The pictures that the example draws."""
        return [self.folder / name for name in self.data["pictures"]] if self.data else []

    @property
    def shapes(self) -> list[tuple[Path, str]]:
        """The pictures of the shape functions of beams, with their alternative texts."""
        return [(self.folder / of["name"], of["alt"]) for of in self.data.get("shapes", ())] if self.data else []

    @property
    def numbers(self) -> list[tuple[str, str]]:
        """The numbers of the example with their labels."""
        return [(label, text) for label, text in self.data["numbers"]] if self.data else []

    @property
    def seconds(self) -> float:
        """The processor time that the example takes, s; 0 if it was not run."""
        return float(self.data["seconds"]) if self.data else 0.0


def results(entries: Iterable[Entry], folder: Path) -> list[Run]:
    """The results of all examples, of which those that are kept in `folder` and still hold are not run again.

    Progress is printed to the standard error. Raises ExamplesFail, after all have run, with their messages.
    """
    entries = list(entries)
    outdated = [entry for entry in entries if not _missing(entry) and not _holds(entry, folder / entry.name)]
    failures = _run(outdated, folder) if outdated else []
    if failures:
        raise ExamplesFail("\n\n".join(failures))
    return [_read(entry, folder / entry.name) for entry in entries]


def _missing(entry: Entry) -> bool:
    """Whether a package that an example needs is not installed."""
    return entry.needs is not None and importlib.util.find_spec(entry.needs) is None


def key(entry: Entry) -> str:
    """The hash of all that a result depends on: the sources of the example, of the scenes, of the runs, the package."""
    digest = hashlib.sha256(package_hash().encode() + repr(replace(entry, card=None)).encode())
    files = [ROOT / path for path in (entry.path, *entry.shown)]
    files += [path for path in sorted((ROOT / "scenes").iterdir()) if path.suffix in (".toml", ".csv", ".npz")]
    files += [Path(__file__).with_name(f"{module}.py") for module in RECORDING]
    for path in files:
        digest.update(path.name.encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _holds(entry: Entry, folder: Path) -> bool:
    file = folder / KEY
    return file.exists() and file.read_text() == key(entry)


def _read(entry: Entry, folder: Path) -> Run:
    if _missing(entry):
        return Run(entry, folder)
    return Run(entry, folder, json.loads((folder / RESULT).read_text()), (folder / OUTPUT).read_text())


def _run(entries: list[Entry], folder: Path) -> list[str]:
    """Run examples, and return the messages of those that fail."""
    start = "fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn"
    if start == "fork" and len(entries) > AT_ONCE:
        _preload()
    context = multiprocessing.get_context(start)
    waiting, running, failures, done = list(entries), {}, [], 0
    while waiting or running:
        while waiting and len(running) < AT_ONCE:
            entry = waiting.pop(0)
            process = context.Process(target=_recorded, args=(entry, folder / entry.name))
            process.start()
            running[process.sentinel] = process, entry
        for sentinel in wait(list(running)):
            process, entry = running.pop(sentinel)
            process.join()
            done += 1
            if process.exitcode:
                message = (folder / entry.name / "error.txt").read_text()
                failures.append(f"{entry.path}: {message.strip()}")
            seconds = "failed" if process.exitcode else f"{_read(entry, folder / entry.name).seconds:.1f} s"
            print(f"[{done}/{len(entries)}] {entry.path}: {seconds}", file=sys.stderr, flush=True)
    return failures


def _preload() -> None:
    """Import what most examples need, which takes two seconds: processes that fork have it then."""
    import matplotlib.pyplot as plt

    import derive

    plt.switch_backend("svg")
    for name in ("simulate", "load", "lower"):
        getattr(derive, name)


def _recorded(entry: Entry, folder: Path) -> None:
    """Run an example into an empty folder; its error, if there is one, is in error.txt."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        record(entry, folder)
    except BaseException:
        messages = folder / MESSAGES
        printed = messages.read_text() if messages.exists() else ""
        (folder / "error.txt").write_text(printed + traceback.format_exc())
        sys.exit(1)
    (folder / KEY).write_text(key(entry))
