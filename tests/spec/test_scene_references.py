"""Curves that plots are compared with: messages on faults of their files have the line."""

import pytest
from example_scenes import errors, small

from derive.spec.model.plots import ReferenceCurve
from derive.spec.toml.read import parse

PLOT = '[plots.p]\ndeflection = "bar.b"\nchord = ["rod.left", "rod.right"]\ndivided_by = 1\n'
NO_NUMBERS = "and no two columns of numbers; below a line with the names of the columns, rows of numbers are needed"


def test_comments_and_other_columns_of_a_reference_are_passed_over(tmp_path):
    (tmp_path / "c.csv").write_bytes(b'\xef\xbb\xbf# a comment\r\nt, x ,"y, m"\r\n\r\n0,1,-2e-3\r\n# b\r\n1.,.5,+3\r\n')
    plot = """
[plots.p]
deflection = "bar.b"
chord = ["rod.left", "rod.right"]
divided_by = 1
reference = { file = "c.csv", x = "x", y = "y, m" }
"""
    scene = parse(small(more=plot), str(tmp_path / "s.toml"))
    assert scene.plots[0].reference == ReferenceCurve("c.csv", "x", "y, m", ((1.0, -2e-3), (0.5, 3.0)))


@pytest.mark.parametrize(
    ("content", "key", "message"),
    [
        (
            b"t,x,y\n0,1,2\n",
            "file",
            '"c.csv" has no curve: a line with the names of the columns and two rows are needed',
        ),
        (b"", "file", '"c.csv" has no curve: a line with the names of the columns and two rows are needed'),
        (b"t,x,y\n0,1,2\n# a\n0,nan,2\n", "file", 'line 4 of "c.csv": "nan" is no finite number'),
        (b"t,x,y\n0,1,2\n0,1e999,2\n", "file", 'line 3 of "c.csv": "1e999" is no finite number'),
        (b"t,x,y\n0,1_0,2\n0,1,2\n", "file", 'line 2 of "c.csv": "1_0" is no finite number'),
        (b"t,x,y\n0,1,2\n0,1\n", "file", 'line 3 of "c.csv": there is no number in column 3'),
        (b"t,x,y\n0,,2\n0,1,2\n", "file", 'line 2 of "c.csv": there is no number in column 2'),
        (b't,x,y\n0,"1,2\n0,1,2\n', "file", '"c.csv" is no CSV file: unexpected end of data'),
        (b"t,x,y\n\xff\n", "file", '"c.csv" is not UTF-8 text; save it as a CSV file in UTF-8'),
        (b"t,X1,y\n0,1,2\n0,1,2\n", "x", '"c.csv" has no column "x"; did you mean "X1"?'),
        (b"t,z,y\n0,1,2\n0,1,2\n", "x", '"c.csv" has no column "x"; its columns are "t", "z", "y"'),
        (b"x,x,y\n0,1,2\n0,1,2\n", "x", '"c.csv" has more than one column "x"; rename one of them'),
        # A file that is no table of numbers: nothing of it is shown.
        (b"root:x:0:0,y\nbin:x:1:1\nsys:x:2:2\n", "x", f'"c.csv" has no column "x", {NO_NUMBERS}'),
        (b"xx,secret,y\nword,1,a\nother,2,b\n", "x", f'"c.csv" has no column "x", {NO_NUMBERS}'),
        (b"x,y\nsecret,1\n0,1\n", "file", 'line 2 of "c.csv": the text in column 1 is no finite number'),
        (b"x,y\n0,-inf\n0,1\n", "file", 'line 2 of "c.csv": "-inf" is no finite number'),
        (b"#" * 5_000_001, "file", 'the file "c.csv" has more than 5 MB, the most that is read'),
    ],
)
def test_a_reference_that_cannot_be_read(tmp_path, content, key, message):
    (tmp_path / "c.csv").write_bytes(content)
    text = small(more=f"{PLOT}[plots.p.reference]\nfile = 'c.csv'\nx = 'x'\ny = 'y'\n")
    line = {"file": 19, "x": 20}[key]
    source = tmp_path / "s.toml"
    assert errors(text, str(source)) == [f"{source}:{line}: plots.p.reference.{key}: {message}"]


def test_a_reference_needs_its_file_and_its_columns():
    text = small(more=f"{PLOT}reference = {{ x = '', file = 3 }}")
    assert errors(text) == [
        '18: plots.p.reference.file: text in quotation marks is needed, such as "curve.csv", not a number',
        '18: plots.p.reference.x: text in quotation marks is needed, such as "curve.csv", not empty text',
        '18: plots.p.reference.y: this key is missing; write y = "the name of a column"',
    ]
