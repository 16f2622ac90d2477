"""The names that a specification may use: they are valid in C, C++, Python and file names."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection

from derive.errors import quoted

MAX_LENGTH = 40
PATTERN = "[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*"
INDEX = "i"
"""The name of the index of tables with a count."""
NO_INDEX = "it is the index in tables with `count`, and this table has none"
"""The hint where the index is unknown."""
INDEX_PATTERN = r"\[(0|[1-9][0-9]{0,4})\]"
"""The index behind the name of an instance, as in link[3]."""

# The lists are written out, not asked of the running Python, so that every version accepts the same names.
_C = """
    auto break case char const continue default do double else enum extern float for goto if inline int
    long register restrict return short signed sizeof static struct switch typedef union unsigned void
    volatile while asm
"""
_CPP = """
    alignas alignof and and_eq asm bitand bitor bool catch char8_t char16_t char32_t class co_await
    co_return co_yield compl concept const_cast consteval constexpr constinit decltype delete
    dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr operator
    or or_eq private protected public reinterpret_cast requires static_assert static_cast template this
    thread_local throw true try typeid typename using virtual wchar_t xor xor_eq
"""
_PYTHON = """
    False None True and as assert async await break class continue def del elif else except finally for
    from global if import in is lambda nonlocal not or pass raise return try while with yield match case
    type
"""
# Functions of <math.h> and macros of the standard headers, which a variable of the name would hide or break;
# and con, nul, aux and prn, which cannot be file names everywhere.
_TAKEN = """
    main acos asin atan atan2 cbrt ceil copysign cos cosh erf exp exp2 expm1 fabs floor fma fmax fmin
    fmod frexp hypot ldexp log log10 log1p log2 pow round sin sinh sqrt tan tanh trunc abs
    tisserand math numpy typing
    NULL EOF INFINITY NAN HUGE_VAL M_PI errno stdin stdout stderr unix linux con nul aux prn
"""
_RESERVED = {
    **dict.fromkeys(_TAKEN.split(), "is taken by a library or a system"),
    **dict.fromkeys(_PYTHON.split(), "is a word of Python"),
    **dict.fromkeys(_CPP.split(), "is a word of C++"),
    **dict.fromkeys(_C.split(), "is a word of C"),
}


def name_problem(text: str) -> str | None:
    """The reason why `text` cannot be a name in the generated code, with an alternative; None if it can."""
    why = _why_not(text)
    return why and f"{quoted(text)} cannot be a name: {why}; {_suggestion(text)}"


def element_name_problem(text: str) -> str | None:
    """The reason why `text` cannot be the name of an element of a scene, which may have an index behind it."""
    index = re.search(f"{INDEX_PATTERN}$", text)
    return name_problem(text[: index.start()] if index else text)


def _why_not(text: str) -> str | None:
    if not text:
        return "it is empty"
    if len(text) > MAX_LENGTH:
        return f"it has {len(text)} characters, and {MAX_LENGTH} are allowed"
    if not re.fullmatch("[A-Za-z0-9_]+", text):
        return "only the letters a to z and A to Z, digits and _ are allowed"
    if not text[0].isalpha():
        return "it must begin with a letter"
    if "__" in text:
        return "two _ in a row are reserved in C++"
    if text.endswith("_"):
        # Names are joined by _ to longer ones.
        return "it must end with a letter or a digit"
    if text in _RESERVED or text.lower() == "tisserand":  # macros begin with TISSERAND
        return f"it {_RESERVED.get(text, _RESERVED['tisserand'])}"
    return None


def free_name(text: str, taken: Collection[str]) -> str:
    """A name like `text` that is allowed and, also in lower case, not taken."""
    name = text if _why_not(text) is None else _similar(text) or "part"
    number, stem = 2, name[: MAX_LENGTH - 4].rstrip("_")
    while name.lower() in taken:
        name, number = f"{stem}_{number}", number + 1
    return name


def _suggestion(text: str) -> str:
    name = _similar(text)
    return f'try "{name}"' if name else 'write one such as "beam_1"'


def _similar(text: str) -> str:
    """A name that resembles a text; empty where the text has no letters or digits."""
    ascii_text = unicodedata.normalize("NFKD", text[: 4 * MAX_LENGTH]).encode("ascii", "ignore").decode()
    words = re.findall("[A-Za-z0-9]+", ascii_text)
    name = "_".join(words)[: MAX_LENGTH - 2].rstrip("_")
    if name and not name[0].isalpha():
        name = f"n{name}"
    return f"{name}_0" if name in _RESERVED else name
