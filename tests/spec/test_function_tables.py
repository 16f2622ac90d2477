"""Parameters and tables that functions of time refer to: what is read, and what is refused with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from derive.errors import SpecError
from derive.spec.checks.known_functions import MAX_ROWS
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import Scene
from derive.spec.model.scene_functions import splines, time_functions
from derive.spec.toml.read import read

SCENE = """name = "s"
[parameters]
F0 = { default = 2, unit = "N" }
[tables]
load = { file = "load.csv", x = "t", y = "F" }
[bodies.puck]
mass = { symbol = "m", default = 3 }
inertia = 1
markers = { o = [0, 0] }
[forces.f]
at = "puck.o"
components = ["m*F0*load(2*t)", 0]
[simulation]
duration = 2
output = 0.1
"""

CURVE = "t,F\n0,1\n1,3\n4,2\n"


def scene(folder: Path, text: str = SCENE, curve: str = CURVE) -> Scene:
    (folder / "load.csv").write_text(curve)
    (folder / "s.toml").write_text(text)
    result = read(folder / "s.toml")
    assert isinstance(result, Scene)
    return result


def problem(folder: Path, text: str = SCENE, curve: str = CURVE) -> str:
    with pytest.raises(SpecError) as caught:
        scene(folder, text, curve)
    return "\n".join(f"{p.path}: {p.message}" for p in caught.value.problems)


def test_functions_hold_their_parameters_and_tables(tmp_path: Path) -> None:
    found = scene(tmp_path)
    (spline,) = splines(function for _, function in time_functions(found))
    assert (spline.name, spline.knots, [spline(x) for x in spline.knots]) == ("load", (0, 1, 4), [1, 3, 2])
    (function, _) = (f for _, f in time_functions(found))
    product = function.args[0]
    assert product.args[0].parameter == Parameter("m", "kg", 3.0)
    assert product.args[1].parameter == Parameter("F0", "N", 2.0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("F0*load", "F1*load", 'the name "F1" is unknown'),
        ("load(2*t)", "laod(t)", 'the function "laod" is unknown; did you mean "load"'),
        ("load(2*t)", "load(sin(t))", "its argument is made of t, numbers and parameters with + - * /"),
        ("F0*load", "load", "parameters.F0: no function of time uses it; leave it out"),
        ("*load(2*t)", "", "tables.load: no function of time uses it; leave it out"),
        ("F0 = { default = 2,", "t = { default = 2,", '"t" is taken: functions of time know it already'),
        ("load = {", "step = {", '"step" is taken: functions of time know it already'),
        ("load = {", "F0 = {", '"F0" is taken: it is a parameter'),
        ("default = 2,", "", "parameters.F0.default: this key is missing; write default = 0.1"),
        ('"load.csv"', '"lode.csv"', 'the file "lode.csv" cannot be read'),
        ('y = "F"', 'y = "G"', '"load.csv" has no column "G"'),
        (', y = "F"', "", "tables.load.y: this key is missing"),
        ("default = 3", 'default = 3, unit = "t"', ""),
        ("2*t", "t", ""),
        ("F0 = {", "M = { default = 1 }\nF0 = {", '"M" is taken: "m" is the symbol of mass of the body puck'),
    ],
)
def test_what_is_wrong_is_reported(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in SCENE
    if message:
        assert message in problem(tmp_path, SCENE.replace(old, new))
    else:
        scene(tmp_path, SCENE.replace(old, new))


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        ("t,F\n0,1\n1,3\n1,2\n", "the arguments of the table increase from row to row, and 1 comes after 1"),
        ("t,F\n0,1\n1,x\n", 'line 3 of "load.csv"'),
        ("t,F\n" + "".join(f"{k},0\n" for k in range(MAX_ROWS + 1)), f"has {MAX_ROWS + 1} rows; at most {MAX_ROWS}"),
    ],
)
def test_a_table_that_is_none_is_refused(tmp_path: Path, curve: str, message: str) -> None:
    assert message in problem(tmp_path, curve=curve)


def test_a_table_of_the_largest_size_is_read(tmp_path: Path) -> None:
    curve = "t,F\n" + "".join(f"{k},{k % 7}\n" for k in range(MAX_ROWS))
    (spline,) = splines(function for _, function in time_functions(scene(tmp_path, curve=curve)))
    assert len(spline.knots) == MAX_ROWS


def test_a_simulation_stays_within_its_tables(tmp_path: Path) -> None:
    text = SCENE.replace("2*t", "t").replace("duration = 2", "duration = 4.5")
    message = (
        "the table load goes from t = 0 to 4, and the simulation from 0 to 4.5; add rows, or simulate a shorter time"
    )
    assert message in problem(tmp_path, text)
    scene(tmp_path, text.replace("4.5", "4"))


@pytest.mark.parametrize(
    ("rows", "text"),
    [
        ("0,1e308\n1,-1e308\n2,1e308", 'tables.load.file: line 2 of "load.csv": "1e308" is too large; numbers are at'),
        ("-2e60,0\n1,1", 'tables.load.file: line 2 of "load.csv": "-2e60" is too large; numbers are at most 1e+60'),
        ("0,1\n1e-300,2\n4,3\n5,4", "its closest arguments are 0 and 1e-300: take rows that are further apart"),
        ("0,1e60\n1e-160,2\n4,3\n5,4", "its closest arguments are 0 and 1e-160: take rows that are further apart"),
    ],
)
def test_tables_whose_splines_are_no_doubles_are_refused(tmp_path: Path, rows: str, text: str) -> None:
    """Such splines would be code with NaN in it."""
    assert text in problem(tmp_path, curve=f"t,F\n{rows}\n")
