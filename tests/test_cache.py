"""The cache: private files that are verified, whatever others, other processes and kills do to its folder."""

from __future__ import annotations

import os
import pickle
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive import cache, generated_models
from derive.cli.main import main
from derive.generated_models import generated
from derive.runtime import loading

NAME = cache.key("a name")
DATA = b"some content" * 100


def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a cache that is empty at the begin of a test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(cache, "_reported", set())
    return tmp_path / "home" / "tisserand"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return empty_cache(tmp_path, monkeypatch)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.lstat().st_mode)


def test_what_is_written_is_read_and_private(folder: Path) -> None:
    before = os.umask(0)
    try:
        cache.write(NAME, DATA)
    finally:
        os.umask(before)
    assert cache.read(NAME) == DATA
    assert mode(folder) == 0o700 and [mode(file) for file in folder.iterdir()] == [0o600]
    assert cache.read(cache.key("another name")) is None


def test_keys_tell_parts_apart() -> None:
    assert len({cache.key(*parts) for parts in (("ab", "c"), ("a", "bc"), ("abc",), (b"abc", ""))}) == 4


def shared(folder: Path) -> None:
    (folder / NAME).chmod(0o606)


def linked(folder: Path) -> None:
    (folder / NAME).rename(folder / "elsewhere")
    (folder / NAME).symlink_to(folder / "elsewhere")


def hard_linked(folder: Path) -> None:
    os.link(folder / NAME, folder / "elsewhere")


def damaged(folder: Path) -> None:
    (folder / NAME).write_bytes((folder / NAME).read_bytes()[:-1] + b"!")


def cut(folder: Path) -> None:
    (folder / NAME).write_bytes((folder / NAME).read_bytes()[:10])


def of_another_name(folder: Path) -> None:
    cache.write(cache.key("another"), b"another content")
    (folder / cache.key("another")).rename(folder / NAME)


def others_may_write(folder: Path) -> None:
    folder.chmod(0o777)


def folder_is_a_link(folder: Path) -> None:
    folder.rename(folder.with_name("elsewhere"))
    folder.symlink_to(folder.with_name("elsewhere"))


@pytest.mark.parametrize(
    ("plant", "message"),
    [
        (shared, "the file is not private to this user"),
        (linked, ""),
        (hard_linked, "the file is not private to this user"),
        (damaged, "the file is damaged"),
        (cut, "the file is damaged"),
        (of_another_name, "the file is damaged"),
        (others_may_write, "the cache is not used"),
        (folder_is_a_link, "the cache is not used"),
    ],
)
def test_what_others_may_have_planted_is_not_used(
    plant: Callable[[Path], None], message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cache.write(NAME, DATA)
    plant(folder)
    assert cache.read(NAME) is None
    assert cache.read(NAME) is None
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == (message != ""), "one line, once"


def test_files_of_another_user_are_not_used(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cache.write(NAME, DATA)
    user = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    assert cache.read(NAME) is None
    cache.write(cache.key("mine"), DATA)
    assert [file.name for file in folder.iterdir()] == [NAME]
    assert "the cache is not used, since it is no folder that is private to this user" in capsys.readouterr().err


def test_without_a_place_nothing_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.parent.write_text("a file where the folder should be")
    cache.write(NAME, DATA)
    assert cache.read(NAME) is None
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(folder.parent.with_name("user")))
    cache.write(NAME, DATA)
    assert (folder.parent.with_name("user") / ".cache" / "tisserand" / NAME).exists(), "relative paths do not count"


def test_the_least_recently_used_are_removed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "LIMIT", 4 * (len(DATA) + cache.DIGEST))
    names = [cache.key(str(i)) for i in range(5)]
    for age, name in enumerate(names[:4]):
        cache.write(name, DATA)
        os.utime(folder / name, (age, age))
    assert cache.read(names[0]) == DATA  # and is as young as can be
    cache.write(names[4], DATA)
    assert [cache.read(name) is not None for name in names] == [True, False, False, True, True]


def test_abandoned_files_are_removed(folder: Path) -> None:
    cache.write(NAME, DATA)
    old, young = folder / ".old", folder / ".young"
    for path in (old, young):
        path.write_bytes(b"part")
    os.utime(old, (1, 1))
    cache.write(NAME, DATA)
    assert not old.exists() and young.exists() and cache.read(NAME) == DATA


WRITER = """
import sys
from derive import cache
data = sys.argv[2].encode() * 500_000
print("ready", flush=True)
while True:
    cache.write(sys.argv[1], data)
"""


def test_processes_write_at_once_and_are_killed() -> None:
    """A file that is read is whole, and has one of the contents that were written."""
    started = [
        subprocess.Popen([sys.executable, "-c", WRITER, NAME, text], cwd=ROOT, stdout=subprocess.PIPE) for text in "ab"
    ]
    seen = set()
    try:
        for process in started:
            assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        end = time.monotonic() + 20
        while (len(seen) < 2 or None in seen) and time.monotonic() < end:
            data = cache.read(NAME)
            seen |= {data[:1]} if data is not None and data == data[:1] * 500_000 else {data}
            seen.discard(None) if data is None and len(seen) == 1 else None
    finally:
        for process in started:
            process.send_signal(signal.SIGKILL)
            process.communicate()
    assert seen == {b"a", b"b"}
    data = cache.read(NAME)
    assert data is not None and data == data[:1] * 500_000


def forbidden(*arguments: object) -> None:
    raise AssertionError("made anew")


TABLE = """
name = "swing"
ground.markers = { o = [0, 0] }
[tables]
load = { file = "load.csv", x = "t", y = "F" }
[bodies.arm]
mass = 1
length = 1
bending_stiffness = 20
markers = { hub = -1, tip = 1 }
[joints.hub]
kind = "revolute"
between = ["ground.o", "arm.hub"]
[forces.push]
at = "arm.tip"
components = [0, "load(t)"]
[simulation]
duration = 0.1
output = 0.05
"""


def swing(folder: Path) -> Path:
    """A scene with a table of a file, below a folder."""
    (folder / "load.csv").write_text("t,F\n0,0\n0.1,1\n0.2,0\n0.3,2\n")
    (folder / "swing.toml").write_text(TABLE)
    return folder / "swing.toml"


class Planted:
    """An object by which a manipulated file would call a function when it is read."""

    def __reduce__(self) -> tuple[Callable[..., None], tuple[str]]:
        return print, ("planted",)


def test_a_file_calls_nothing_when_it_is_read(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    data = pickle.dumps(Planted())
    pickle.loads(data)
    assert capsys.readouterr().out == "planted\n"
    monkeypatch.setattr(cache, "read", lambda name: data)
    assert generated(derive.planar_beam("kept"))[0].name == "kept"
    assert capsys.readouterr().out == ""


def test_the_command(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With and without the cache the results are the same, and with it nothing is derived or compiled again."""
    arguments = ["simulate", str(swing(tmp_path)), "--out"]
    assert main([*arguments, str(tmp_path / "a"), "--no-cache"]) == 0
    assert not folder.exists()
    assert main([*arguments, str(tmp_path / "b")]) == 0
    assert len([*folder.iterdir()]) >= 2
    monkeypatch.setattr(loading, "compile_shared", forbidden)
    monkeypatch.setattr(generated_models, "_made", forbidden)
    assert main([*arguments, str(tmp_path / "c")]) == 0
    for name in ("swing.csv", "swing.html"):
        texts = {(tmp_path / out / "swing" / name).read_bytes() for out in "abc"}
        assert len(texts) == 1, name
