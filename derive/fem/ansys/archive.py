"""The mesh in an archive of ANSYS that CDWRITE makes: NBLOCK, EBLOCK, components of nodes, and materials."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from derive.errors import Problem
from derive.fem.keyword_mesh import KeywordMesh
from derive.fem.model import Array
from derive.spec.model.mesh import ElementKind, Elements, Material

KINDS = {
    "185": ElementKind.HEX8,
    "45": ElementKind.HEX8,
    "186": ElementKind.HEX20,
    "95": ElementKind.HEX20,
    "187": ElementKind.TET10,
    "92": ElementKind.TET10,
    "285": ElementKind.TET4,
}
"""Solid elements by the numbers of their types; the order of their nodes is that of VTK."""

PROPERTIES = {"EX": "young", "PRXY": "poisson", "NUXY": "poisson", "DENS": "density"}

_LAYOUT = re.compile(r"\((\d+)i(\d+)(?:,\d+e(\d+))?", re.IGNORECASE)


def read_archive(text: str, problems: list[Problem]) -> KeywordMesh:
    """The mesh of an archive; faults are added to `problems`."""
    lines = text.splitlines()
    mesh, types, materials = KeywordMesh(), dict[str, str](), dict[str, dict[str, float]]()
    number = 0
    while number < len(lines):
        words = [word.strip() for word in lines[number].split(",")]
        try:
            match words[0].upper():
                case "NBLOCK":
                    _nodes(mesh, lines, number + 1)
                case "EBLOCK":
                    _elements(mesh, lines, number + 1, types)
                case "ET":
                    types[words[1]] = words[2].upper().removeprefix("SOLID")
                case "CMBLOCK" if words[2].upper().startswith("NODE"):
                    mesh.sets[words[1]] = _component(lines, number + 1, int(words[3].split()[0]))
                case "MP" if words[1].upper() in PROPERTIES:
                    materials.setdefault(words[2], {})[PROPERTIES[words[1].upper()]] = float(words[3])
                case "MPDATA" if words[3].upper() in PROPERTIES:
                    materials.setdefault(words[4], {})[PROPERTIES[words[3].upper()]] = float(words[6])
        except (ValueError, IndexError):
            problems.append(
                Problem(words[0].upper(), "these lines cannot be read; write the archive again", number + 1)
            )
        number += 1
    mesh.materials = {f"MAT_{key}": Material(f"MAT_{key}", **values) for key, values in materials.items()}
    if not len(mesh.numbers):
        problems.append(Problem("", "there are no nodes (NBLOCK); write the archive with CDWRITE,DB,part,cdb"))
    return mesh


def _layout(line: str) -> tuple[int, int, int]:
    """The number of whole numbers at the beginning of each line, their width, and that of the real ones."""
    found = _LAYOUT.search(line)
    if found is None:
        raise ValueError(line)
    return int(found[1]), int(found[2]), int(found[3] or 0)


def _nodes(mesh: KeywordMesh, lines: list[str], first: int) -> None:
    """Nodes with their coordinates, of which those at the end of a line are zero where they are missing."""
    count, width, real = _layout(lines[first])
    numbers, positions = list[int](), list[Array]()
    for line in lines[first + 1 :]:
        if not line.strip() or line.lstrip()[0] in "N-":
            break
        numbers.append(int(line[:width]))
        rest = line[count * width :]
        at = [float(part) if (part := rest[k : k + real].strip()) else 0.0 for k in range(0, 3 * real, real)]
        positions.append(np.array(at))
    order = np.argsort(numbers)
    mesh.numbers = np.array(numbers, dtype=np.int64)[order]
    mesh.positions = np.array(positions)[order]


def _elements(mesh: KeywordMesh, lines: list[str], first: int, types: dict[str, str]) -> None:
    """Elements with all different nodes; others, and other types, are counted."""
    _, width, _ = _layout(lines[first])
    blocks: dict[tuple[ElementKind, str], list[list[int]]] = {}
    for words in _element_lines(lines[first + 1 :], width):
        kind, nodes = KINDS.get(types.get(str(words[1]), "")), words[11:]
        if kind is None or len(nodes) != kind.node_count or len({*nodes}) < len(nodes):
            name = types.get(str(words[1]), "unknown")
            mesh.other_elements[f"SOLID{name}" if kind is None else f"SOLID{name} with nodes that coincide"] += 1
            continue
        blocks.setdefault((kind, f"MAT_{words[0]}"), []).append(nodes)
    mesh.elements += [Elements(kind, np.array(of, dtype=np.int64), own) for (kind, own), of in blocks.items()]


def _element_lines(lines: list[str], width: int) -> Iterator[list[int]]:
    """Yield the numbers of each element: 11 of its own, of which the ninth counts its nodes, and these nodes."""
    words: list[int] = []
    for line in lines:
        if line.strip().startswith("-1"):
            return
        words += [int(line[k : k + width]) for k in range(0, len(line.rstrip()), width)]
        if len(words) >= 11 + words[8]:
            yield words
            words = []


def _component(lines: list[str], first: int, count: int) -> np.ndarray:
    """The nodes of a component, in which a negative number ends a range that the one before it begins."""
    _, width, _ = _layout(lines[first])
    words: list[int] = []
    for line in lines[first + 1 :]:
        if len(words) >= count:
            break
        words += [int(line[k : k + width]) for k in range(0, len(line.rstrip()), width)]
    result: list[int] = []
    for word in words[:count]:
        result += range(result[-1] + 1, -word + 1) if word < 0 else (word,)
    return np.array(result, dtype=np.int64)
