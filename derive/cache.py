"""Results that are kept between runs in the user's cache folder: private files, verified before they are used.

The folder is `tisserand` in $XDG_CACHE_HOME, or in `~/.cache`. Only the user may read or write it and its files
(0700, 0600); a folder or a file that belongs to someone else, or that others may use, is never used. A file begins
with the SHA-256 of its name and content. Its name is the hash of all that the content depends on, so that nothing is
ever out of date; that of `durations.py` alone is always the same. Files are written beside their names and then
renamed, so that a process that is killed leaves nothing that is read.
"""

from __future__ import annotations

import hashlib
import os
import secrets
import stat
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

LIMIT = 256_000_000
"""The bytes that all files may have together; the least recently used ones are removed beyond it."""
KEPT = 0.75
"""The fraction of LIMIT to which the files are reduced once they exceed it."""
ABANDONED = 3600.0
"""The age (s) from which a temporary file counts as abandoned by a process that was killed."""
DIGEST = hashlib.sha256().digest_size

_disabled: ContextVar[bool] = ContextVar("disabled", default=False)
_reported: set[str] = set()


@contextmanager
def no_cache(disabled: bool = True) -> Iterator[None]:
    """Neither read nor write the cache in this context; with False, change nothing."""
    token = _disabled.set(disabled or _disabled.get())
    try:
        yield
    finally:
        _disabled.reset(token)


def key(*parts: str | bytes) -> str:
    """The hash of all that a result depends on, as the name of its file."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "big") + data)
    return digest.hexdigest()


def read(name: str) -> bytes | None:
    """The content that is kept under a name (`key`); None if there is none, or none that can be trusted."""
    folder = _folder()
    if folder is None:
        return None
    path = folder / name
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)  # a pipe would block
    except OSError:  # there is none, or a link
        return None
    with os.fdopen(handle, "rb") as stream:
        status = os.fstat(handle)
        if not (stat.S_ISREG(status.st_mode) and _private(status) and status.st_nlink <= 1):  # 0: replaced since
            _report(f"{path}: the file is not private to this user, and is not used")
            return None
        content = stream.read()
        digest, data = content[:DIGEST], content[DIGEST:]
        if digest != _digest(name, data):  # a disk has failed, or the file has been changed
            _report(f"{path}: the file is damaged, and is not used")
            return None
        with suppress(OSError):
            os.utime(handle)
    return data


def write(name: str, data: bytes) -> None:
    """Keep a content under a name (`key`). Nothing is kept where nothing can be written."""
    folder = _folder()
    if folder is None:
        return
    temporary = folder / f".{name}.{secrets.token_hex(8)}"
    try:
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
        with os.fdopen(handle, "wb") as stream:
            stream.write(_digest(name, data) + data)
        os.replace(temporary, folder / name)
    except OSError:  # a full disk, a quota: the result is computed again
        pass
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
    _limit(folder)


def _digest(name: str, data: bytes) -> bytes:
    return hashlib.sha256(name.encode() + b"\0" + data).digest()


def _folder() -> Path | None:
    """The cache folder, which is made if it is missing; None if there is none that can be trusted."""
    if _disabled.get() or not hasattr(os, "getuid"):  # Windows has no owners that are compared so easily
        return None
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    try:
        folder = (base if base.is_absolute() else Path.home() / ".cache") / "tisserand"
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        status = folder.lstat()
    except (OSError, RuntimeError):  # no home, or it is write-protected
        return None
    if not (stat.S_ISDIR(status.st_mode) and _private(status)):
        _report(f"{folder}: the cache is not used, since it is no folder that is private to this user (chmod 700)")
        return None
    return folder


def _private(status: os.stat_result) -> bool:
    """Whether a file or a folder belongs to this user, and nobody else may use it."""
    return status.st_uid == os.getuid() and not stat.S_IMODE(status.st_mode) & 0o077


def _report(line: str) -> None:
    """Print a line to standard error, once."""
    if line not in _reported:
        _reported.add(line)
        print(f"note: {line}", file=sys.stderr)


def _limit(folder: Path) -> None:
    """Remove abandoned temporary files and, beyond the limit, the least recently used files."""
    files: list[tuple[float, int, Path]] = []
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):  # another process has removed it
                status = entry.stat(follow_symlinks=False)
                if not entry.name.startswith("."):
                    files.append((status.st_mtime, status.st_size, folder / entry.name))
                elif status.st_mtime < time.time() - ABANDONED:
                    (folder / entry.name).unlink()
    total = sum(size for _, size, _ in files)
    if total <= LIMIT:
        return
    for _, size, path in sorted(files):
        if total <= KEPT * LIMIT:
            break
        with suppress(OSError):
            path.unlink()
            total -= size
