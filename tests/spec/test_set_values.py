"""`--set NAME=VALUE`: parameters, numbers that become parameters, other values, and names that are unknown."""

from __future__ import annotations

from fractions import Fraction

import pytest

import derive
from conftest import ROOT
from derive.spec.model.scene_functions import function_parameters
from derive.spec.set_values import with_values

SLIDER = derive.read(ROOT / "scenes/crank_slider_3.toml")
SPINNING = derive.read(ROOT / "scenes/spinning_beam.toml")


def test_a_symbol_gets_another_default() -> None:
    spec, changes = with_values(SPINNING, {"EI": "30"})
    assert spec.bodies[0].beam.bending_stiffness == derive.Parameter("EI", "N m^2", 30.0)
    assert [str(change) for change in changes] == ["bodies.beam.bending_stiffness: 1 N m^2 -> 30, the parameter EI"]
    assert spec.bodies[0].beam.mass == SPINNING.bodies[0].beam.mass and spec.forces == SPINNING.forces


def test_a_symbol_is_changed_wherever_it_is_written() -> None:
    mass = derive.Parameter("m", "kg", 2.0)
    bodies = {name: derive.RigidBody(name, mass, Fraction(1)) for name in ("a", "b")}
    spec, changes = with_values(derive.scene("two", bodies=tuple(bodies.values())), {"m": "3.5"})
    assert [body.mass.default for body in spec.bodies] == [3.5, 3.5]
    assert [change.key for change in changes] == ["bodies.a.mass", "bodies.b.mass"]


def test_a_number_that_may_be_a_parameter_becomes_one() -> None:
    """The model is the same for all values: the symbol is made of the key, or of a name that is free."""
    spec, changes = with_values(SLIDER, {"bodies.rod.bending_stiffness": "30", "drives.motor.speed": "100"})
    assert spec.bodies[1].beam.bending_stiffness == derive.Parameter("rod_bending_stiffness", "N m^2", 30.0)
    assert spec.drives[0].speed == derive.Parameter("motor_speed_value", "rad/s", 100.0)
    assert str(changes[0]) == "bodies.rod.bending_stiffness: 12.7234502 -> 30, the parameter rod_bending_stiffness"
    other, _ = with_values(SLIDER, {"bodies.rod.bending_stiffness": "7", "drives.motor.speed": "9"})
    kernels = [derive.lower(derive.derive(each)).kernels for each in (spec, other)]
    assert kernels[0] == kernels[1]


def test_other_values_are_replaced_exactly() -> None:
    names = {
        "simulation.tolerance": "1e-7",
        "bodies.rod.pieces": "2",
        "bodies.rod.start.position[0]": "0.25",
        "bodies.rod.markers.middle": "0.1",
        "joints.guide.kind": "translational",
    }
    spec, changes = with_values(SLIDER, names)
    assert spec.simulation.tolerance == 1e-7
    rod = spec.bodies[1]
    assert rod.pieces == 2 and rod.start.position == (0.25, 0.0)
    assert next(m.at for m in rod.beam.markers if m.name == "middle") == Fraction(1, 10)  # not the float next to it
    assert [change.symbol for change in changes] == [None] * 5
    assert spec.plots == SLIDER.plots  # with the numbers of their references


@pytest.mark.parametrize(
    ("key", "value", "change"),
    [
        ("ansatz", '["1", "xi", "xi^2"]', "[1, xi, xi^2, xi^3] -> [1, xi, xi^2]"),
        ("ansatz[3]", '"xi^3 - xi/2"', "xi^3 -> xi^3 - xi/2"),
        ("ansatz", '{ kind = "free-free", count = 2 }', "[1, xi, xi^2, xi^3] -> { kind = free-free, count = 2 }"),
    ],
)
def test_shapes_are_polynomials_or_a_family(key: str, value: str, change: str) -> None:
    _, changes = with_values(SPINNING, {f"bodies.beam.{key}": value})
    assert [str(change) for change in changes] == [f"bodies.beam.{key}: {change}"]


def test_single_bodies() -> None:
    beam, _ = with_values(derive.read(ROOT / "scenes/free_beam_mean.toml"), {"l": "2", "beam.frame.kind": "point"})
    assert beam.length.default == 2.0 and beam.frame.kind == "point"
    block, changes = with_values(derive.read(ROOT / "scenes/block.toml"), {"body.modes": "3"})
    assert block.modes == 3 and str(changes[0]) == "body.modes: 8 -> 3"


def test_keys_that_are_left_out_are_added() -> None:
    beam, changes = with_values(derive.read(ROOT / "scenes/free_beam_mean.toml"), {"beam.start.spin": "2"})
    assert beam.start.spin == 2.0 and str(changes[0]) == "beam.start.spin: not given -> 2"
    with pytest.raises(derive.SpecError, match=r'--set: beam.start.spn: unknown key; did you mean "spin"\?'):
        with_values(beam, {"beam.start.spn": "2"})


RAMP = derive.scene(
    "ramp",
    ground={"o": (0, 0)},
    bodies={"arm": {"mass": 1, "inertia": 1, "markers": {"pin": [0, 0]}}},
    joints={"bearing": {"kind": "revolute", "between": ["ground.o", "arm.pin"]}},
    drives={"motor": {"joint": "bearing", "speed": "Omega*step(t, 0, rise)"}},
    parameters={"Omega": {"default": 60, "unit": "rad/s"}, "rise": {"default": 0.3, "unit": "s"}},
)


def test_parameters_that_nothing_uses_any_more_are_left_out_with_a_note() -> None:
    spec, changes = with_values(RAMP, {"drives.motor.speed": "Omega*t"})
    assert [p.symbol for p in function_parameters(spec.drives[0].speed)] == ["Omega"]
    assert [*map(str, changes)] == [
        "drives.motor.speed: Omega*step(t, 0, rise) -> Omega*t",
        "parameters.rise: 0.3 s -> left out, since no function of time uses it any more",
    ]
    spec, changes = with_values(RAMP, {"drives.motor.speed": "8"})
    assert spec.drives[0].speed == derive.Parameter("motor_speed_value", "rad/s", 8.0)
    assert [change.key for change in changes] == ["drives.motor.speed", "parameters.Omega", "parameters.rise"]
    with pytest.raises(derive.SpecError, match=r"--set: parameters.rise: no function of time uses it"):
        with_values(RAMP, {"drives.motor.speed": "8", "rise": "1"})


def test_the_default_of_a_parameter_of_functions_is_a_key() -> None:
    _, changes = with_values(RAMP, {"parameters.rise.default": "0.5"})
    assert str(changes[0]) == "parameters.rise.default: 0.3 -> 0.5"


def test_all_unknown_names_are_reported_with_suggestions() -> None:
    with pytest.raises(derive.SpecError) as error:
        with_values(SPINNING, {"Ei": "3", "bodies.beam.mas": "3", "simulation.duration": "1", "zzz": "1"})
    lines = str(error.value).splitlines()
    assert len(lines) == 3 and all(line.startswith("--set: ") for line in lines)
    assert 'did you mean "EI"?' in lines[0] and 'bodies.beam.mas: unknown key; did you mean "mass"?' in lines[1]
    assert "the parameters are m, l, EI" in lines[2]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("EI", "-1", "a positive number is needed, not -1"),
        ("EI", "stiff", "is no number; a number is written like 2, 0.5 or 1/3"),
        ("simulation.duration", "0", "simulation.duration: a positive number is needed"),
        ("bodies.beam.pieces", "1.5", "bodies.beam.pieces: a whole number is needed"),
        ("name", "1\nname = 'x'", "cannot be a name"),
    ],
)
def test_values_are_checked_as_those_of_a_file(name: str, value: str, message: str) -> None:
    with pytest.raises(derive.SpecError) as error:
        with_values(SPINNING, {name: value})
    assert str(error.value).startswith("--set: ") and message in str(error.value)


def test_a_beam_of_second_order_without_it_has_no_terms_either() -> None:
    """The terms that a specification need not write are left out; those that are set beside the order are refused."""
    second = {"length": 1, "mass": 1, "bending_stiffness": 1, "order": 2}
    flat = derive.scene("flat", bodies={"rod": second})
    space = derive.spatial_scene("space", bodies={"rod": second | {"rotary_inertia": 1}})
    for scene in (flat, space):
        first, changes = with_values(scene, {"bodies.rod.order": "1"})
        assert [change.key for change in changes] == ["bodies.rod.order", "bodies.rod.terms"]
        assert with_values(first, {"bodies.rod.order": "2"})[0].bodies == scene.bodies
        with pytest.raises(derive.SpecError, match="is for beams of order 2"):
            with_values(scene, {"bodies.rod.order": "1", "bodies.rod.terms": "full"})


BLADE = {
    "length": 1,
    "mass": 2,
    "bending_stiffness": 90,
    "rotary_inertia": 1e-3,
    "centre": [0, 0.01],
    "lateral": {"bending_stiffness": 40},
    "torsion": {"ansatz": ["xi"], "stiffness": 8},
    "axial": {"ansatz": ["xi"], "stiffness": 1e5},
    "damping": {"ratio": 0.01},
    "masses": {"tip": {"at": 1, "mass": 0.1, "inertia": [1e-3, 1e-3, 2e-3, 0, 0, 0], "centre": [0, 0, 0.01]}},
}


@pytest.mark.parametrize(
    "key",
    [
        *("length", "mass", "bending_stiffness", "rotary_inertia", "centre[1]", "lateral.bending_stiffness"),
        *("torsion.stiffness", "axial.stiffness", "damping.ratio"),
        *("masses.tip.mass", "masses.tip.inertia[2]", "masses.tip.centre[2]"),
    ],
)
def test_all_constants_of_a_beam_in_space_become_parameters(key: str) -> None:
    spec, (change,) = with_values(derive.spatial_scene("mill", bodies={"blade": BLADE}), {f"bodies.blade.{key}": "0.5"})
    assert [str(parameter.symbol) for parameter in derive.derive(spec).parameters] == [change.symbol]


def test_a_symbol_of_two_beams_in_space_is_one_parameter() -> None:
    """Each table of a beam counts: the second stiffness would be the first one in silence."""
    other = BLADE | {"torsion": {"ansatz": ["xi"], "stiffness": {"symbol": "GJ", "default": 5}}}
    blade = BLADE | {"torsion": {"ansatz": ["xi"], "stiffness": {"symbol": "GJ", "default": 8}}}
    with pytest.raises(derive.SpecError, match='"GJ" is the symbol of torsion stiffness of the body blade, with the'):
        derive.spatial_scene("mill", bodies={"blade": blade, "other": other})
