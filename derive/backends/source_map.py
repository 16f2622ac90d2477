"""The line of each statement of a model in an emitted file: a typed map that is made while the file is printed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from derive.artifacts import File
from derive.ir.kernel import Kernel, Section
from derive.ir.model import Model, ModelTerm
from derive.ir.statements import Statement


@dataclass(frozen=True)
class StoredValue:
    """The value that a line writes: element `index` of an output, or the first one that a loop over modes writes."""

    output: str
    index: int
    over_modes: bool = False


@dataclass(frozen=True)
class SourceLine:
    """A line of a function.

    stores: the value that the line writes to an output; defines: the scalar or the local array that it computes. A
    statement of several lines stores or defines in the first of them. section and statement are the indices of the
    section in its kernel and of the statement in its section; None for lines that belong to no statement. terms: the
    terms of the equations of motion that the value is made of, if the line stores a value of M or h.
    """

    text: str
    stores: StoredValue | None = None
    defines: str | None = None
    section: int | None = None
    statement: int | None = None
    terms: tuple[ModelTerm, ...] = ()

    def indented(self) -> SourceLine:
        """The line, one step further to the right; an empty line stays empty."""
        text = f"    {self.text}" if self.text else ""
        return SourceLine(text, self.stores, self.defines, self.section, self.statement, self.terms)

    def of(self, section: int, statement: int) -> SourceLine:
        """The line as a part of a statement."""
        return SourceLine(self.text, self.stores, self.defines, section, statement, self.terms)


def plain(*texts: str) -> list[SourceLine]:
    """Lines that neither store nor define anything."""
    return [SourceLine(text) for text in texts]


def storing(texts: Iterable[str], output: str, index: int, over_modes: bool = False) -> list[SourceLine]:
    """The lines of a statement that writes to an output."""
    first, *rest = texts
    return [SourceLine(first, stores=StoredValue(output, index, over_modes)), *map(SourceLine, rest)]


def defining(texts: Iterable[str], name: str) -> list[SourceLine]:
    """The lines of a statement that computes a scalar or a local array."""
    first, *rest = texts
    return [SourceLine(first, defines=name), *map(SourceLine, rest)]


@dataclass(frozen=True)
class FunctionLines:
    """The lines of the function of one kernel, from its signature to its end; of a long one, with its parts before it.

    first: the number of its first line in the file, from 1.
    """

    kernel: Kernel
    first: int
    lines: tuple[SourceLine, ...]

    @property
    def name(self) -> str:
        """The name of the kernel."""
        return self.kernel.name

    @property
    def last(self) -> int:
        """The number of the last line of the function."""
        return self.first + len(self.lines) - 1

    @property
    def numbered(self) -> Iterator[tuple[int, SourceLine]]:
        """The lines with their numbers."""
        return enumerate(self.lines, self.first)

    def section(self, line: SourceLine) -> Section | None:
        """The section that a line belongs to."""
        return None if line.section is None else self.kernel.sections[line.section]

    def statement(self, line: SourceLine) -> Statement | None:
        """The statement that a line belongs to."""
        section = self.section(line)
        return None if section is None or line.statement is None else section.body[line.statement]

    @cached_property
    def stores(self) -> Mapping[StoredValue, int]:
        """The number of the line that writes each value."""
        return {line.stores: number for number, line in self.numbered if line.stores}

    @cached_property
    def definitions(self) -> Mapping[str, int]:
        """The number of the line that computes each name; of an array that is summed up, where that ends.

        Names that are loaded from an argument have no line.
        """
        return {line.defines: number for number, line in self.numbered if line.defines}


@dataclass(frozen=True)
class SourceMap:
    """The functions of an emitted file by the names of their kernels.

    language: the name of the backend; path: that of the file.
    """

    language: str
    path: str
    functions: Mapping[str, FunctionLines]


@dataclass(frozen=True, repr=False)
class SourceFile(File):
    """An emitted file with its source map."""

    source_map: SourceMap


class SourceBuilder:
    """A file of a model in the making: texts and functions, one after the other, with the numbers of their lines."""

    def __init__(self, model: Model) -> None:
        self._terms: dict[tuple[str, int], tuple[ModelTerm, ...]] = {}
        for term in model.terms:
            for key in (*(("M", k) for k in term.mass), *(("h", k) for k in term.force)):
                self._terms[key] = (*self._terms.get(key, ()), term)
        self._texts: list[str] = []
        self._lines = 0
        self._functions: dict[str, FunctionLines] = {}

    def text(self, text: str) -> None:
        """Add text that belongs to no kernel."""
        self._texts.append(text)
        self._lines += text.count("\n")

    def function(self, kernel: Kernel, lines: Iterable[SourceLine]) -> None:
        """Add the function of a kernel, on lines of its own."""
        function = FunctionLines(kernel, self._lines + 1, tuple(self._with_terms(line) for line in lines))
        self._functions[kernel.name] = function
        self.text("".join(f"{line.text}\n" for line in function.lines))

    def _with_terms(self, line: SourceLine) -> SourceLine:
        terms = self._terms.get((line.stores.output, line.stores.index)) if line.stores else None
        return replace(line, terms=terms) if terms else line

    def file(self, language: str, path: str) -> SourceFile:
        """The finished file, with its source map."""
        return SourceFile(path, "".join(self._texts), SourceMap(language, path, self._functions))


def source_map(files: Iterable[File], language: str) -> SourceMap:
    """The source map of the file that the backend of a language emitted. Raises ValueError if there is none."""
    for file in files:
        if isinstance(file, SourceFile) and file.source_map.language == language:
            return file.source_map
    raise ValueError(f"no file of the backend {language!r} is among these files")
