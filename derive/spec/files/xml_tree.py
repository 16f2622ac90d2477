"""XML as a tree of elements with their lines, read by the parser of the standard library without entities of documents.

What a document declares in a DTD is refused: entities can name files and grow without bound.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from derive.errors import Problem, SpecError, TisserandError, printable
from derive.spec.files.file_content import specification_bytes

MAX_BYTES = 20_000_000
MAX_DEPTH = 100


@dataclass(frozen=True)
class XmlElement:
    """An element: its tag, its attributes, its line from 1, the elements inside, and pieces of its text, where kept."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[XmlElement] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The text directly inside; empty where it is not kept."""
        return "".join(self.pieces)

    def all(self, tag: str) -> Iterator[XmlElement]:
        """The elements with this tag directly inside."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> XmlElement | None:
        """The first element with this tag directly inside; None if there is none."""
        return next(self.all(tag), None)

    def below(self, tag: str) -> Iterator[XmlElement]:
        """The elements with this tag at any depth, in the order of the document."""
        for child in self.children:
            if child.tag == tag:
                yield child
            yield from child.below(tag)


class _RefusedError(TisserandError):
    """Ends the parser of expat, which has no other way to stop; never leaves this module."""


def read_xml(path: str | os.PathLike[str]) -> XmlElement:
    """The root element of a file. Raises SpecError: no file, no XML, too large, too deep, or with a DTD."""
    source = os.fsdecode(path)
    too_large = f"the file has more than {MAX_BYTES // 1_000_000} MB, the most that is read"
    return parse_xml(specification_bytes(source, MAX_BYTES, too_large), source)


def parse_xml(content: bytes, source: str | None = None, keep_text: bool = False) -> XmlElement:
    """The root element of a document; `source` is the file that errors show. Raises SpecError as `read_xml`."""
    parser = expat.ParserCreate()
    parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
    open_elements: list[XmlElement] = []
    roots: list[XmlElement] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if len(open_elements) == MAX_DEPTH:
            raise _RefusedError(f"elements are nested more than {MAX_DEPTH} deep")
        element = XmlElement(tag, attributes, parser.CurrentLineNumber)
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def end(_: str) -> None:
        open_elements.pop()

    def characters(piece: str) -> None:
        open_elements[-1].pieces.append(piece)

    def doctype(*_: object) -> None:
        raise _RefusedError(
            "a document type (<!DOCTYPE ...>) is not read, since its entities may name files; remove it"
        )

    if keep_text:
        parser.buffer_text = True
        parser.CharacterDataHandler = characters
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        why = printable(expat.errors.messages[error.code])
        if error.code == expat.errors.codes[expat.errors.XML_ERROR_INVALID_TOKEN] and not _is_utf_8(content):
            why += "; it is not in UTF-8, so save it in that, or name its encoding in the first line"
        text = f"this is no XML: {why}, column {error.offset + 1}"
        raise SpecError((Problem("", text, error.lineno),), source) from None
    except _RefusedError as error:
        raise SpecError((Problem("", str(error), parser.CurrentLineNumber),), source) from None
    except (ValueError, LookupError) as error:
        text = f"the file names an encoding that is not read ({printable(str(error))}); save it in UTF-8"
        raise SpecError((Problem("", text, parser.CurrentLineNumber),), source) from None
    (root,) = roots
    return root


def _is_utf_8(content: bytes) -> bool:
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True
