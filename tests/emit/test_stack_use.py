"""The stack that the manifest states for each function is enough for gcc and clang."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from toolchain import MODELS, run, text_of, tool, written


@pytest.mark.parametrize(
    ("name", "command"),
    [
        *((name, ("gcc", "-O0")) for name in ("mean_2", "mean_3_loops", "given_2_flat")),
        *((name, ("clang", "-O3")) for name in ("mean_2", "mean_3_loops")),
        pytest.param("given_2_flat", ("clang", "-O3"), marks=pytest.mark.long),
        *(pytest.param("given_13_loops", one, marks=pytest.mark.long) for one in (("gcc", "-O0"), ("clang", "-O3"))),
    ],
)
def test_functions_take_no_more_than_is_stated(name: str, command: tuple[str, str], tmp_path: Path) -> None:
    """tests/hosts has more levels of optimisation, models, and a processor with 32 bits."""
    made = MODELS[name]()
    (source,) = written(made.files, tmp_path)
    compiler, level = command
    run(tool(compiler), "-std=c99", level, "-ffp-contract=off", "-fstack-usage", "-c", source, cwd=tmp_path)
    lines = [line.split("\t") for line in (tmp_path / f"{source.stem}.su").read_text().splitlines()]
    taken = {line[0].split(":")[-1]: int(line[1]) for line in lines}
    stated = json.loads(text_of(made, "manifest.json"))["stack_bytes"]
    assert stated.keys() == {kernel.name for kernel in made.model.kernels}
    for kernel, limit in stated.items():
        assert taken[f"{made.model.name}_{kernel}"] <= limit, kernel
