"""Archives of arrays that are damaged, lie about their sizes, or have unknown arrays."""

import io
import zipfile

import numpy as np
import pytest
from bodies import (
    LUMPED,
    LUMPED_BODY,
    POSITIONS,
    STIFFNESS,
    save,
)
from scipy.sparse import csr_array
from test_node_files import faults

from derive.spec.files import node_data, node_files


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
