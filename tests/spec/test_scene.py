"""Scenes that are right: what is read is what is written."""

from dataclasses import fields, is_dataclass
from fractions import Fraction
from pathlib import Path

import pytest
from example_scenes import EVERYTHING, SMALL, small

from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame, Marker
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.forces import Force, Spring, Torque
from derive.spec.model.joints import Drive, Joint
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.plots import Deflection, Plot, ReferenceCurve
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import InitialValues, Simulation
from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing.time_expression import time_function
from derive.spec.toml.read import parse, read

SCENES = Path(__file__).parents[2] / "scenes"
ZERO = Fraction(0)
POWERS = tuple((ZERO,) * n + (Fraction(1),) for n in range(5))


def place(text):
    return MarkerRef(*text.split("."))


def point(name, x=ZERO, y=ZERO):
    return PointMarker(name, x, y)


def number(value):
    return TimeFunction("number", value=Fraction(value))


def test_the_crank_slider_of_the_scenes():
    scene = read(SCENES / "crank_slider_3.toml")
    rows = scene.plots[0].reference.rows
    assert scene == Scene(
        name="crank_slider_3",
        ground=(point("bearing"),),
        gravity=None,
        bodies=(
            RigidBody("crank", None, None, (ZERO, ZERO), (point("hub"), point("pin", Fraction("0.15")))),
            BeamBody(
                "rod",
                PlanarBeam(
                    name="rod",
                    ansatz=POWERS[:4],
                    frame=Frame("mean"),
                    mass=Fraction("0.066755702"),
                    length=Fraction("0.3"),
                    bending_stiffness=Fraction("12.7234502"),
                    markers=(Marker("left", Fraction(-1)), Marker("middle", ZERO), Marker("right", Fraction(1))),
                    orthogonal=True,
                ),
                pieces=3,
                start=InitialValues((0.3, 0.0)),
            ),
            RigidBody(
                "slider",
                Fraction("0.033377851"),
                Fraction("1e-6"),
                (ZERO, ZERO),
                (point("pin"),),
                InitialValues((0.45, 0.0)),
            ),
        ),
        joints=(
            Joint("crank_bearing", "revolute", place("ground.bearing"), place("crank.hub")),
            Joint("crank_pin", "revolute", place("crank.pin"), place("rod.left")),
            Joint("slider_pin", "revolute", place("rod.right"), place("slider.pin")),
            Joint("guide", "translational", place("ground.bearing"), place("slider.pin")),
        ),
        drives=(Drive("motor", "crank_bearing", None, Fraction(150)),),
        simulation=Simulation(0.1, 1e-4),
        plots=(
            Plot(
                "deflection",
                Deflection(place("rod.middle"), (place("rod.left"), place("rod.right")), 0.3),
                over="motor",
                cut="rod",
                pieces=(1, 2, 3),
                reference=ReferenceCurve(
                    "crank_slider_A.csv", "crank_angle_rad", "midpoint_deflection_over_L", rows=rows
                ),
            ),
        ),
    )
    assert (len(rows), rows[0], rows[1]) == (1001, (0.0, 0.0), (1.5e-2, 3.0102690503e-07))


def test_a_scene_with_every_key_there_is():
    scene = parse(EVERYTHING)
    rod = PlanarBeam(
        name="rod",
        ansatz=POWERS[2:],
        frame=Frame("chord"),
        mass=Parameter("m", "g", 66.0),
        length=Fraction("0.3"),
        bending_stiffness=Fraction("12.5"),
        markers=(Marker("left", Fraction(-1)), Marker("right", Fraction(1))),
        orthogonal=True,
    )
    assert scene.gravity == (ZERO, Parameter("g", "m/s^2", -9.81))
    assert scene.ground == (point("bearing"), point("wall", Parameter("w", "m", -2.0), Fraction(1, 3)))
    assert scene.bodies == (
        RigidBody(
            "crank",
            Fraction(2),
            Parameter("I", "kg m^2", 0.25),
            (Fraction("0.1"), Parameter("e", "mm", 0.0)),
            (point("hub"), point("pin", Fraction("0.15"), Fraction("-0.5"))),
            InitialValues((1.0, 0.5), 0.3, (0.0, -1.5), 3.0),
        ),
        BeamBody("rod", rod, 2, InitialValues(angle=-0.5)),
        RigidBody("slider", Fraction("0.5"), Fraction("1e-6"), (ZERO, ZERO), (point("pin"),)),
        RigidBody("plate", None, None, (ZERO, ZERO), (point("a"),)),
    )
    assert scene.joints == (
        Joint("bearing", "revolute", place("ground.bearing"), place("crank.hub")),
        Joint("pin", "revolute", place("crank.pin"), place("rod.left")),
        Joint("clamp", "weld", place("rod.right"), place("slider.pin"), 0.1),
        Joint(
            "guide",
            "translational",
            place("ground.wall"),
            place("slider.pin"),
            0.2,
            (Fraction(3), Fraction(-1, 2)),
        ),
        Joint("glue", "fixed", place("slider.pin"), place("plate.a")),
    )
    assert scene.drives == (
        Drive("motor", "bearing", None, Parameter("Omega", "rad/s", -150.0), Fraction(1, 2)),
        Drive("push", "guide", time_function("0.1*t^2")),
    )
    assert scene.forces == (Force("load", place("rod.right"), (time_function("-10*sin(2*t)"), number("0.5"))),)
    assert scene.torques == (
        Torque("brake", place("crank.hub"), number("-1.5"), place("rod.left")),
        Torque("wind", place("plate.a"), time_function("t/2")),
    )
    assert scene.springs == (
        Spring(
            "mount",
            "linear",
            place("ground.wall"),
            place("slider.pin"),
            Parameter("k", "N/m", 0.0),
            Fraction(1, 2),
            Fraction(1, 4),
        ),
        Spring(
            "coil",
            "rotational",
            place("ground.bearing"),
            place("crank.hub"),
            Fraction(3),
            ZERO,
            Parameter("rest", "rad", -1.0),
        ),
    )
    assert scene.simulation == Simulation(2.0, 0.01, 1e-6)
    assert scene.plots == (
        Plot(
            "bend", Deflection(place("rod.right"), (place("rod.left"), place("slider.pin")), 0.3), None, None, (), None
        ),
        Plot(
            "cuts",
            Deflection(place("rod.left"), (place("crank.pin"), place("rod.right")), 1.0),
            "push",
            "rod",
            (1, 4),
            None,
        ),
    )


def numbers(value):
    if is_dataclass(value):
        for one in fields(value):
            yield from numbers(getattr(value, one.name))
    elif isinstance(value, tuple):
        for one in value:
            yield from numbers(one)
    elif not isinstance(value, (str, type(None))):
        yield value


def test_a_scene_is_made_of_exact_numbers_and_doubles_and_can_be_hashed():
    scene = parse(EVERYTHING)
    assert {type(value) for value in numbers(scene)} == {Fraction, float, int, bool, DisplacementOrder}
    assert isinstance(hash(scene), int)
    assert parse(EVERYTHING) == scene


@pytest.mark.parametrize(
    "key", ["length = 1", "bending_stiffness = 1", 'ansatz = ["xi^4", "xi^3", "xi^2"]', 'frame = "chord"']
)
def test_a_body_with_one_key_of_a_beam_is_a_beam(key):
    (body,) = parse(f'name = "s"\n[bodies.rod]\n{key}\n').bodies
    assert isinstance(body, BeamBody)
    assert body.beam.mass == Parameter("m", "kg", 1.0)
    assert (body.pieces, body.start, body.beam.gravity) == (1, InitialValues(), None)


def test_a_body_without_such_a_key_is_rigid():
    (body,) = parse('name = "s"\n[bodies.bar]\nmass = { symbol = "m", default = 3 }\ninertia = 2\n').bodies
    assert body == RigidBody("bar", Parameter("m", "kg", 3.0), Fraction(2), (ZERO, ZERO), ())


def test_one_symbol_in_several_places_is_one_parameter():
    same = '{ symbol = "r", default = 0.15 }'
    text = small(("a = [0, 0], b = [1, 0]", f"a = [{same}, 0], b = [0, {same}]"), ("length = 1", f"length = {same}"))
    bar, rod = parse(text).bodies
    assert bar.markers[0].x is not None
    assert {bar.markers[0].x, bar.markers[1].y, rod.beam.length} == {Parameter("r", "m", 0.15)}


def test_two_beams_that_say_nothing_share_their_parameters():
    one, other = parse('name = "s"\n[bodies.a]\nframe = "mean"\n[bodies.b]\nframe = "chord"\n').bodies
    assert one.beam.mass == other.beam.mass == Parameter("m", "kg", 1.0)


@pytest.mark.parametrize(
    ("kind", "units"),
    [("linear", ("N/m", "N s/m", "m")), ("rotational", ("N m/rad", "N m s/rad", "rad"))],
)
def test_the_parameters_of_a_spring_have_units_of_their_own(kind, units):
    table = "\n".join(f'{key} = {{ symbol = "{key}", default = 0 }}' for key in ("stiffness", "damping", "rest"))
    more = f'[springs.s1]\nkind = "{kind}"\nbetween = ["ground.o", "bar.b"]\n{table}\n'
    (spring,) = parse(small(more=more)).springs
    assert tuple(p.unit for p in (spring.stiffness, spring.damping, spring.rest)) == units


def test_the_speed_of_a_slide_is_in_metres():
    slide = ('kind = "revolute"', 'kind = "translational"')
    more = '[drives.d]\njoint = "pin"\nspeed = { symbol = "V", default = 1 }\n'
    assert parse(small(slide, more=more)).drives[0].speed == Parameter("V", "m/s", 1.0)


@pytest.mark.parametrize(
    ("body", "joint"),
    [
        ("", '[drives.d]\njoint = "pin"\nspeed = 1'),
        ("", '[joints.glue]\nkind = "weld"\nbetween = ["rod.right", "bar.b"]'),
        ("mass = 1", '[drives.d]\njoint = "pin"\nspeed = 1'),
        ("mass = 1\ninertia = 1", ""),
    ],
)
def test_a_body_whose_motion_may_be_prescribed_needs_no_mass(body, joint):
    assert parse(small(("mass = 1\ninertia = 1\n", f"{body}\n"), more=joint)).bodies[0].name == "bar"


def test_a_torque_of_the_ground_may_act_against_a_body():
    more = "[torques.m]\nat = 'ground.o'\nvalue = 1\nagainst = 'bar.a'\n"
    assert parse(small(more=more)).torques == (Torque("m", place("ground.o"), number(1), place("bar.a")),)


def test_a_scene_may_be_small():
    assert [body.name for body in parse(SMALL).bodies] == ["bar", "rod"]
