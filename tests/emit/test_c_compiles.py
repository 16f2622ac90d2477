"""Generated C passes every warning as C99 and as C++, and defines nothing but functions and constants of its prefix."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from toolchain import C99, CPP11, EVERY_MODEL, MODELS, OTHERS, WARNINGS, run, run_together, special, tool, written

import beams
from derive.backends.c.source import ABI
from derive.ir.model import Model

# Relocations would put constant pointers among writable data, which says nothing of the code.
FIXED = ("-fno-pic", "-fno-pie", "-c")


@dataclass(frozen=True)
class Compiled:
    """A model and its object files."""

    model: Model
    header: str
    objects: tuple[Path, ...]


IN_ALL_WAYS, *_ = OPTIMISED = ("mean_2", "mean_3_loops", *OTHERS)
"""The models that are compiled at the highest level, and as C++ by clang, as well: a body, loops, and those that take
longer.

The first one, which is small, is compiled at every level, and to an object as C++.
"""

WARNED = ("given_2_flat", "rigid_loops", "folded_point")
"""Further models for which gcc looks for values that may be missing, which it does where it optimises."""


@pytest.fixture(scope="module", params=EVERY_MODEL)
def compiled(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Compiled:
    """Compiled with all warnings as errors: what does not pass them fails here."""
    made = MODELS[request.param]()
    folder = tmp_path_factory.mktemp(request.param)
    (source,) = written(made.files, folder)
    gcc, cpp = tool("gcc"), tool("g++")
    levels = ("O3",) if request.param in OPTIMISED else ("O1",) if request.param in WARNED else ("O0",)
    if request.param == IN_ALL_WAYS:
        levels = ("O0", "O1", "O2", "O3")
    ways = {level: [gcc, *C99, f"-{level}"] for level in levels}
    if request.param == IN_ALL_WAYS:
        ways["cpp"] = [cpp, *CPP11, "-O1"]
    commands = [[*command, *FIXED, source, "-o", folder / f"{way}.o"] for way, command in ways.items()]
    checks = [[cpp, *CPP11], [tool("clang"), *C99]]
    checks += [[tool("clang"), *CPP11]] if request.param in OPTIMISED else []
    commands += [[*command, "-fsyntax-only", source] for command in checks]
    run_together(commands)
    header = source.with_suffix(".h").read_text()
    return Compiled(made.model, header, tuple(folder / f"{way}.o" for way in ways))


def symbols(path: Path) -> list[tuple[str, str]]:
    """(kind, name) of each symbol."""
    return [(line.split()[-2], line.split()[-1]) for line in run(tool("nm"), path).splitlines()]


def test_global_symbols_are_those_that_the_header_declares(compiled: Compiled) -> None:
    """All kernels, the defaults, an accessor for each pattern, and the descriptor; all with the prefix of the model."""
    model = compiled.model
    declared = set(re.findall(rf"^[\w *]+\b({model.name}_\w+)\(", compiled.header, re.MULTILINE))
    assert {f"{model.name}_{kernel.name}" for kernel in model.kernels} | {f"{model.name}_model"} <= declared
    patterns = 2 + len(model.markers) + (3 if model.bodies else 0)  # G, and the Jacobians of two more forms
    batches = {name for name in declared if name.endswith("_batch")}
    assert len(declared - batches) == len(model.kernels) + patterns + 2
    for path in compiled.objects:
        assert {name for kind, name in symbols(path) if kind.isupper() and kind != "U"} == declared


NEEDED = {
    # Sines of angles beyond 1e5, and compilers make calls of the last three out of loops by themselves.
    "flat": {"sin", "cos", "sincos", "sqrt", "memset", "memcpy", "memmove"},
    "loops": {"sqrt", "memset", "memcpy", "memmove"},  # the square roots of a Cholesky factor
}


def test_needs_functions_of_mathematics_alone(compiled: Compiled) -> None:
    for path in compiled.objects:
        assert {name for kind, name in symbols(path) if kind == "U"} <= NEEDED[compiled.model.lowering]


def test_has_no_writable_data(compiled: Compiled) -> None:
    for path in compiled.objects:
        assert {kind for kind, _ in symbols(path)} <= set("TtRrU")
        rows = [line.split() for line in run(tool("size"), "-A", path).splitlines() if line.startswith(".")]
        sizes = {row[0]: int(row[1]) for row in rows}
        assert sizes[".text"] > 0
        writable = {s: n for s, n in sizes.items() if s.startswith((".data", ".bss", ".tdata", ".tbss")) and n}
        assert writable == {}


@pytest.mark.long
def test_a_mechanism_passes_all_warnings_at_the_highest_level(tmp_path: Path) -> None:
    (source,) = written(MODELS["crank_slider_3"]().files, tmp_path)
    run(tool("gcc"), *C99, "-O3", "-c", source, "-o", tmp_path / "O3.o")


@pytest.mark.parametrize("standard", ["c99", "gnu99", "c11", "c17", "c2x", "c++11", "c++14", "c++17", "c++20"])
def test_compiles_under_newer_standards(standard: str, tmp_path: Path) -> None:
    language = ("g++", "-x", "c++") if "++" in standard else ("gcc",)
    for made in (beams.made("point", 2), special("folded_no_markers")):
        (source,) = written(made.files, tmp_path)
        run(tool(language[0]), *language[1:], f"-std={standard}", *WARNINGS, "-fsyntax-only", source)


@pytest.mark.parametrize("language", [("gcc", *C99), ("g++", *CPP11)], ids=["C", "C++"])
def test_header_stands_alone(language: tuple[str, ...], tmp_path: Path) -> None:
    """The header needs no other before it, and may be included twice."""
    (source,) = written(beams.made("mean", 2).files, tmp_path)
    user = tmp_path / "user.c"
    user.write_text(f'#include "{source.with_suffix(".h")}"\n' * 2 + "int only(void);\nint only(void) { return 0; }\n")
    run(tool(language[0]), *language[1:], "-fsyntax-only", user)


def test_a_model_of_many_shapes_compiles(tmp_path: Path) -> None:
    """C99 promises string literals of 4095 characters; the files stay of a size that can be read."""
    made = beams.made("point", 12)
    (source,) = written(made.files, tmp_path)
    run(tool("gcc"), *C99, "-fsyntax-only", source)
    assert sum(len(file.text) for file in made.files) < 545_000


def test_headers_of_different_interfaces_refuse_each_other(tmp_path: Path) -> None:
    headers = []
    for frame in ("mean", "point"):
        (source,) = written(beams.made(frame, 2).files, tmp_path)
        headers.append(source.with_suffix(".h"))
    old = headers[1].read_text()
    guard = f"TISSERAND_ABI != {ABI}"
    assert guard in old
    headers[1].write_text(old.replace(guard, f"TISSERAND_ABI != {ABI + 1}"))
    user = tmp_path / "user.c"
    user.write_text("".join(f'#include "{header}"\n' for header in headers))
    with pytest.raises(AssertionError, match="generated by incompatible versions of Tisserand"):
        run(tool("gcc"), *C99, "-fsyntax-only", user)


@pytest.mark.parametrize("other", ["left_pattern", "left_colptr", "left_rowidx", "left_sparsity"])
def test_names_of_markers_do_not_meet_other_names(other: str, tmp_path: Path) -> None:
    made = beams.build(beams.beam("mean", 2, markers={"left": -1, other: 1}))
    (source,) = written(made.files, tmp_path)
    run(tool("gcc"), *C99, "-fsyntax-only", source)
