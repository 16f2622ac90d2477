"""Hosts pass every warning as C99 and as C++, allocate nothing in their loop, and make a program that stands alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pendulums import FILES, LEVEL, REST, adaptive, alpha, fixed, ida
from toolchain import C99, CPP11, WARNINGS, run, tool

from derive.runtime.integrators.compilation import header_flags, program, sundials, write_sources

CPP14 = ("-x", "c++", "-std=c++14", *WARNINGS)  # headers of SUNDIALS 6 need it
ADAPTIVE = ("dormand_prince", "adaptive", "adaptive_rows", "watch")
PLAIN = [
    *((host, ()) for host in ("fixed_step", "rotations", *ADAPTIVE, "simulate")),
    ("simulate", ("-DTISSERAND_IDA", "-DTISSERAND_ALPHA")),
]


@pytest.mark.parametrize("language", [("gcc", *C99), ("g++", *CPP11), ("clang", *C99)], ids=["C", "C++", "clang"])
@pytest.mark.parametrize(("host", "flags"), PLAIN)
def test_no_warnings(host: str, flags: tuple[str, ...], language: tuple[str, ...], tmp_path: Path) -> None:
    name, _ = write_sources(
        FILES, ["fixed_step", *ADAPTIVE, "rotations", "generalised_alpha", "ida", "simulate"], tmp_path
    )
    flags = (*flags, *header_flags(name, tmp_path), f"-DTISSERAND_MODEL={name}_model")
    run(tool(language[0]), *language[1:], "-O2", *flags, "-c", tmp_path / f"{host}.c", "-o", tmp_path / "host.o")


@pytest.mark.parametrize("language", [("gcc", *C99), ("g++", *CPP14), ("clang", *C99)], ids=["C", "C++", "clang"])
@pytest.mark.parametrize("host", ["ida", "generalised_alpha"])
def test_no_warnings_with_libraries(host: str, language: tuple[str, ...], tmp_path: Path) -> None:
    ida()
    name, _ = write_sources(FILES, ["fixed_step", "rotations", host], tmp_path)
    flags = (*sundials()[0], *header_flags(name, tmp_path))
    run(tool(language[0]), *language[1:], "-O2", *flags, "-c", tmp_path / f"{host}.c", "-o", tmp_path / "host.o")


def test_hosts_without_libraries_call_nothing_but_mathematics(tmp_path: Path) -> None:
    name, paths = write_sources(FILES, ["fixed_step", *ADAPTIVE], tmp_path)
    run(tool("gcc"), "-O2", *header_flags(name, tmp_path), "-r", "-nostdlib", *paths[1:], "-o", tmp_path / "host.o")
    symbols = [line.split() for line in run(tool("nm"), tmp_path / "host.o").splitlines()]
    assert {symbol[-1] for symbol in symbols if symbol[-2] == "U"} <= {"memcpy", "memset", "sqrt", "nextafter"}
    assert all(symbol[-1].startswith("tisserand_") for symbol in symbols if symbol[-2] == "T")
    assert not [symbol for symbol in symbols if symbol[-2] in "BDbd"]  # no state of its own


@pytest.fixture(scope="module")
def explicit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program with the one method that needs no library."""
    return program(FILES, tmp_path_factory.mktemp("program") / "pendulum")


def start(folder: Path) -> Path:
    path = folder / "start.txt"
    path.write_text(" ".join(str(x) for x in [*LEVEL, *REST]))
    return path


def test_program_writes_what_the_library_computes(explicit: Path, tmp_path: Path) -> None:
    run(explicit, "rk4", start(tmp_path), "1", "0.1", "1e-2", tmp_path / "out.csv")
    run(explicit, "rk4", start(tmp_path), "1", "0.1", "1e-2", tmp_path / "out.bin")
    names = (tmp_path / "out.csv").read_text().splitlines()[0]
    assert names == "t,x,y,phi,x_dot,y_dot,phi_dot,pivot_1,pivot_2"
    rows = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows, np.fromfile(tmp_path / "out.bin").reshape(11, 9))
    found = fixed().run(LEVEL, REST, step=1e-2, steps=100, every=10)
    assert rows[:, 0] == pytest.approx(found.t)
    assert rows[:, 1:] == pytest.approx(np.hstack([found.q, found.v, found.lam]), rel=1e-13, abs=1e-13)


def test_program_with_adaptive_steps(explicit: Path, tmp_path: Path) -> None:
    run(explicit, "adaptive", start(tmp_path), "1", "0.1", "1e-8", tmp_path / "out.bin")
    rows = np.fromfile(tmp_path / "out.bin").reshape(11, 9)
    found = adaptive().run(LEVEL, REST, 0.1 * np.arange(11), rtol=1e-8)
    assert np.array_equal(rows[:, 0], found.t)
    assert np.array_equal(rows[:, 1:], np.hstack([found.q, found.v, found.lam]))


def test_program_with_ida(tmp_path: Path) -> None:
    found = ida().run(LEVEL, REST, interval=0.1, rows=11, rtol=1e-8)
    made = program(FILES, tmp_path / "pendulum", ["ida"])
    run(made, "ggl", start(tmp_path), "1", "0.1", "1e-8", tmp_path / "out.bin")
    rows = np.fromfile(tmp_path / "out.bin").reshape(11, 9)
    assert np.array_equal(rows[:, 1:], np.hstack([found.q, found.v, found.lam]))


@pytest.mark.long
def test_program_with_generalised_alpha(tmp_path: Path) -> None:
    found = alpha().run(LEVEL, REST, step=1e-2, steps=100, every=10)
    made = program(FILES, tmp_path / "pendulum", ["alpha"])
    run(made, "alpha", start(tmp_path), "1", "0.1", "1e-2", tmp_path / "out.bin")
    rows = np.fromfile(tmp_path / "out.bin").reshape(11, 9)
    assert rows[:, 1:] == pytest.approx(np.hstack([found.q, found.v, found.lam]), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "usage: "),
        (("rk4", "nowhere.txt", "1", "0.1", "1e-2", "-"), "nowhere.txt: No such file"),
        (("rk4", "short.txt", "1", "0.1", "1e-2", "-"), "short.txt: 6 numbers are needed: q, then v"),
        (("ggl", "-", "1", "0.1", "1e-2", "-"), "pendulum: ggl failed with code 4"),
        (("rk4", "-", "1", "0", "1e-2", "-"), "usage: "),
    ],
)
def test_program_says_what_is_wrong(arguments: tuple[str, ...], message: str, explicit: Path, tmp_path: Path) -> None:
    (tmp_path / "short.txt").write_text("1 2 3")
    with pytest.raises(AssertionError, match=message):
        run(explicit, *arguments, cwd=tmp_path)


@pytest.mark.long
def test_program_is_clean_under_valgrind(tmp_path: Path) -> None:
    ida()
    made = program(FILES, tmp_path / "pendulum", ["ida", "alpha"], flags=["-g"])
    flags = ("--quiet", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=all")
    for method in ("adaptive", "rk4", "ggl", "index1", "alpha"):
        run(tool("valgrind"), *flags, made, method, start(tmp_path), "0.2", "0.1", "1e-4", tmp_path / "out.csv")
