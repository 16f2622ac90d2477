"""The numbers of a body that are wrong, and files that are not what they should be."""

import io
import os
import zipfile

import numpy as np
import pytest
from bodies import (
    CONSISTENT,
    LUMPED,
    LUMPED_BODY,
    MODAL,
    MODAL_BODY,
    MODES,
    POSITIONS,
    STIFFNESS,
    N,
    entries,
    save,
    toml,
    without,
)
from scipy.sparse import csr_array

from derive.errors import SpecError
from derive.spec.construction.bodies import nodal_body
from derive.spec.files import node_data, node_files
from derive.spec.toml.read import parse

START = "body.nodes"


def faults(nodes, **keywords):
    """The messages on the nodes, without the name of their key."""
    with pytest.raises(SpecError) as caught:
        nodal_body("b", nodes, **{"units": "SI", "modes": 1} | keywords)
    return [f"{problem.path}: {problem.message}".removeprefix(START) for problem in caught.value.problems]


def kron(m):
    return np.kron(m, np.eye(3))


def changed(array, index, value):
    array = array.copy()
    array[index] = value
    return array


MASS_FITS = "and that of `positions` (4, 3): (4,), (12,), (4, 4) or (12, 12) is needed"
ROTARY = changed(kron(CONSISTENT), ([0, 1], [1, 0]), 0.5)
UNEVEN = changed(kron(CONSISTENT), ([4, 7], [7, 4]), 0.75)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            {"positions": POSITIONS.T},
            ".positions: the shape is (3, 4), and (nodes, 3) is needed; transpose it",
        ),
        ({"positions": POSITIONS.ravel()}, ".positions: the shape is (12,), and (nodes, 3) is needed"),
        ({"positions": POSITIONS[:0]}, ".positions: the shape is (0, 3), and (nodes, 3) is needed"),
        (
            {"positions": changed(POSITIONS, (1, 2), np.nan)},
            ".positions: numbers that are NaN, infinite or beyond 1e+100: 1 of 12, the first at [1, 2]",
        ),
        ({"mass": LUMPED[:3]}, f".mass: the shape is (3,), {MASS_FITS}"),
        ({"mass": CONSISTENT[:3]}, f".mass: the shape is (3, 4), {MASS_FITS}"),
        ({"mass": np.ones((2, 2, 3))}, f".mass: the shape is (2, 2, 3), {MASS_FITS}"),
        ({"mass": np.array(3.0)}, f".mass: the shape is (), {MASS_FITS}"),
        (
            {"mass": np.array([1, -np.inf, np.nan, 1e101])},
            ".mass: numbers that are NaN, infinite or beyond 1e+100: 3 of 4, the first at [1]",
        ),
        (
            {"mass": csr_array(changed(CONSISTENT, (2, 1), np.inf))},
            ".mass: numbers that are NaN, infinite or beyond 1e+100: 1 of 10, the first at [2, 1]",
        ),
        (
            {"mass": np.array([1.0, -2, 3, -4])},
            ".mass: 2 of 4 nodes have a negative mass, the first of them node 1 with -2",
        ),
        (
            {"mass": changed(CONSISTENT, (3, 3), -0.5)},
            ".mass: 1 of 4 nodes have a negative mass, the first of them node 3 with -0.5",
        ),
        ({"mass": np.zeros(N)}, ".mass: the masses add up to 0; a body needs a positive mass"),
        (
            {"mass": np.diag([1.0, 1, 1, 1]) - 0.75 * np.eye(N)[::-1] - 0.75 * np.eye(N)[[1, 0, 3, 2]]},
            ".mass: the masses add up to -2; a body needs a positive mass",
        ),
        (
            {"mass": changed(np.repeat(LUMPED, 3), 4, 7)},
            ".mass: node 1 has the masses 2, 7, 2 in x, y and z; a node has one mass, the same in all directions",
        ),
        (
            {"mass": changed(CONSISTENT, (1, 2), 0.51)},
            ".mass: the matrix is not symmetric: the entries (1, 2) and (2, 1) differ by 2.0e-03 of the largest entry; "
            "a symmetric matrix is needed",
        ),
        (
            {"mass": np.tril(CONSISTENT)},
            ".mass: the matrix is not symmetric: the entries (0, 1) and (1, 0) differ by 2.0e-01 of the largest entry; "
            "only one triangle is filled: fill both, or write `symmetric` in the first line of a MatrixMarket file",
        ),
        (
            {"mass": ROTARY},
            ".mass: the entry (0, 1) couples two directions; a mass matrix of nodes couples x with x, y with y and z "
            "with z, all alike: leave out rotational inertia",
        ),
        (
            {"mass": UNEVEN + changed(np.zeros((12, 12)), (1, 1), 1e-15)},
            ".mass: of nodes 1 and 2, the mass in y is not that in x; a node has one mass, the same in all directions",
        ),
        (
            {"stiffness": STIFFNESS[:4, :4]},
            ".stiffness: the shape is (4, 4), and that of `positions` (4, 3): (12, 12) is needed",
        ),
        (
            {"stiffness": changed(STIFFNESS, (2, 5), 99)},
            ".stiffness: the matrix is not symmetric: the entries (2, 5) and (5, 2) differ by 1.0e+00 of the largest "
            "entry; a symmetric matrix is needed",
        ),
        (
            {"stiffness": STIFFNESS * (1 + 1e-9 * np.tril(np.ones((12, 12)), -1))},
            ".stiffness: the matrix is not symmetric: the entries (3, 11) and (11, 3) differ by 9.4e-10 of the largest "
            "entry; a symmetric matrix is needed",
        ),
        (
            {"modes": MODES.reshape(2, -1)},
            ".modes: the shape is (2, 12), and that of `positions` (4, 3): (modes, 4, 3) or (12, modes) is needed; "
            "transpose it",
        ),
        (
            {"modes": MODES[:, :3]},
            ".modes: the shape is (2, 3, 3), and that of `positions` (4, 3): (modes, 4, 3) or (12, modes) is needed",
        ),
        (
            {"modes": MODES[:0]},
            ".modes: the shape is (0, 4, 3), and that of `positions` (4, 3): (modes, 4, 3) or (12, modes) is needed",
        ),
        (
            {"modes": MODES, "modal_stiffness": np.ones((3, 3))},
            ".modal_stiffness: the shape is (3, 3), and there are 2 modes: (2, 2) or (2,) is needed",
        ),
        (
            {"modes": MODES, "modal_stiffness": changed(MODAL, (0, 1), 2)},
            ".modal_stiffness: the matrix is not symmetric: the entries (0, 1) and (1, 0) differ by 1.4e-01 of the "
            "largest entry; a symmetric matrix is needed",
        ),
        (
            {"modal_stiffness": MODAL},
            ".modal_stiffness: there are no modes that this could belong to; add them as `modes`",
        ),
        ({"modes": MODES + 1j}, ".modes: this holds complex numbers; real numbers are needed"),
        ({"mass": np.array(["1"] * 4)}, ".mass: this holds text; real numbers are needed"),
        ({"mass": LUMPED > 1}, ".mass: this holds true and false; real numbers are needed"),
        ({"mass": np.array([1, None])}, ".mass: this holds Python objects; real numbers are needed"),
        ({"mass": np.zeros(4, dtype=[("a", "f8")])}, ".mass: this holds no numbers; real numbers are needed"),
        ({"mass": ["1"] * 4}, ".mass: this holds text; real numbers are needed"),
        ({"mass": [[1, 2], [3]]}, '.mass: a file in quotation marks is needed, such as "mass.mtx", not a list'),
        ({"mass_row": "a.mtx"}, '.mass_row: unknown key; did you mean "mass"?'),
        ({3: "a.mtx"}, f".3: unknown key; the keys here are {', '.join(node_files.FILES)}"),
    ],
)
def test_a_fault_of_an_array(arrays, message):
    assert faults(LUMPED_BODY | arrays) == [message]


def test_both_shapes_and_all_arrays_are_looked_at_at_once():
    found = faults({"positions": POSITIONS, "mass": LUMPED[:2], "stiffness": MODAL, "modes": MODES[:, :1]})
    assert [line.split(": ")[0] for line in found] == [".mass", ".stiffness", ".modes"]


@pytest.mark.parametrize(
    ("key", "where"),
    [("positions", "positions of the nodes"), ("mass", "the mass of each node, or the consistent mass matrix")],
)
def test_positions_and_mass_are_needed(key, where):
    (line,) = faults(without(LUMPED_BODY, key))
    assert line.startswith(f".{key}: this is missing: {where}")


SPARSE = entries("mass", CONSISTENT)
SPARSE_K = entries("stiffness", STIFFNESS)


@pytest.mark.parametrize(
    ("arrays", "messages"),
    [
        (
            without(SPARSE, "mass_col"),
            [".mass_col: this is missing; a sparse matrix is mass_row, mass_col, mass_value"],
        ),
        (
            SPARSE | {"mass": LUMPED},
            [
                ".mass: this is there twice, as an array and as mass_row, mass_col, mass_value; keep one of them",
            ],
        ),
        (
            SPARSE | {"mass_value": np.ones(3)},
            [
                ".mass_row: mass_row, mass_col, mass_value have the shapes (10,), (10,), (3,); one shape (entries,) is "
                "needed"
            ],
        ),
        (
            SPARSE | {"mass_row": SPARSE["mass_row"].astype(float)},
            [".mass_row: these are decimals; whole numbers are needed, from 0: save them as integers"],
        ),
        (
            SPARSE | {"mass_row": SPARSE["mass_row"] + 1, "mass_col": SPARSE["mass_col"] + 1},
            [
                ".mass: the entries are in rows and columns 1 to 4, and those of 4 nodes are 0 to 11; these seem to be "
                "numbered from 1"
            ],
        ),
        (
            SPARSE | {"mass_col": SPARSE["mass_col"] - 1},
            [".mass: the entries are in rows and columns -1 to 3, and those of 4 nodes are 0 to 11"],
        ),
        (
            SPARSE | {"mass_col": SPARSE["mass_col"].astype(np.uint64) + np.uint64(2**63)},
            [
                f".mass: the entries are in rows and columns {-(2**63)} to 3, and those of 4 nodes are 0 to 11",
            ],
        ),
        (
            SPARSE | {"mass_value": changed(SPARSE["mass_value"], 2, np.nan)},
            [".mass_value: numbers that are NaN, infinite or beyond 1e+100: 1 of 10, the first at [2]"],
        ),
        (
            {key: array[:0] for key, array in SPARSE.items()},
            [".mass: the masses add up to 0; a body needs a positive mass"],
        ),
    ],
)
def test_a_fault_of_the_entries_of_a_mass(arrays, messages):
    assert faults(without(LUMPED_BODY, "mass") | arrays) == messages


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            SPARSE_K | {"stiffness_row": SPARSE_K["stiffness_row"] + 1, "stiffness_col": SPARSE_K["stiffness_col"] + 1},
            "the entries are in rows and columns 1 to 12, and those of 4 nodes are 0 to 11; these seem to be numbered "
            "from 1",
        ),
        (
            SPARSE_K | {"stiffness_row": SPARSE_K["stiffness_row"] * 3},
            "the entries are in rows and columns 0 to 33, and those of 4 nodes are 0 to 11",
        ),
    ],
)
def test_a_fault_of_the_entries_of_a_stiffness(arrays, message):
    assert faults(without(LUMPED_BODY, "stiffness") | arrays) == [f".stiffness: {message}"]


def archive(**members):
    """A zip archive with any content."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as file:
        for name, content in members.items():
            file.writestr(f"{name}.npy", content)
    return stream.getvalue()


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


LIES = npy(np.zeros(4)).replace(b"(4,)", b"(9,)")
HUGE = npy(np.zeros(4)).replace(b"(4,), }            ", b"(4000000000000000,), }")
TABLE = 'MatrixMarket files go in a table: { positions = "x.mtx", mass = "m.mtx" }'
KNOWN = ", ".join(node_files.ARRAYS)
WITH_MESH = ", ".join((*node_files.ARRAYS, *node_files.MESH))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", f': "b.npz" is no .npz file; {TABLE}'),
        (b"%%MatrixMarket matrix array real general\n", f': "b.npz" is no .npz file; {TABLE}'),
        (
            npy(POSITIONS),
            ': "b.npz" is no .npz file; it holds a single array: save all of them in one file with numpy.savez',
        ),
        (
            archive(positions=npy(POSITIONS), mass=npy(np.array([{}]))),
            ".mass: this holds Python objects, which are not read; save an array of numbers",
        ),
        (
            archive(positions=npy(POSITIONS), mass=b"cos\nsystem\n(S'true'\ntR."),
            ".mass: this is no array; save it with numpy.savez",
        ),
        (
            archive(**{f"m{n}": b"" for n in range(35)}),
            f': "b.npz" holds 35 arrays; those that are known are {KNOWN}',
        ),
    ],
)
def test_an_archive_that_is_none(tmp_path, monkeypatch, content, message):
    (tmp_path / "b.npz").write_bytes(content)
    monkeypatch.chdir(tmp_path)
    assert faults("b.npz", modes=0) == [message]


@pytest.mark.parametrize("content", [LIES, HUGE, npy(np.zeros(4))[:-3], npy(np.zeros(4))[:20], b"\x93NUMPY\x09\x00"])
def test_an_array_that_is_damaged(tmp_path, content):
    (tmp_path / "b.npz").write_bytes(archive(positions=npy(POSITIONS), mass=content))
    (line,) = faults(tmp_path / "b.npz", modes=0)
    assert line.startswith(".mass: this array is damaged: ")


def test_an_archive_that_is_damaged(tmp_path):
    np.savez_compressed(tmp_path / "b.npz", **LUMPED_BODY)
    content = bytearray((tmp_path / "b.npz").read_bytes())
    content[80:120] = bytes(40)
    (tmp_path / "b.npz").write_bytes(content)
    assert any("is damaged: " in line for line in faults(tmp_path / "b.npz"))


def test_no_array_hides_another(tmp_path):
    with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(tmp_path / "b.npz", "w") as file:
        for name, array in (("positions", POSITIONS), ("mass", LUMPED), ("mass", 2 * LUMPED)):
            file.writestr(f"{name}.npy", npy(array))
    assert faults(tmp_path / "b.npz", modes=0) == [".mass: this array is in the file twice; keep one"]


@pytest.mark.parametrize(
    ("header", "reason"),
    [
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (True, True)}", "an integer is required"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 3)}", "too large"),
        ("{[]: 1}", "unhashable"),
        ("{", "EOF in multi-line statement"),
    ],
)
def test_headers_that_numpy_does_not_expect(tmp_path, header, reason):
    text = header.encode().ljust(117) + b"\n"
    with zipfile.ZipFile(tmp_path / "b.npz", "w") as archive:
        archive.writestr("positions.npy", b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + bytes(24))
    (message, *_) = faults(tmp_path / "b.npz", modes=0)
    assert message.startswith(".positions: this array is damaged: ") and reason in message


def test_unknown_arrays_are_named(tmp_path):
    save(tmp_path, **LUMPED_BODY, stifness=STIFFNESS, colour=STIFFNESS)
    assert faults(tmp_path / "b.npz") == [
        '.stifness: unknown key; did you mean "stiffness"?',
        f".colour: unknown key; the keys here are {WITH_MESH}",
    ]


def test_what_is_too_large_is_not_read(tmp_path, monkeypatch):
    np.savez_compressed(tmp_path / "b.npz", positions=np.zeros((100, 3)), mass=np.ones(100))
    large = ", the most that is read; store matrices as the entries that are not zero"
    monkeypatch.setattr(node_files, "MAX_BYTES", 2000)
    monkeypatch.chdir(tmp_path)
    assert faults("b.npz") == [f': "b.npz" unpacks to more than 1000 MB{large}']
    monkeypatch.setattr(node_files, "MAX_BYTES", 300)
    assert faults("b.npz") == [f': the file "b.npz" has more than 0 MB{large}']


def test_there_are_limits_to_nodes_and_to_full_arrays(monkeypatch):
    monkeypatch.setattr(node_data, "MAX_NODES", 3)
    assert faults(LUMPED_BODY) == [".positions: there are 4 nodes, and at most 3 are allowed"]
    monkeypatch.undo()
    monkeypatch.setattr(node_data, "MAX_BYTES", 11 * 8)
    assert faults(LUMPED_BODY | {"positions": csr_array(POSITIONS)}) == [
        ".positions: the shape is (4, 3), which is too large for a full array"
    ]


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
