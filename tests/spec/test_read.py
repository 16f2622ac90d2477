"""Specifications that are right: from files, from text and from Python, all the same."""

import json
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

import pytest

from derive.spec.construction.bodies import planar_beam
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame, Marker
from derive.spec.model.quantity import Parameter
from derive.spec.tables.json_schema import json_schema
from derive.spec.toml.read import parse, read

SCENES = Path(__file__).parents[2] / "scenes"

PAPER = PlanarBeam(
    name="free_beam_mean",
    ansatz=(
        (Fraction(1),),
        (Fraction(0), Fraction(1)),
        (Fraction(0), Fraction(0), Fraction(1)),
        (Fraction(0), Fraction(0), Fraction(0), Fraction(1)),
    ),
    frame=Frame("mean"),
    mass=Parameter("m", "kg", 1.0),
    length=Parameter("l", "m", 1.0),
    bending_stiffness=Parameter("EI", "N m^2", 1.0),
    markers=(Marker("left", Fraction(-1)), Marker("middle", Fraction(0)), Marker("right", Fraction(1))),
    orthogonal=True,
)
MARKERS = {"left": -1, "middle": 0, "right": 1}


def test_the_scene_of_the_mean_frame_is_the_beam_of_the_paper():
    assert read(SCENES / "free_beam_mean.toml") == PAPER


def test_the_scene_of_the_point_frame_differs_in_name_and_frame_alone():
    point = replace(PAPER, name="free_beam_point", frame=Frame("point", Fraction(0)), orthogonal=False)
    assert read(str(SCENES / "free_beam_point.toml")) == point


def test_two_lines_are_enough():
    text = 'name = "b"\n[beam]\n'
    assert parse(text) == planar_beam("b") == replace(PAPER, name="b", markers=())


@pytest.mark.parametrize(
    ("toml", "keywords", "changes"),
    [
        ('frame = "point"', {"frame": "point"}, {"frame": Frame("point", Fraction(0)), "orthogonal": False}),
        ('frame = "chord"', {"frame": Frame("chord")}, {"frame": Frame("chord"), "orthogonal": False}),
        (
            'frame = { kind = "point", at = 0.1 }',
            {"frame": {"kind": "point", "at": 0.1}},
            {"frame": Frame("point", Fraction(1, 10)), "orthogonal": False},
        ),
        (
            'frame = { kind = "tangent", at = -1.0 }',
            {"frame": Frame("tangent", Fraction(-1))},
            {"frame": Frame("tangent", Fraction(-1)), "orthogonal": False},
        ),
        ('frame = { kind = "mean" }', {"frame": {"kind": "mean"}}, {}),
        (
            'frame = "given"\nansatz = ["xi^2 - 1/3", "0.1*xi^3"]',
            {"frame": "given", "ansatz": [(Fraction(-1, 3), 0, 1), (0, 0, 0, 0.1, 0)]},
            {
                "frame": Frame("given"),
                "ansatz": (
                    (Fraction(-1, 3), Fraction(0), Fraction(1)),
                    (Fraction(0), Fraction(0), Fraction(0), Fraction(1, 10)),
                ),
                "orthogonal": False,
            },
        ),
        ("orthogonal = false", {"orthogonal": False}, {"orthogonal": False}),
        ("mass = 0.3", {"mass": 0.3}, {"mass": Fraction(3, 10)}),
        ("mass = 3e-1", {"mass": Fraction(3, 10)}, {"mass": Fraction(3, 10)}),
        ("mass = 1_0.5", {"mass": "10.5"}, {"mass": Fraction(21, 2)}),
        ('mass = "1/3"', {"mass": "1/3"}, {"mass": Fraction(1, 3)}),
        ("length = 2", {"length": 2}, {"length": Fraction(2)}),
        (
            "length = 0.123456789012345678901234567890",
            {"length": Fraction("0.123456789012345678901234567890")},
            {"length": Fraction("0.123456789012345678901234567890")},
        ),
        ('mass = { symbol = "M" }', {"mass": {"symbol": "M"}}, {"mass": Parameter("M", "kg", 1.0)}),
        (
            'bending_stiffness = { symbol = "K", unit = "kN*m^2/(1)", default = "1/3" }',
            {"bending_stiffness": MappingProxyType({"symbol": "K", "unit": "kN*m^2/(1)", "default": Fraction(1, 3)})},
            {"bending_stiffness": Parameter("K", "kN*m^2/(1)", 1 / 3)},
        ),
        (
            "markers = { a = 0.5, b = '-1/3' }",
            {"markers": {"a": 0.5, "b": Fraction(-1, 3)}},
            {"markers": (Marker("a", Fraction(1, 2)), Marker("b", Fraction(-1, 3)))},
        ),
    ],
)
def test_toml_and_python_say_the_same(toml, keywords, changes):
    expected = replace(PAPER, name="b", **({"markers": ()} | changes))
    assert parse(f'name = "b"\n[beam]\n{toml}\n') == expected
    assert planar_beam("b", **keywords) == expected


def test_a_beam_says_itself_again():
    for frame in (Frame("mean"), Frame("point", Fraction(1, 7)), Frame("tangent", Fraction(1)), Frame("chord")):
        beam = replace(PAPER, frame=frame, mass=Fraction(1, 3), length=Parameter("L", "mm", 0.1))
        again = planar_beam(
            beam.name,
            ansatz=beam.ansatz,
            frame=beam.frame,
            mass=beam.mass,
            length=beam.length,
            bending_stiffness=beam.bending_stiffness,
            markers={marker.name: marker.at for marker in beam.markers},
            orthogonal=beam.orthogonal,
        )
        assert again == beam


def test_the_numbers_of_a_beam_have_the_types_that_they_promise():
    beam = planar_beam("b", mass=2, length={"symbol": "L", "default": 3}, frame=Frame("point", 0), markers={"a": 1})
    assert isinstance(beam.mass, Fraction)
    assert isinstance(beam.length.default, float)
    assert isinstance(beam.frame.at, Fraction)
    assert isinstance(beam.markers[0].at, Fraction)
    assert isinstance(hash(beam), int)


def test_a_file_may_begin_with_a_byte_order_mark_and_end_lines_as_windows_does(tmp_path):
    path = tmp_path / "b.toml"
    path.write_bytes(b'\xef\xbb\xbfname = "b"\r\n[beam]\r\n')
    assert read(path).name == "b"


def test_the_schema_in_the_scenes_is_up_to_date(compare_or_update):
    compare_or_update(SCENES / "schema.json", json_schema())


def test_the_schema_tells_a_beam_from_a_body_in_space():
    schema = json.loads(json_schema())
    assert schema["oneOf"] == [{"required": ["beam"]}, {"required": ["body"]}, {"required": ["bodies"]}]
    kinds = {one["$ref"].split("/")[-1] for one in schema["properties"]["body"]["oneOf"]}
    required = {kind: schema["$defs"][kind]["required"] for kind in kinds}
    assert required == {"NodalTable": ["nodes", "units"], "SymbolicTable": ["integrals", "modes"]}
    assert '"null"' not in json_schema()


def test_importing_the_package_is_light():
    heavy = "{'pydantic', 'sympy', 'numpy', 'scipy', 'casadi'}"
    code = f"import sys, derive.spec; print(sorted({heavy} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"
