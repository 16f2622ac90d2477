"""The oracle of the source maps: the generated C read back, function by function, with regular expressions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

STORE = re.compile(r"\s*(?:h|M)\[")
DEFINE = re.compile(r"\s*(?:const )?(?:double|tisserand_lanes) \*?(\w+)(?:\[\d+\])? =")
LOAD = re.compile(r"= (?:q|v|k|p)(?:\[\d+\]| \+ \d+)?;$")
PRODUCT = re.compile(r"\s*(\w+)_l [+-]= TISSERAND_LOAD\(\w+ \+ \d+ \* j \+ l\) \* ")
ELEMENT = re.compile(r"\s*(?:TISSERAND_STORE\((\w+) \+ i \+ l, (?!\1_l\))|(\w+)\[i\] =)")
IN_LANES = re.compile(r"\s*TISSERAND_(?:STORE|SCATTER)\((h|M) \+ (\d+) \+ (?:\d+ \* \()?i \+ l")


@dataclass(frozen=True)
class Source:
    """A function of the generated C: its name, the number of its first line, and its lines."""

    name: str
    first: int
    lines: tuple[str, ...]

    @property
    def numbered(self) -> Iterator[tuple[int, str]]:
        """The lines with their numbers."""
        return enumerate(self.lines, self.first)

    @cached_property
    def stores(self) -> Mapping[tuple[str, int, bool], int]:
        """Lines by what they store: h or M, the first element, and whether it is the first of a loop over shapes."""
        found = {}
        for number, line in self.numbered:
            if match := re.match(r"\s*(?:for \([^)]*\) )?(h|M)\[(\d+)( \+ [^\]]*)?\] =", line):
                found[match[1], int(match[2]), bool(match[3])] = number
            elif (match := IN_LANES.match(line)) or (match := re.match(r"\s*double \*column = (h|M) \+ (\d+)", line)):
                found[match[1], int(match[2]), True] = number
        return found

    @cached_property
    def definitions(self) -> Mapping[str, int]:
        """The line that computes each name; of an array that is summed up over the shapes, where that happens.

        Names that are loaded from an argument have no line.
        """
        found: dict[str, int] = {}
        for number, line in self.numbered:
            match = PRODUCT.match(line) or ELEMENT.match(line) or DEFINE.match(line)
            if match and not LOAD.search(line):
                found[next(filter(None, match.groups()))] = number
        return found


@dataclass(frozen=True)
class Sources:
    """The functions of a generated C file by their names without that of the model."""

    file: str
    functions: Mapping[str, Source] = field(default_factory=dict)


def sources(file: str, text: str, model: str) -> Sources:
    """All functions of a file."""
    lines = text.splitlines()
    heads = [(k, m[1]) for k, line in enumerate(lines) if (m := re.match(rf"(?:static )?int {model}_(\w+)\($", line))]
    found = {}
    for start, name in heads:
        end = next(k for k in range(start, len(lines)) if lines[k] == "}")
        found[name] = Source(name, start + 1, tuple(lines[start : end + 1]))
    return Sources(file, found)
