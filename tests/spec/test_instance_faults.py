"""Tables with `count` that are wrong: one line for each fault, however many instances have it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from test_instances import CHAIN, chain

import derive
from derive.errors import SpecError
from derive.spec.toml.read import parse, warnings, with_lines


def errors(*changes: tuple[str, str], more: str = "") -> list[str]:
    with pytest.raises(SpecError) as caught:
        parse(chain(*changes, more=more))
    return [f"{p.line}: {p.path}: {p.message}" for p in caught.value.problems]


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        (
            [("count = 4\nansatz", "count = 3\nansatz")],
            [
                "20: joints.weld.between[1]: for i = 2: there is no link[3]: the count of link is 3, and its index is "
                "from 0 to 2",
                "23: forces.push.at: for i = 1: there is no link[3]: the count of link is 3, and its index is from 0 "
                "to 2",
                "28: springs.coil.between[1]: there is no link[3]: the count of link is 3, and its index is from 0 to "
                "2",
                "33: outputs.tip.marker: for i = 3: there is no link[3]: the count of link is 3, and its index is from "
                "0 to 2",
                '39: plots.last.deflection: there is no body "link[3]"; did you mean "link[2]" or "link[1]"?',
            ],
        ),
        (
            [("count = 4\nansatz", "count = 0\nansatz")],
            ["7: bodies.link.count: a count is a whole number from 1 to 10000, not 0"],
        ),
    ],
)
def test_faults_of_counts(changes, lines):
    assert errors(*changes) == lines


@pytest.mark.parametrize("count", ["-1", "10001", "1.0", '"4"', "true", "[4]"])
def test_a_count_is_a_whole_number(count):
    (line,) = errors(("count = 4\nansatz", f"count = {count}\nansatz"))
    assert line.startswith("7: bodies.link.count: a count is a whole number from 1 to 10000, not ")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("0.05 + 0.1*i", "0.05/(i - 2)", '13: bodies.link.start.position[0]: for i = 2: column 6 of "0.05/(2 - 2)": '),
        ("1/20*0.9^i", "sqrt(2 - i)", "9: bodies.link.mass: "),
        ("1/20*0.9^i", "10^i^2", '9: bodies.link.mass: for i = 0 to 3: column 5 of "10^0^2": a power of a power '),
        ("1/20*0.9^i", "9^9999*i", '9: bodies.link.mass: for i = 0 to 3: column 2 of "9^9999*0": the number is too '),
        ("1/20*0.9^i", "i*t", '9: bodies.link.mass: for i = 0 to 3: column 3 of "0*t": "t" is no number; '),
        ("1/20*0.9^i", "2 - i", "9: bodies.link.mass: for i = 2 and 3: a positive number is needed, not 0"),
        ("1/20*0.9^i", "-1", "9: bodies.link.mass: a positive number is needed, not -1"),
        ("mass = ", "masss = ", '9: bodies.link.masss: unknown key; did you mean "masses" or "mass"?'),
        ('kind = "weld"', 'kind = "wld"', "19: joints.weld.kind: the joint is one of "),
        (
            'link[i].right", "link[i+1]',
            'lnk[i].right", "link[i+1]',
            '20: joints.weld.between[0]: there is no table "lnk" with a count; did you mean "link"?',
        ),
        ('link[i].right", "link[i+1]', 'hinge[i].right", "link[i+1]', "20: joints.weld.between[0]: there is no table"),
        (
            'link[i].right", "link[i+1]',
            'link.right", "link[i+1]',
            '20: joints.weld.between[0]: there is no body "link"',
        ),
        (
            'link[i].right", "link[i+1]',
            'link[i-1].right", "link[i+1]',
            "20: joints.weld.between[0]: for i = 0: there "
            "is no link[-1]: the count of link is 4, and its index is from 0 to 3",
        ),
        (
            'link[i].right", "link[i+1]',
            'link[i].rigt", "link[i+1]',
            '20: joints.weld.between[0]: for i = 0 to 2: the body link[0] has no marker "rigt"; did you mean "right"?',
        ),
        (
            '"weld[i]"',
            '"hinge[i]"',
            '37: outputs.reaction.joint: hinge has no count, and is referred to without an index; write "hinge"',
        ),
        ('"weld[i]"', '"weld[i-i]"', '37: outputs.reaction.joint: "i-i" is no index of an instance; write weld[i], '),
    ],
)
def test_a_fault_of_all_instances_is_one_line(old, new, line):
    first, *others = errors((old, new))
    assert first.startswith(line)
    assert len(others) == ("sqrt" in new)  # the square root is zero for one i and not real for another


def test_square_roots_that_are_not_real():
    assert errors(("1/20*0.9^i", "sqrt(2 - i)")) == [
        '9: bodies.link.mass: for i = 3: column 1 of "sqrt(2 - 3)": the square root of a negative number is not real',
        "9: bodies.link.mass: for i = 2: a positive number is needed, not 0",
    ]


@pytest.mark.parametrize(
    ("more", "line"),
    [
        (
            "[bodies.link_2]\nlength = 1\n",
            '44: bodies.link_2: "link_2_c1", a coordinate of the body link_2, is taken: it is a coordinate of the body '
            "link[2]; choose another name",
        ),
        ('[bodies."link[2]"]\nlength = 1\n', '6: bodies.link: "link[2]" is the name of another table; choose another'),
        (
            '[joints.weld_1]\nkind = "weld"\nbetween = ["ground.hook", "link[2].left"]\n',
            '44: joints.weld_1: "weld_1_1", a name of the joint weld_1, is taken: it is a name of the joint weld[1]; ',
        ),
        ('[outputs.tip_0]\nkind = "energy"\n', None),
        (
            '[outputs.tip_0]\nkind = "position"\nmarker = "link[1].left"\n',
            '44: outputs.tip_0: "tip_0_1" is taken: it is a component of the output tip[0]; choose another name',
        ),
        ("[parameters.i]\ndefault = 1\n", '44: parameters.i: "i" is taken: it is the index in tables with `count`; '),
        (
            '[bodies."2x"]\ncount = 3\nmass = 1\ninertia = 1\n',
            '44: bodies.2x: "2x" cannot be a name: it must begin with',
        ),
    ],
)
def test_two_names_that_meet(more, line):
    if line is None:
        assert parse(chain(more=more)).outputs[-1].name == "tip_0"
        return
    first, *_ = errors(more=more)
    assert first.startswith(line)


def test_all_faults_are_reported_at_once():
    lines = errors(("1/20*0.9^i", "1/i"), ('kind = "weld"', 'kind = "wld"'), ("weld[i]", "weld[i+1]"))
    assert [line.partition(": ")[0] for line in lines] == ["9", "19", "37"]
    assert "for i = 0: " in lines[0]
    assert "for i = 2: there is no weld[3]" in lines[2]


def test_many_instances_with_many_faults_are_few_lines():
    many = chain(
        ("0.9^i", "0.99^i"), ("count = 4\nansatz", "count = 1000\nansatz"), ("count = 3\nkind", "count = 999\nkind")
    )
    text = many.replace("length = 0.1", "lenght = 0.1\ncolour = 1").replace('"link[i].right", "', '"lik.right", "', 1)
    with pytest.raises(SpecError) as caught:
        parse(text)
    assert [p.line for p in caught.value.problems] == [10, 11, 21]


def test_a_count_belongs_to_some_sections():
    assert any(text.startswith("45: plots.m.count: unknown key") for text in errors(more="[plots.m]\ncount = 2\n"))


def test_warnings_of_instances_are_one(tmp_path: Path):
    path = tmp_path / "chain.toml"
    path.write_text(chain(("length = 0.1\n", "")))
    (warning,) = warnings(path)
    assert warning.startswith(f"{path}:6: bodies.link.length: no length is given")


def test_faults_of_the_derivation_have_the_line_of_their_table(tmp_path: Path):
    text = 'name = "two"\n[ground.markers]\no = [0, 0]\n[bodies.arm]\ncount = 2\nmarkers = { a = [0, 0] }\n'
    text += '[joints.pin]\nkind = "revolute"\ncount = 2\nbetween = ["ground.o", "arm[i].a"]\n'
    text += '[drives.m]\njoint = "pin[0]"\nspeed = 1\n[drives.n]\njoint = "pin[1]"\nspeed = 1\n'
    path = tmp_path / "two.toml"
    path.write_text(text)
    problem = derive.errors.Problem("bodies.arm[1]", "it has no mass")
    assert str(with_lines(SpecError((problem,)), path)) == f"{path}:4: bodies.arm: for i = 1: it has no mass"


@pytest.mark.long
def test_hash_seed_does_not_matter():
    code = "import sys, derive\nfrom derive.spec.toml.read import parse\ntext = sys.stdin.read()\n"
    code += "print(derive.short_text.full_text(parse(text)), derive.derive(parse(text)))\n"
    code += "try: parse(text.replace('i+1', 'i+2').replace('0.9^i', '1/i'))\n"
    code += "except derive.SpecError as error: print(error)\n"
    results = {
        subprocess.run(
            [sys.executable, "-c", code],
            input=CHAIN,
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("0", "1")
    }
    assert len(results) == 1
