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

import derive
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
    "andrews_squeezer": near(  # IVP Test Set; nine digits
        {
            "beta": 15.81077119629904,
            "gamma": 0.04082224013073101,
            "delta": 0.5244099658805304,
            "epsilon": 1.048080741042263,
        },
        5e-10,
    ),
    "batch_of_states": lambda value: value == 0,
    "block_frequencies": lambda value: value < 1e-9,
    "block_tumbling": near(1, 1e-9),
    "call_c_from_c": near(-7.2, 1e-14),
    "cantilever_modes": near((1.8751041, 1), 1e-5),
    "crank_slider_beams": near([0.206, 0.030], 0.015),  # an independent prototype
    "crank_slider_frames": lambda value: (  # an independent prototype
        [count for count, _ in value.values()] == [6, 16]
        and [y for _, y in value.values()] == pytest.approx([0.0142043, 0.0142163], abs=6e-8)
    ),
    "damped_oscillator": lambda value: value < 1e-9,
    "dense_and_sparse": lambda value: value < 1e-10,
    "dop853_or_ida": lambda value: 0 < value < 1e-4,
    "double_pendulum_energy": lambda value: value < 1e-8,
    "equations_of_motion": lambda value: value == {"point": [64, 192], "mean": [144, 1200]},  # (33), (41)
    "force_of_my_own": near(1, 1e-8),
    "four_bar_rigid": lambda value: value < 1e-9,
    "free_beam_frequencies": near(2.5e-4, 0.02),  # of the Ritz method with P2 to P7
    "from_scikit_fem": lambda value: value < 2e-3,
    "gravity_pendulum": near(1, 1e-9),
    "jax_identification": near([1, 1], 1e-3),
    "joint_of_my_own": near(1, 1e-8),
    "mean_or_point_frame": lambda value: value == (15, 5),
    "monomial_conditioning": lambda value: value == pytest.approx((hilbert_condition(10), 23 / 5), rel=1e-6),
    "motor_run_up": lambda value: value[0] == 2.5 and value[1] == pytest.approx(1, abs=5e-3),
    "optimal_slewing": lambda value: min(value[0]) > 0.05 and value[1][0] < 5e-3 and value[1][1] < 5e-4,
    "parameter_sweep": near(0.5, 1e-12),
    "pendulum_reaction": near(2.5, 1e-6),
    "python_without_tisserand": near(1.6875, 1e-14),
    "runge_kutta_step_limit": lambda value: value[0] < 1e-3 and value[1] > 1e3,
    "screw_jack": lambda value: value < 1e-8,
    "sid_round_trip": lambda value: value == 0,
    "slider_crank_rigid": lambda value: value < 1e-9,
    "spinning_solid_beam": lambda value: (  # converged values of a planar beam, and omega^2 - spin^2 as in (41)
        np.sqrt(value[2]) == pytest.approx([36.294, 61.212], rel=2e-4)
        and np.diff(value[1])[0] == pytest.approx(20**2 - 40**2, rel=1e-4)
        and value[1][1] < 0
    ),
    "spin_softening": lambda value: (
        value["mean"] == pytest.approx(np.sqrt([720, 8400]), rel=1e-6)
        and value["point"] == pytest.approx(np.sqrt([720, 8400 / 6.25]), rel=1e-6)
    ),
    "spun_up_cantilever": lambda value: (
        value[0] == pytest.approx(3.5160, rel=5e-4) and value[1] == pytest.approx(1, abs=0.01) and value[2] > 10
    ),
    "static_equilibrium": near(1, 1e-5),
    "stiffness_from_motion": near(1, 2e-3),
    "symbolic_body": lambda value: value < 1e-9,
}

PACKAGES = {"jax_identification": "jax"}
"""The packages that examples need beside Tisserand and its dependencies."""


SLOW = {
    "andrews_squeezer",
    "batch_of_states",
    "block_tumbling",
    "crank_slider_frames",
    "double_pendulum_energy",
    "free_beam_frequencies",
    "from_scikit_fem",
    "screw_jack",
    "stiffness_from_motion",
    "crank_slider_beams",
    "dense_and_sparse",
    "monomial_conditioning",
    "optimal_slewing",
    "spin_softening",
    "spinning_solid_beam",
    "spun_up_cantilever",
    "static_equilibrium",
    "symbolic_body",
}
"""Examples of a second and more, whose functions and figures other tests have as well."""


def load(path: Path) -> Any:
    """The module of an example."""
    spec = importlib.util.spec_from_file_location(f"example_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_checked() -> None:
    assert sorted(CHECKS) == sorted(path.stem for path in EXAMPLES.glob("*.py"))


INDEX = """\
# Examples

[double_pendulum.c](double_pendulum.c) simulates a scene in C. [chain_100.toml](chain_100.toml) and
[chain_1000.toml](chain_1000.toml) are chains of 100 and 1000 flexible beams, each in one table with a `count`;
[four_bars.toml](four_bars.toml) has forty linkages that pass positions in which all of their rods lie in one line.
[spatial_crank_slider.toml](spatial_crank_slider.toml) is a mechanism in space with a finite-element rod, which
[make_spatial_rod.py](../scenes/make_spatial_rod.py) makes, and
[spatial_crank_slider_rigid.toml](spatial_crank_slider_rigid.toml) one of rigid bodies, and
[spatial_crank_slider_beam.toml](spatial_crank_slider_beam.toml) one with a rod that is a beam in space;
[bracket_crank.toml](bracket_crank.toml) has a crank that CalculiX has computed, from the mesh of
[make_bracket.py](../scenes/make_bracket.py);
[rotating_blade.toml](rotating_blade.toml) is a beam in space whose rotation stiffens it,
[spun_up_blade.toml](spun_up_blade.toml) one that gravity bends while its hub is spun up, and
[whirling_shaft.toml](whirling_shaft.toml) one that its own damping makes unstable above a speed.

Each script prints a number that a test compares with theory, a published value or an independent computation. Run it
with `.venv/bin/python examples/NAME.py`. Scripts that draw a picture take a folder for it as an argument.

| script | shows | picture |
|---|---|---|
"""


def test_index_of_the_examples(compare_or_update: Callable[[Path, str], None]) -> None:
    rows = []
    for path in sorted(EXAMPLES.glob("*.py")):
        module = load(path)
        title = module.__doc__.splitlines()[0].removesuffix(".")
        picture = "yes" if inspect.signature(module.main).parameters else ""
        rows.append(f"| [{path.stem}]({path.name}) | {title} | {picture} |\n")
    compare_or_update(EXAMPLES / "README.md", INDEX + "".join(rows))


def marked(name: str) -> Any:
    """The parameter of an example: a few of those that take longest are run by `make test-long`."""
    mark = pytest.mark.hosts if name in PACKAGES else pytest.mark.long if name in SLOW else ()
    return pytest.param(name, marks=mark)


@pytest.mark.parametrize("name", [marked(name) for name in sorted(CHECKS)])
def test_example(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if name in PACKAGES:
        pytest.importorskip(PACKAGES[name])
    monkeypatch.chdir(tmp_path)  # nothing may depend on the working directory
    module = load(EXAMPLES / f"{name}.py")
    registered = [(registry, {*registry}) for registry in (derive.JOINTS, derive.BODIES, derive.FORCES)]
    draws = bool(inspect.signature(module.main).parameters)
    value = module.main(str(tmp_path)) if draws else module.main()
    for registry, known in registered:  # other tests count what is registered
        for kind in {*registry} - known:
            registry.unregister(kind)
    assert CHECKS[name](value), value
    assert capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ([f"{name}.svg"] if draws else [])


@pytest.mark.parametrize("name", sorted(CHECKS))
def test_example_is_short_and_imports_one_level(name: str) -> None:
    text = (EXAMPLES / f"{name}.py").read_text()
    assert 20 <= len(text.splitlines()) <= 100
    imports = [line.split() for line in text.splitlines() if line.lstrip().startswith(("import derive", "from derive"))]
    assert imports and all(words[0] == "import" and words[1].count(".") <= 1 for words in imports)


def test_an_example_is_a_script(tmp_path: Path) -> None:
    script = EXAMPLES / "mean_or_point_frame.py"
    done = subprocess.run([sys.executable, script, "."], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "5 in the mean frame" in done.stdout
    assert (tmp_path / "mean_or_point_frame.svg").exists()
