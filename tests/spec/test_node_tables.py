"""Tables of files of a body of nodes, and MatrixMarket files that are wrong."""

import os

import pytest
from bodies import (
    LUMPED,
    MODAL_BODY,
    POSITIONS,
    save,
    toml,
)
from test_node_files import MASS_FITS, START, faults

from derive.errors import SpecError
from derive.spec.toml.read import parse

BESIDE = "; its path begins at the folder of the specification"


@pytest.mark.parametrize(
    ("nodes", "messages"),
    [
        ('"none.npz"', [f': the file "none.npz" cannot be read: no such file or directory{BESIDE}']),
        ('"a\\u0000b"', [f': the file "a\\x00b" cannot be read: embedded null byte{BESIDE}']),
        ('"parts"', [f': the file "parts" cannot be read: is a directory{BESIDE}']),
        ('"pipe"', [f': the file "pipe" cannot be read: it is a pipe or a device, not a file{BESIDE}']),
        (
            "3",
            [
                ': a file is needed, such as "block.npz", or a table such as { positions = "x.mtx", mass = "m.mtx" }, '
                "not a number"
            ],
        ),
        (
            '{ positions = "x.mtx", mass = 3, stifness = "k.mtx" }',
            [
                '.stifness: unknown key; did you mean "stiffness"?',
                f'.positions: the file "x.mtx" cannot be read: no such file or directory{BESIDE}',
                '.mass: a file in quotation marks is needed, such as "mass.mtx", not a number',
            ],
        ),
    ],
)
def test_files_that_are_not_there(tmp_path, nodes, messages):
    (tmp_path / "parts").mkdir()
    os.mkfifo(tmp_path / "pipe")  # without a writer, to open it would block
    with pytest.raises(SpecError) as caught:
        parse(toml("modes = 0", nodes), str(tmp_path / "b.toml"))
    assert str(caught.value).split("\n") == [f"{tmp_path}/b.toml:3: {START}{message}" for message in messages]


def test_a_fault_of_a_file_of_a_table_has_its_line(tmp_path):
    text = 'name = "b"\n[body]\nunits = "SI"\nmodes = 0\n[body.nodes]\npositions = "x.mtx"\nmass = "m.mtx"\n'
    with pytest.raises(SpecError) as caught:
        parse(text, str(tmp_path / "b.toml"))
    assert [(problem.path, problem.line) for problem in caught.value.problems] == [
        ("body.nodes.positions", 6),
        ("body.nodes.mass", 7),
    ]


HEAD = "%%MatrixMarket matrix"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", '"m.mtx" is no MatrixMarket file: line 1: Not a Matrix Market file. Missing banner'),
        ("PK\x03\x04", '"m.mtx" is no MatrixMarket file: line 1: Not a Matrix Market file. Missing banner'),
        (
            f"{HEAD} array complex general\n4 1\n" + "1 0\n" * 4,
            '"m.mtx" holds complex numbers; real numbers are needed',
        ),
        (
            f"{HEAD} coordinate pattern general\n4 4 1\n1 1\n",
            '"m.mtx" holds a pattern without numbers; real numbers are needed',
        ),
        (f"{HEAD} array real general\n4000000 4000000\n1\n", '"m.mtx" ends before its 4000000 x 4000000 matrix does'),
        (f"{HEAD} coordinate real general\n4 4 99999999\n1 1 1\n", '"m.mtx" ends before its 4 x 4 matrix does'),
        (
            f"{HEAD} array real general\n4 1\n1\n2\n3\n",
            '"m.mtx" cannot be read as MatrixMarket: truncated file. Expected another 1 lines',
        ),
        (
            f"{HEAD} coordinate real general\n4 4 1\n5 1 1\n",
            '"m.mtx" cannot be read as MatrixMarket: line 3: Row index out of bounds',
        ),
        (
            f"{HEAD} coordinate real symmetric\n4 4 3\n1 1 1\n2 1 0.5\n1 2 0.5\n",
            '"m.mtx" is symmetric and holds an entry twice; store the lower triangle alone',
        ),
        (
            f"{HEAD} coordinate real general\n999999999999999 999999999999999 1\n1 1 1\n",
            "the shape is (999999999999999, 999999999999999), " + MASS_FITS,
        ),
        (
            f"{HEAD} coordinate real general\n4 4 3\n1 1 1\n1 2 1\n2 2 1\n",
            "the matrix is not symmetric: the entries (0, 1) and (1, 0) differ by 1.0e+00 of the largest entry; only "
            "one triangle is filled: fill both, or write `symmetric` in the first line of a MatrixMarket file",
        ),
        (
            f"{HEAD} array real general\n4 1\n1\n2\nnan\n3\n",
            "numbers that are NaN, infinite or beyond 1e+100: 1 of 4, the first at [2, 0]",
        ),
    ],
)
def test_a_fault_of_a_matrix_market_file(tmp_path, monkeypatch, text, message):
    (tmp_path / "m.mtx").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert faults({"positions": POSITIONS, "mass": "m.mtx"}, modes=0) == [f".mass: {message}"]


def test_faults_of_files_come_with_those_of_other_keys(tmp_path):
    save(tmp_path, **MODAL_BODY | {"mass": LUMPED[:2]})
    with pytest.raises(SpecError) as caught:
        parse(toml("modes = 3\n[body.markers]\ntip = 4"), str(tmp_path / "b.toml"))
    assert [(problem.path, problem.line) for problem in caught.value.problems] == [
        ("body.nodes.mass", 3),
        ("body.modes", 5),
        ("body.markers.tip", 7),
    ]
