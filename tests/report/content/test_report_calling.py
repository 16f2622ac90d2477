"""The programs on a page run as they are printed, and give what the compiled model gives."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pages
import pytest
import toolchain

import derive
from derive.runtime.compiled_model import Native


def program(name: str, language: str) -> str:
    (listing,) = (one for one in pages.listings(pages.section(name, "calling")) if one.language == language)
    return "\n".join(line.text for line in listing.lines) + "\n"


def test_a_body_in_space_starts_with_a_unit_quaternion() -> None:
    assert all("q[3] = 1.0" in program("loops", language) for language in ("c", "python"))


def expected(native: Native) -> np.ndarray:
    q, v = np.zeros(native.nq), np.zeros(native.nv)
    q[7 if native.nq > native.nv else 3 :][:1] = 0.01
    v[5 if native.nq > native.nv else 2] = 3.0
    if native.nq > native.nv:
        q[3] = 1.0
    return native.accel(0.0, q, v, native.setup())


@pytest.mark.parametrize("name", ["point", "loops", "rigid"])
def test_programs_run_as_printed(name: str, tmp_path: Path) -> None:
    files = pages.built(name).files
    derive.write(files, tmp_path)
    model = pages.built(name).model.name
    folder = tmp_path / model
    (folder / "main.c").write_text(program(name, "c"))
    (folder / "main.py").write_text(program(name, "python"))
    caption = next(one.caption for one in pages.listings(pages.section(name, "calling")) if one.language == "c")
    _, command = caption.split(": ")
    assert command == f"cc main.c {model}.c -lm"
    toolchain.run(toolchain.tool("cc"), "-O0", *toolchain.C99, *command.split()[1:], cwd=folder)
    from_c = [float(x) for x in toolchain.run(folder / "a.out").split()]
    said = toolchain.run(sys.executable, folder / "main.py", cwd=folder)
    from_python = [float(x) for x in said.replace("[", " ").replace("]", " ").split()]
    found = expected(derive.load(files, ("-std=c99", "-O0")))
    assert np.allclose(from_c, found, rtol=1e-5, atol=1e-4 * np.abs(found).max())
    assert np.allclose(from_python, found, rtol=1e-5, atol=1e-4 * np.abs(found).max())
    assert len(from_c) == len(from_python) == len(found)
