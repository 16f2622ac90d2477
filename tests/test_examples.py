"""Every example runs, prints something, draws its picture when asked, and returns the number that theory gives."""

from __future__ import annotations

import importlib.util
import inspect
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import ROOT

EXAMPLES = ROOT / "examples"

Check = Callable[[Any], bool]


def near(expected: object, relative: float) -> Check:
    """A check that a number, or each of several, has a value up to a relative error."""
    return lambda value: value == pytest.approx(expected, rel=relative)


def hilbert_condition(shapes: int) -> float:
    """The condition number of int xi^(i+j) dxi for i, j = 2, 3, ..."""
    i, j = np.indices((shapes, shapes)) + 2
    return float(np.linalg.cond(np.where((i + j) % 2 == 0, 1 / (i + j + 1.0), 0)))


CHECKS: dict[str, Check] = {
    "batch_of_states": lambda value: value == 0,
    "block_frequencies": lambda value: value < 1e-9,
    "block_tumbling": near(1, 1e-9),
    "call_c_from_c": near(-7.2, 1e-14),
    "free_beam_frequencies": near(2.5e-4, 0.02),  # of the Ritz method with P2 to P7
    "mean_or_point_frame": lambda value: value == (15, 5),
    "monomial_conditioning": lambda value: value == pytest.approx((hilbert_condition(10), 23 / 5), rel=1e-6),
    "parameter_sweep": near(0.5, 1e-12),
    "python_without_tisserand": near(1.6875, 1e-14),
    "runge_kutta_step_limit": lambda value: value[0] < 1e-3 and value[1] > 1e3,
    "sid_round_trip": lambda value: value == 0,
    "spin_softening": lambda value: (
        value["mean"] == pytest.approx(np.sqrt([720, 8400]), rel=1e-6)
        and value["point"] == pytest.approx(np.sqrt([720, 8400 / 6.25]), rel=1e-6)
    ),
}


def load(path: Path) -> Any:
    """The module of an example."""
    spec = importlib.util.spec_from_file_location(f"example_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_checked() -> None:
    assert sorted(CHECKS) == sorted(path.stem for path in EXAMPLES.glob("*.py"))


@pytest.mark.parametrize("name", sorted(CHECKS))
def test_example(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)  # nothing may depend on the working directory
    module = load(EXAMPLES / f"{name}.py")
    draws = bool(inspect.signature(module.main).parameters)
    value = module.main(str(tmp_path)) if draws else module.main()
    assert CHECKS[name](value), value
    assert capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ([f"{name}.svg"] if draws else [])


@pytest.mark.parametrize("name", sorted(CHECKS))
def test_example_is_short_and_imports_one_level(name: str) -> None:
    text = (EXAMPLES / f"{name}.py").read_text()
    assert 20 <= len(text.splitlines()) <= 80
    imports = [line.split() for line in text.splitlines() if line.lstrip().startswith(("import derive", "from derive"))]
    assert imports and all(words[0] == "import" and words[1].count(".") <= 1 for words in imports)


def test_an_example_is_a_script(tmp_path: Path) -> None:
    script = EXAMPLES / "mean_or_point_frame.py"
    done = subprocess.run([sys.executable, script, "."], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "5 in the mean frame" in done.stdout
    assert (tmp_path / "mean_or_point_frame.svg").exists()
