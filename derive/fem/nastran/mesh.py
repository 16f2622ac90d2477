"""The mesh in bulk data of Nastran: grid points, solid elements, materials and sets of grid points."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np

from derive.errors import Problem
from derive.fem.keyword_mesh import KeywordMesh
from derive.fem.model import Array
from derive.fem.nastran.bulk_data import BulkCard, bulk_cards, real
from derive.spec.model.mesh import ElementKind, Elements, Material

_TO_VTK = {
    ElementKind.HEX20: (*range(12), *range(16, 20), *range(12, 16)),
    ElementKind.WEDGE15: (*range(9), *range(12, 15), *range(9, 12)),
}
"""The places of the nodes of VTK among those of Nastran, whose edges between the faces come before the second face."""

KINDS = {
    "CTETRA": (ElementKind.TET4, ElementKind.TET10),
    "CHEXA": (ElementKind.HEX8, ElementKind.HEX20),
    "CPENTA": (ElementKind.WEDGE6, ElementKind.WEDGE15),
}
"""The kinds of elements without and with nodes on their edges."""

T = TypeVar("T")

CARDS = ("GRID", "MAT1", "PSOLID", "SET1", *KINDS)


def read_bulk_mesh(text: str, problems: list[Problem]) -> tuple[KeywordMesh, list[int]]:
    """The mesh of bulk data, and the grid points whose positions or displacements are in a system of their own.

    Faults are added to `problems`.
    """
    cards: dict[str, list[BulkCard]] = {name: [] for name in CARDS}
    for card in bulk_cards(text, CARDS):
        cards[card.name].append(card)
    mesh, turned, points = KeywordMesh(), list[int](), dict[int, Array]()
    for card in cards["GRID"]:
        if at := _read(card, _grid_point, problems):
            points[at[0]] = at[1]
            if any(card.field(k) not in ("", "0") for k in (3, 7)):
                turned.append(at[0])
    mesh.numbers = np.array(sorted(points), dtype=np.int64)
    mesh.positions = np.array([points[n] for n in mesh.numbers.tolist()]).reshape(-1, 3)
    for card in cards["MAT1"]:
        if material := _read(card, _material, problems):
            mesh.materials[material.name] = material
    properties = {card.field(2): card.field(3) for card in cards["PSOLID"]}
    mesh.elements = _elements((card for name in KINDS for card in cards[name]), properties, problems)
    for card in cards["SET1"]:
        if members := _read(card, _members, problems):
            mesh.sets[f"set_{card.field(2)}"] = np.array(members, dtype=np.int64)
    return mesh, turned


def _read(card: BulkCard, of: Callable[[BulkCard], T], problems: list[Problem]) -> T | None:
    """The content of a card; None after a fault."""
    try:
        return of(card)
    except ValueError:
        problems.append(Problem(card.name, "a field of this card is no number", card.line))
        return None


def _grid_point(card: BulkCard) -> tuple[int, Array]:
    return int(card.field(2)), np.array([real(card.field(k) or "0") for k in (4, 5, 6)])


def _material(card: BulkCard) -> Material:
    young, shear, poisson, density = (real(text) if (text := card.field(k)) else None for k in (3, 4, 5, 6))
    if poisson is None and young and shear:
        poisson = young / (2 * shear) - 1
    return Material(f"MAT1_{card.field(2)}", young, poisson, density)


def _members(card: BulkCard) -> list[int]:
    """The numbers of a set, in which `5 THRU 8` stands for those between as well."""
    words = [text for text in card.fields[1:] if text]
    result: list[int] = []
    for k, word in enumerate(words):
        if word.upper() == "THRU":
            result += range(result[-1] + 1, int(words[k + 1]))
        else:
            result.append(int(word))
    return result


def _nodes(card: BulkCard) -> list[int]:
    return [int(text) for text in card.fields[2 : 2 + KINDS[card.name][1].node_count] if text]


def _elements(cards: Iterable[BulkCard], properties: dict[str, str], problems: list[Problem]) -> list[Elements]:
    """The elements, in blocks of one kind and one material."""
    blocks: dict[tuple[ElementKind, str], list[list[int]]] = {}
    for card in cards:
        linear, quadratic = KINDS[card.name]
        nodes = [text for text in card.fields[2 : 2 + quadratic.node_count] if text]
        kind = {linear.node_count: linear, quadratic.node_count: quadratic}.get(len(nodes))
        if kind is None:
            text = f"there are {len(nodes)} nodes, and {linear.node_count} or {quadratic.node_count} are read"
            problems.append(Problem(card.name, text, card.line))
            continue
        numbers = _read(card, _nodes, problems)
        if numbers is not None:
            ordered = [numbers[k] for k in _TO_VTK.get(kind, range(len(numbers)))]
            material = properties.get(card.field(3), "")
            blocks.setdefault((kind, f"MAT1_{material}" if material else ""), []).append(ordered)
    return [Elements(kind, np.array(nodes, dtype=np.int64), material) for (kind, material), nodes in blocks.items()]
