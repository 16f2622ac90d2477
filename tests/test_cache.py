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
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive import cache, generated_models, kept_objects
from derive.backends.model_files import fingerprint
from derive.cli.main import main
from derive.generated_models import generated
from derive.mechanics.time_integrals import closed_form, kept
from derive.registry import Registry
from derive.runtime import loading

NAME = cache.key("a name")
DATA = b"some content" * 100


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(cache, "_reported", set())
    return tmp_path / "home" / "tisserand"


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


@pytest.mark.parametrize("source", ["free_beam_mean", "body_symbolic", "block", "swing"])
def test_kept_models_are_those_that_are_made(source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = derive.read(swing(tmp_path) if source == "swing" else ROOT / f"scenes/{source}.toml")
    made = generated(spec)
    monkeypatch.setattr(generated_models, "_made", forbidden)
    assert generated(spec) == made
    assert type(generated(spec)[1][1]) is type(made[1][1])
    with cache.no_cache(), pytest.raises(AssertionError, match="made anew"):
        generated(spec)


def test_models_are_made_anew_where_anything_else_is_different(monkeypatch: pytest.MonkeyPatch) -> None:
    beam = derive.planar_beam("kept")
    generated(beam)
    monkeypatch.setattr(generated_models, "_made", forbidden)
    generated(beam)
    with pytest.raises(AssertionError, match="made anew"):
        generated(replace(beam, name="other"))
    with monkeypatch.context() as patch:
        patch.setattr(kept_objects, "package_hash", lambda: "other sources")
        with pytest.raises(AssertionError, match="made anew"):
            generated(beam)
    with monkeypatch.context() as patch:
        patch.setattr(kept_objects, "version", lambda name: "another version")
        with pytest.raises(AssertionError, match="made anew"):
            generated(beam)
    for registry in generated_models.OPEN:
        registry.register("of my own", next(iter(registry.values())))
        try:
            with pytest.raises(AssertionError, match="made anew"):
                generated(beam)
        finally:
            registry.unregister("of my own")
    generated(beam)


def test_all_registries_that_change_models_are_known() -> None:
    """Integrators, interfaces and readers do not change them, nor do bodies in space, which are not open."""
    others = {"integrator", "interface", "file of a finite-element program"}
    modules = [module for name, module in [*sys.modules.items()] if name.startswith("derive.")]
    found = {id(value): value for module in modules for value in vars(module).values() if isinstance(value, Registry)}
    kinds = {registry.kind for registry in found.values()} - others
    assert kinds == {registry.kind for registry in generated_models.OPEN} and len(kinds) > 8


def test_the_integral_of_a_speed_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is found once; that of another speed, and of one of another package, is found anew."""
    speed = derive.time_function("t*sin(3*t)")
    expected = closed_form.time_integral(speed)
    kept.kept_integral.cache_clear()
    assert kept.kept_integral(speed) == expected
    assert len([*folder.iterdir()]) == 1
    monkeypatch.setattr(closed_form, "time_integral", forbidden)
    kept.kept_integral.cache_clear()
    assert kept.kept_integral(speed) == expected
    with pytest.raises(AssertionError, match="made anew"):
        kept.kept_integral(derive.time_function("t*sin(4*t)"))
    kept.kept_integral.cache_clear()
    with monkeypatch.context() as patch, pytest.raises(AssertionError, match="made anew"):
        patch.setattr(kept_objects, "package_hash", lambda: "other sources")
        kept.kept_integral(speed)


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


def test_kept_libraries_are_loaded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = generated(derive.planar_beam("kept"))[1]
    with cache.no_cache():
        derive.load(files, QUICK)
    count = len([*folder.iterdir()])
    native = derive.load(files, QUICK)
    assert len([*folder.iterdir()]) == count + 1
    derive.load(files, [*QUICK, "-march=native"])
    assert len([*folder.iterdir()]) == count + 1, "another machine may use the same folder"
    monkeypatch.setattr(loading, "compile_shared", forbidden)
    again, k = derive.load(files, QUICK), native.setup()
    q = np.linspace(0.1, 0.5, native.nq)
    assert np.array_equal(again.mass(q, again.setup()), native.mass(q, k))
    for flags in ([*QUICK, "-DOTHER"], [*QUICK, "-march=native"]):
        with pytest.raises(AssertionError, match="made anew"):
            derive.load(files, flags)
    changed = [replace(file, text=f"{file.text}\n") if file.path.endswith(".h") else file for file in files]
    with pytest.raises(AssertionError, match="made anew"):
        derive.load(changed, QUICK)
    monkeypatch.setattr(loading, "compiler_identity", lambda: "another compiler")
    with pytest.raises(AssertionError, match="made anew"):
        derive.load(files, QUICK)


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


def test_bodies_of_other_numbers_have_models_of_their_own() -> None:
    """This holds also where the numbers come from one file, as those that Python has replaced, or from none."""
    block = derive.read(ROOT / "scenes/block.toml")
    assert isinstance(block, derive.NodalBody)
    block = replace(block, modes=2)
    stiff = block.data.modal_stiffness
    assert stiff is not None
    soft = replace(block, data=replace(block.data, stiffness=None, modal_stiffness=1e-4 * stiff))
    heavy = replace(block, data=replace(block.data, mass=2 * block.data.mass))
    assert len({fingerprint(body) for body in (block, soft, heavy, replace(block, data=replace(block.data)))}) == 3
    pairs = [(body, generated(body)[1]) for body in (block, soft)]
    texts = [{file.path: file.text for file in files} for _, files in pairs]
    assert texts[0]["block/block.c"] != texts[1]["block/block.c"]
    for body, text in zip((block, soft), texts, strict=True):
        assert text == {file.path: file.text for file in derive.model_files(derive.lower(derive.derive(body)), body)}


@pytest.mark.parametrize(("terms", "makings"), [(3000, 1), (20_000, 2)])
def test_deep_sums_are_kept_and_far_deeper_ones_are_made_again(terms: int, makings: int) -> None:
    """An output of a finite-element body is a sum of hundreds of terms: a RecursionError ended the command."""
    made = []

    def nested() -> object:
        made.append(True)
        result: object = Fraction(1)
        for _ in range(terms):
            result = (result,)
        return result

    for _ in range(2):
        assert kept_objects.kept_object("deep", str(terms), nested)
    assert len(made) == makings
