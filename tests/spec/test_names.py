"""Names that can stand in C, C++, Python and file names."""

import keyword

import pytest

from derive.spec.parsing.names import name_problem


@pytest.mark.parametrize("text", ["m", "EI", "free_beam_mean", "a1_b2", "A" * 40, "xi", "q", "integer", "Double"])
def test_a_name_is_accepted(text):
    assert name_problem(text) is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", '"" cannot be a name: it is empty; write one such as "beam_1"'),
        ("double", '"double" cannot be a name: it is a word of C; try "double_0"'),
        ("class", '"class" cannot be a name: it is a word of C++; try "class_0"'),
        ("lambda", '"lambda" cannot be a name: it is a word of Python; try "lambda_0"'),
        ("match", '"match" cannot be a name: it is a word of Python; try "match_0"'),
        ("sin", '"sin" cannot be a name: it is taken by a library or a system; try "sin_0"'),
        ("NULL", '"NULL" cannot be a name: it is taken by a library or a system; try "NULL_0"'),
        ("2nd", '"2nd" cannot be a name: it must begin with a letter; try "n2nd"'),
        ("_a", '"_a" cannot be a name: it must begin with a letter; try "a"'),
        ("a__b", '"a__b" cannot be a name: two _ in a row are reserved in C++; try "a_b"'),
        ("a_", '"a_" cannot be a name: it must end with a letter or a digit; try "a"'),
        (
            "Länge 1",
            '"Länge 1" cannot be a name: only the letters a to z and A to Z, digits and _ are allowed; try "Lange_1"',
        ),
        (
            "x; system()",
            '"x; system()" cannot be a name: only the letters a to z and A to Z, digits and _ are allowed; '
            'try "x_system"',
        ),
        (
            "m\n",
            '"m\\n" cannot be a name: only the letters a to z and A to Z, digits and _ are allowed; try "m"',
        ),
        (
            "²",
            '"²" cannot be a name: only the letters a to z and A to Z, digits and _ are allowed; try "n2"',
        ),
        ("A" * 41, f'"{"A" * 41}" cannot be a name: it has 41 characters, and 40 are allowed; try "{"A" * 38}"'),
    ],
)
def test_a_problem_says_why_and_what_instead(text, message):
    assert name_problem(text) == message


@pytest.mark.parametrize("text", ["for_", "__", "1", "é", "for", "12_3__4", "if else", "x" * 99, "1" * 99, "a_" * 30])
def test_what_is_suggested_is_a_name(text):
    problem = name_problem(text)
    assert problem is not None
    if "; try " in problem:
        assert name_problem(problem.split('"')[-2]) is None


@pytest.mark.parametrize("word", [*keyword.kwlist, "match", "case", "type", "_"])
def test_words_of_python_are_refused(word):
    assert name_problem(word)


@pytest.mark.parametrize("name", ["tisserand", "Tisserand", "TISSERAND"])
def test_the_prefix_of_our_own_macros_is_taken(name: str) -> None:
    assert "is taken by a library or a system" in (name_problem(name) or "")
