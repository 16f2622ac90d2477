"""Lines of keys in a TOML text."""

import tomllib

import pytest

from derive.spec.parsing.faults import line_of
from derive.spec.toml.key_lines import lines

TEXT = (
    '''\
# a = 1
name = "a # b"     # [no.table]
"quoted key".'x' = """
[beam]
name = 3
""" # after
other = \'\'\'a\'\'\'\'

[ beam . "mass" ] # comment
unit = 'k"g' ; symbol = 1
'''.replace(" ; ", "\n")
    + """\
[beam]
ansatz = [ "1", 'x]i', # comment ]
  "xi, [",

  [1,
   2], { a = 1, b.c = [
   3,
 4] },
]
frame = { kind = "point", at.x = 1 }
when = 1979-05-27T07:32:00.5Z
last = -1.5e3
[[list]]
x = 1
[[list]]
"""
)

LINES = {
    ("name",): 2,
    ("quoted key",): 3,
    ("quoted key", "x"): 3,
    ("other",): 7,
    ("beam", "mass"): 9,
    ("beam", "mass", "unit"): 10,
    ("beam", "mass", "symbol"): 11,
    ("beam",): 12,
    ("beam", "ansatz"): 13,
    ("beam", "ansatz", 0): 13,
    ("beam", "ansatz", 1): 13,
    ("beam", "ansatz", 2): 14,
    ("beam", "ansatz", 3): 16,
    ("beam", "ansatz", 3, 0): 16,
    ("beam", "ansatz", 3, 1): 17,
    ("beam", "ansatz", 4): 17,
    ("beam", "ansatz", 4, "a"): 17,
    ("beam", "ansatz", 4, "b"): 17,
    ("beam", "ansatz", 4, "b", "c"): 17,
    ("beam", "ansatz", 4, "b", "c", 0): 18,
    ("beam", "ansatz", 4, "b", "c", 1): 19,
    ("beam", "frame"): 21,
    ("beam", "frame", "kind"): 21,
    ("beam", "frame", "at"): 21,
    ("beam", "frame", "at", "x"): 21,
    ("beam", "when"): 22,
    ("beam", "last"): 23,
    ("list",): 24,
    ("list", "x"): 25,
}


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_every_key_and_element_has_its_line(newline):
    tomllib.loads(TEXT)
    assert lines(TEXT.replace("\n", newline)) == LINES


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("beam", "frame", "kind"), 21),
        (("beam", "frame", "missing"), 21),
        (("beam", "missing", "deeper"), 12),
        (("beam", "ansatz", 9), 13),
        (("missing",), None),
        ((), None),
    ],
)
def test_a_path_without_a_line_has_that_of_the_nearest_enclosing_key(path, line):
    assert line_of(path, LINES) == line


@pytest.mark.parametrize(
    "text", ["", "a", "a = ", "= 1", "[", "[a", 'a = "', "a = [1,, 2]", "a = {", "a." * 99, "\x00"]
)
def test_text_that_is_not_toml_gives_no_exception(text):
    lines(text)


def test_nesting_that_no_specification_has_is_not_followed():
    text = "a = 1\nb = " + "[" * 5000 + "]" * 5000
    assert line_of(("b", 0, 0), lines(text)) == 2
