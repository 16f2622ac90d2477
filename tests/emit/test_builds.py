"""Header, source file, descriptor and Python module of a build belong together, and compilers notice what does not."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from toolchain import C99, run, scene, text_of, tool, written

import beams
import derive
from derive.runtime.integrators.compilation import header_flags, klu, sundials, write_sources


def compiling(source: Path, *flags: str) -> None:
    run(tool("gcc"), *C99, *flags, "-fsyntax-only", source)


def test_all_files_of_a_build_have_its_hash() -> None:
    made = beams.made("point", 2)
    (build,) = re.findall(r'#define BEAM_POINT_2_HASH "(\w{16})"', text_of(made, ".h"))
    assert beams.native("point", 2).hash == build
    assert f"#ifndef BEAM_POINT_2_HASH_{build}\n" in text_of(made, ".c")
    assert f'\nHASH = "{build}"\n' in text_of(made, ".py")
    other = beams.build(beams.beam("point", 2, mass={"symbol": "m", "unit": "kg", "default": 1.4}))
    assert build not in text_of(other, ".h")


def test_a_header_and_a_source_of_different_builds_do_not_compile(tmp_path: Path) -> None:
    """A process that was killed while it wrote leaves such files."""
    (source,) = written(beams.made("point", 2).files, tmp_path)
    compiling(source)
    header = text_of(beams.build(beams.beam("point", 2, length="1/2")), ".h")
    source.with_suffix(".h").write_text(header)
    with pytest.raises(AssertionError, match=r"beam_point_2\.h and beam_point_2\.c are of different builds"):
        compiling(source)


def test_python_of_another_build_refuses_constants() -> None:
    """Constants of the same build and those without a mark are accepted."""
    made = beams.made("point", 2)
    other = beams.build(beams.beam("point", 2, mass={"symbol": "m", "unit": "kg", "default": 1.4}))
    k, q = beams.native("point", 2).setup(), np.full(5, 0.1)
    same, strange = beams.run_module(made.files), beams.run_module(other.files)
    assert np.array_equal(same["mass"](q, k), same["mass"](q, np.array(k)))
    with pytest.raises(ValueError, match=r"^k: the constants come from .* call setup of this beam_point_2\.py$"):
        strange["mass"](q, k)
    assert np.array_equal(strange["mass"](q, np.array(k)), same["mass"](q, k))


FAST = ["-ffast-math", "-Ofast", "-ffinite-math-only"]


@pytest.mark.parametrize("flag", FAST)
def test_fast_mathematics_are_refused_unless_a_macro_permits_them(flag: str, tmp_path: Path) -> None:
    """Fast mathematics would remove the checks: a NaN would come back with code 0."""
    (source,) = written(beams.made("point", 2).files, tmp_path)
    with pytest.raises(AssertionError, match=r"remove the run-time checks; .* define TISSERAND_ALLOW_FAST_MATH"):
        compiling(source, flag)
    compiling(source, flag, "-DTISSERAND_ALLOW_FAST_MATH")


def test_fast_mathematics_are_refused_by_integrators(tmp_path: Path) -> None:
    hosts = {"fixed_step": (), "ida": sundials()[0], "generalised_alpha": klu()[0]}
    name, _ = write_sources(scene("four_bar").files, ["rotations", *hosts], tmp_path)
    for host, flags in hosts.items():
        given = (*flags, *header_flags(name, tmp_path))
        with pytest.raises(AssertionError, match="remove the run-time checks"):
            compiling(tmp_path / f"{host}.c", "-ffast-math", *given)
        compiling(tmp_path / f"{host}.c", "-ffast-math", "-DTISSERAND_ALLOW_FAST_MATH", *given)


def test_indices_of_coordinates_and_velocities() -> None:
    """Coordinates of a scene have the names of their bodies; in loops, an array has its first index."""
    header = text_of(scene("double_pendulum"), ".h")
    for index, body in enumerate(("upper", "lower")):
        assert f"    DOUBLE_PENDULUM_Q_{body}_phi = {5 * index + 2},\n" in header
        assert f"    DOUBLE_PENDULUM_V_{body}_alpha2dot = {5 * index + 4},\n" in header
    loops = beams.build(derive.symbolic_body("looped", 9, frame="given", lowering="loops"))
    assert "    LOOPED_Q_alpha = 7,\n" in text_of(loops, ".h") and "    LOOPED_V_alphadot = 6,\n" in text_of(
        loops, ".h"
    )


def test_constants_have_names_that_say_what_they_are() -> None:
    """The enum of the header names constants, where `constant_1` would have no meaning."""
    header = text_of(beams.made("point", 2), ".h")
    assert "BEAM_POINT_2_K_coupling_alpha2 = " in header
    assert "coupling_alpha2  acceleration of alpha2 due to that of phi\n" in header
    assert "BEAM_POINT_2_K_minus_c2_1_2 = " in header and "minus_c2_1_2  -c2_1_2\n" in header
    assert "_K_constant_" not in header
