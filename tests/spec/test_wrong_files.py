"""Files that are no specifications: text that is no TOML, floods of faults, and files that cannot be read."""

import os

import pytest
from test_faults import beam, errors

from derive.errors import Problem, SpecError
from derive.spec.toml.read import MAX_BYTES, parse, read


@pytest.mark.parametrize(
    ("text", "start"),
    [
        ("name = ", "b.toml:1: this is not TOML: "),
        ('name = "b"\n[beam\n', "b.toml:2: this is not TOML: "),
        ('name = "b"\nname = "c"\n[beam]', "b.toml:2: name: it is in line 1 already; keep one of them"),
        ('name = "b"\n[beam]\nlength = 1\n\nlength = 2', "b.toml:5: beam.length: it is in line 3 already"),
        ('name = "b"\n[beam]\nlength = 1\n[beam]\n', "b.toml:4: beam: it is in line 2 already"),
        ('name = "b"\nbeam.length = 1\n[beam]\n', "b.toml:3: beam: it is in line 2 already"),
        ('name = "b"\n[beam.markers]\na = 1\n[beam]\nmarkers = {}', "b.toml:5: beam.markers: it is in line 2 already"),
        ('name = "b"\n[beam]\nmarkers = { a = 1,\n', "b.toml:3: this is not TOML: "),
        ("[beam]\ndamping = { ratio = 1, ratio = 2 }", "b.toml:2: beam.damping.ratio: it is in line 2 already"),
        ('[beam]\nansatz = [\n"1"]\nansatz = [\n"1",\n"xi"]', "b.toml:4: beam.ansatz: it is in line 2 already"),
        ('name = "b"\n\n[beam]\nansatz = ["1"\n\n', "b.toml:4: this is not TOML: "),
        ('name = "b"\nx = "\x00"', "b.toml:2: this is not TOML: "),
        ("x = " + "[" * 100_000, "b.toml: the brackets are nested too deeply"),
        ("x = " + "9" * 5000, "b.toml: a number has too many digits"),
        ("\n" + "a." * 50_000 + "a = 1", "b.toml:2: this line has more than 200 dots; break it into several lines"),
    ],
)
def test_text_that_is_not_toml_is_one_problem(text, start):
    (line,) = errors(text)
    assert line.startswith(start)


def test_a_ruler_of_dots_in_a_comment_is_no_fault():
    assert parse(f"# {'.' * 300}\n" + beam("")).name == "b"


def test_a_flood_of_faults_is_cut_short():
    lines = errors(beam("\n".join(f"k{n} = 0" for n in range(500))))
    assert len(lines) == 101
    assert lines[0] == "b.toml: 400 more problems are not shown"


def problems_of_file(path):
    with pytest.raises(SpecError) as caught:
        read(path)
    assert caught.value.source == str(path)
    return caught.value.problems


def test_files_that_cannot_be_read(tmp_path):
    (tmp_path / "large.toml").write_bytes(b"#" * (MAX_BYTES + 1))
    (tmp_path / "latin.toml").write_bytes(b'# a\nname = "L\xe4nge"')
    os.mkfifo(tmp_path / "pipe.toml")
    assert problems_of_file(tmp_path / "none.toml") == (
        Problem("", "the file cannot be read: no such file or directory"),
    )
    assert problems_of_file(tmp_path)[0].message.startswith("the file cannot be read: ")
    assert problems_of_file(tmp_path / "pipe.toml") == (
        Problem("", "the file cannot be read: it is a pipe or a device, not a file"),
    )
    assert problems_of_file("a\0b")[0].message.startswith("the file cannot be read: ")
    assert problems_of_file(tmp_path / "large.toml") == (
        Problem("", "the file is larger than 1000000 bytes; is it a specification?"),
    )
    assert problems_of_file(tmp_path / "latin.toml") == (
        Problem("", "this is not UTF-8 text; save the file as UTF-8", 2),
    )
