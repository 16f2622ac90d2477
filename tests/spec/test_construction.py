"""Specifications built in Python: the checks and the texts of TOML files, without lines."""

import inspect
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import derive
from derive.spec.model.beam_parts import AttachedMass
from derive.spec.model.keys import QUANTITIES, declared_keys
from derive.spec.toml.read import parse

SCENES = sorted(Path(__file__).resolve().parents[2].joinpath("scenes").glob("*.toml"))

PENDULUM = """
name = "pendulum"
[ground.markers]
bearing = [0, 0]
[scene]
gravity = [0, "-9.81"]
[bodies.rod]
mass = { symbol = "m", default = 2.0 }
inertia = 0.1
markers = { pin = [-0.5, 0], tip = [0.5, 0] }
start = { angle = 0.3 }
[joints.hinge]
kind = "revolute"
between = ["ground.bearing", "rod.pin"]
[drives.motor]
joint = "hinge"
motion = "0.1*sin(t)"
[forces.push]
at = "rod.tip"
components = [0, "-10*sin(t)"]
[springs.mount]
between = ["ground.bearing", "rod.tip"]
stiffness = 100
rest = 1
[simulation]
duration = 1.0
output = 0.01
"""


def pendulum(**changes: object) -> derive.Scene:
    keys = {
        "ground": [derive.PointMarker("bearing", Fraction(0), Fraction(0))],
        "gravity": (0, "-9.81"),
        "bodies": [
            derive.RigidBody(
                "rod",
                mass=derive.Parameter("m", "kg", 2.0),
                inertia=Fraction(1, 10),
                markers=(derive.PointMarker("pin", -0.5, 0), derive.PointMarker("tip", 0.5, 0)),
                start=derive.InitialValues(angle=0.3),
            )
        ],
        "joints": [
            derive.Joint("hinge", "revolute", derive.MarkerRef("ground", "bearing"), derive.MarkerRef("rod", "pin"))
        ],
        "drives": [derive.Drive("motor", "hinge", derive.time_function("0.1*sin(t)"))],
        "forces": {"push": {"at": "rod.tip", "components": [0, "-10*sin(t)"]}},
        "springs": {"mount": {"between": ["ground.bearing", "rod.tip"], "stiffness": 100, "rest": 1}},
        "simulation": derive.Simulation(1.0, 0.01),
    }
    return derive.scene("pendulum", **{**keys, **changes})


def problems(build) -> list[tuple[str, str]]:
    with pytest.raises(derive.SpecError) as caught:
        build()
    assert all(problem.line is None for problem in caught.value.problems)
    return [(problem.path, problem.message) for problem in caught.value.problems]


def in_toml(text: str) -> list[tuple[str, str]]:
    with pytest.raises(derive.SpecError) as caught:
        parse(text)
    return [(problem.path, problem.message) for problem in caught.value.problems]


def test_typed_values_and_tables_make_the_scene_of_the_file():
    assert pendulum() == parse(PENDULUM)


@pytest.mark.parametrize(
    ("function", "of", "others"),
    [
        (derive.planar_beam, derive.PlanarBeam, set()),
        (derive.nodal_body, derive.NodalBody, set()),
        (derive.symbolic_body, derive.SymbolicBody, set()),
        (derive.scene, derive.Scene, {"bodies", "parameters", "tables", "simulation"}),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_the_parameters_of_a_function_are_the_declared_keys(function, of, others):
    parameters = inspect.signature(function).parameters
    keys = {key.name: key for key in declared_keys(of)}
    if of is not derive.Scene:  # what a body alone does in a simulation is not specified in Python
        keys.pop("start", None)
    assert {*parameters} == {"name", *keys, *others}
    for key in (key for key in keys.values() if key.type in QUANTITIES):
        assert parameters[key.name].default == key.default
    if of is not derive.Scene:
        described = " ".join(inspect.getdoc(function).split())
        assert all(key.description in described for key in keys.values())


def test_a_whole_file_as_a_mapping():
    tables = {
        "name": "pendulum",
        "ground": {"markers": {"bearing": [0, 0]}},
        "bodies": {"rod": {"mass": 1, "inertia": 0.1, "markers": {"pin": [0, 0]}}},
        "joints": {"hinge": {"kind": "revolute", "between": ["ground.bearing", "rod.pin"]}},
    }
    scene = derive.scene(tables)
    assert scene.bodies[0].inertia == Fraction(1, 10)
    assert scene.joints[0].kind == "revolute"


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_what_a_file_specifies_is_valid_as_dataclasses(path):
    spec = derive.read(path)
    again = derive.validated(spec)
    if isinstance(spec, derive.NodalBody):  # arrays are compared by identity
        assert (again.data.modes == spec.data.modes).all()
        assert (again.data.mass != spec.data.mass).nnz == 0
        spec, again = replace(spec, data=None), replace(again, data=None)
    assert again == spec


def test_faults_have_the_texts_of_a_file_and_no_lines():
    wrong = {
        "joints": [
            derive.Joint("hinge", "revolut", derive.MarkerRef("ground", "bearing"), derive.MarkerRef("rod", "p"))
        ],
        "forces": {"push": {"at": "rid.tip", "components": [0, "-10*sin(x)"]}},
    }
    text = PENDULUM.replace('"revolute"', '"revolut"').replace("rod.pin", "rod.p")
    text = text.replace('at = "rod.tip"', 'at = "rid.tip"').replace("-10*sin(t)", "-10*sin(x)")
    found = problems(lambda: pendulum(**wrong))
    assert len(found) == 4
    assert sorted(found) == sorted(in_toml(text))


def test_dataclasses_check_nothing_until_they_are_validated():
    scene = pendulum()
    hinge = replace(scene.joints[0], angle=0.5)
    assert problems(lambda: derive.validated(replace(scene, joints=(hinge,)))) == [
        (
            "joints.hinge",
            'a revolute joint has no angle; leave `angle` out, or choose "weld", "fixed" or "translational"',
        )
    ]
    rod = replace(scene.bodies[0], mass=Fraction(-1))
    assert problems(lambda: derive.validated(replace(scene, bodies=(rod,)))) == [
        ("bodies.rod.mass", "a positive number is needed, not -1")
    ]


def test_two_elements_of_one_name_are_refused():
    rod = derive.RigidBody("rod", mass=1, inertia=1)
    assert problems(lambda: derive.scene("two", bodies=[rod, rod])) == [
        ("bodies.rod", '"rod" is taken by another body; names must differ in more than case')
    ]
    tip = AttachedMass("tip", at=Fraction(1), mass=Fraction(1))
    assert problems(lambda: derive.planar_beam("b", ansatz=["1", "xi", "xi^2"], masses=[tip, tip])) == [
        ("beam.masses.tip", '"tip" is taken by another attached mass; names must differ in more than case')
    ]


def test_what_is_no_list_of_typed_values_is_refused_in_words():
    assert problems(lambda: derive.scene("two", bodies=5)) == [
        ("bodies", "a table of bodies by their names is needed, such as [bodies.rod], not a number")
    ]
    assert problems(lambda: derive.planar_beam("b", ansatz=["1", "xi", "xi^2"], masses=[{"at": 1, "mass": 1}])) == [
        ("beam.masses", "a table of masses by their names is needed, such as [bodies.rod.masses.tip], not a list")
    ]


def test_a_beam_of_dataclasses_in_a_scene():
    rod = derive.planar_beam("rod", length=2, markers={"left": -1})
    scene = derive.scene("rods", bodies=[derive.BeamBody("rod", rod, pieces=2)])
    assert scene.bodies[0].beam == rod
    pinned = derive.planar_beam("rod", ansatz=["1", "xi", "xi^2", "xi^3", "xi^4"], ends="pinned")
    assert derive.scene("rods", bodies=[derive.BeamBody("rod", pinned)]).bodies[0].beam == pinned
    heavy = derive.planar_beam("rod", length=2, gravity=(0, -9.81))
    assert problems(lambda: derive.scene("rods", bodies=[derive.BeamBody("rod", heavy)])) == [
        ("bodies.rod.gravity", "gravity acts on all bodies; write it in the table [scene]")
    ]
