"""The mesh of an input file of keywords: nodes, sets, solid elements, and their materials."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from derive.errors import Problem, SpecError, quoted
from derive.fem.keyword_file import Card, numbers_of, read_cards
from derive.fem.model import Array, Indices
from derive.solids.element_shapes import element_shape
from derive.spec.model.mesh import ElementKind, Elements, Material
from derive.spec.parsing.faults import did_you_mean

KINDS = {
    "C3D4": ElementKind.TET4,
    "C3D10": ElementKind.TET10,
    "C3D8": ElementKind.HEX8,
    "C3D20": ElementKind.HEX20,
    "C3D6": ElementKind.WEDGE6,
    "C3D15": ElementKind.WEDGE15,
}
"""Solid elements, whose nodes have the order of VTK; letters behind these names choose the integration."""

READ = (
    *("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "MATERIAL", "ELASTIC", "DENSITY", "SOLID SECTION"),
    *("HEADING", "INCLUDE"),
)
"""The keywords that are read."""

FACES = {
    4: ((1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)),
    6: ((1, 2, 3), (4, 5, 6), (1, 2, 5, 4), (2, 3, 6, 5), (3, 1, 4, 6)),
    8: ((1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)),
}
"""The corners of the faces S1, S2, ... of elements, by the number of their corners."""

OF_STEPS = ("STEP", "END STEP", "FREQUENCY", "NODE FILE", "EL FILE", "NODE PRINT", "EL PRINT", "OUTPUT", "NODE OUTPUT")
"""The keywords that choose what a program computes and writes, of which nothing is lost."""

LARGEST_NUMBER = 2**53


@dataclass(frozen=True)
class RigidNodes:
    """A set of nodes that moves as a rigid body: its name, the numbers of its reference node and of the node of its
    rotations, 0 if the program chooses it, and the line of the card."""

    name: str
    reference: int
    rotation: int
    line: int


@dataclass
class KeywordMesh:
    """The contents of the cards of a file: nodes by their numbers, in the order of the file.

    sets: numbers of nodes by the names of sets in capital letters; names: these names as written. elements: blocks
    whose nodes are numbers of nodes. other_elements: how many elements of other types there are. cards: the keywords
    that are not read, with the line of the first of each and how many there are. unknown: how many numbers of sets are
    no nodes. rigid_bodies: those of sets of nodes.
    """

    numbers: Indices = field(default_factory=lambda: np.zeros(0, np.int64))
    positions: Array = field(default_factory=lambda: np.zeros((0, 3)))
    sets: dict[str, Indices] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    elements: list[Elements] = field(default_factory=list)
    materials: dict[str, Material] = field(default_factory=dict)
    other_elements: Counter[str] = field(default_factory=Counter)
    cards: dict[str, tuple[int, int]] = field(default_factory=dict)
    unknown: int = 0
    rigid_bodies: list[RigidNodes] = field(default_factory=list)


def read_mesh(path: Path) -> KeywordMesh:
    """The mesh of a file and of those that it includes. Raises SpecError with all its faults."""
    problems: list[Problem] = []
    reader = _Reader(problems)
    for card in read_cards(path, problems):
        reader.read(card)
    if not problems and not len(reader.mesh.numbers):
        problems.append(Problem("", "there are no nodes: *NODE is missing"))
    mesh = reader.finished()
    if problems:
        raise SpecError(tuple(sorted(problems, key=lambda p: p.line or 0)), str(path))
    return mesh


@dataclass(frozen=True)
class _Block:
    """The elements of one card, by numbers: labels (n,), nodes (n, nodes of an element)."""

    kind: ElementKind
    labels: Indices
    nodes: Indices


class _Reader:
    """Collects what the cards contain, and their faults."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems
        self.mesh = KeywordMesh()
        self.blocks: list[_Block] = []
        self.element_sets: dict[str, Indices] = {}
        self.sections: list[tuple[str, str]] = []
        self.surfaces: list[Card] = []
        self.material = ""

    def read(self, card: Card) -> None:
        """Read one card."""
        match card.keyword:
            case "NODE":
                self.nodes(card)
            case "ELEMENT":
                self.elements(card)
            case "NSET":
                self.add(self.mesh.sets, self.named(card, "NSET"), self.members(card, self.mesh.sets))
            case "ELSET":
                self.add(self.element_sets, self.named(card, "ELSET"), self.members(card, self.element_sets))
            case "SURFACE":
                self.surfaces.append(card)
            case "MATERIAL":
                self.material = self.named(card, "NAME")
                self.mesh.materials[self.material] = Material(self.material)
            case "ELASTIC" | "DENSITY":
                self.property(card)
            case "SOLID SECTION":
                self.sections.append((self.named(card, "ELSET"), self.named(card, "MATERIAL")))
            case "RIGID BODY":
                self.rigid_body(card)
            case keyword if keyword not in (*READ, *OF_STEPS):
                line, count = self.mesh.cards.get(keyword, (card.line, 0))
                self.mesh.cards[keyword] = (line, count + 1)

    def named(self, card: Card, parameter: str) -> str:
        """The name that a parameter gives, in capital letters, since programs do not distinguish them."""
        name = card.parameters.get(parameter, "")
        if not name:
            self.problems.append(card.fault(f"the parameter {parameter}= is missing"))
        self.mesh.names.setdefault(name.upper(), name)
        return name.upper()

    def add(self, sets: dict[str, Indices], name: str, numbers: Indices) -> None:
        """Add numbers to a set, which may be given by several cards."""
        sets[name] = np.unique(np.concatenate([sets.get(name, np.zeros(0, np.int64)), numbers]))

    def nodes(self, card: Card) -> None:
        """Nodes with their coordinates; those that are left out are zero."""
        counts = {line.rstrip(", ").count(",") for line in card.lines}
        if counts - {3} and counts <= {0, 1, 2, 3}:
            zeros = (",0" * (3 - line.rstrip(", ").count(",")) for line in card.lines)
            card.lines[:] = [line.rstrip(", ") + more for line, more in zip(card.lines, zeros, strict=True)]
        values = numbers_of(card, self.problems)
        if values is None:
            return
        if values.size % 4 or values.size != 4 * len(card.lines):
            self.problems.append(card.fault("a line holds the number of a node and its three coordinates"))
            return
        rows = values.reshape(-1, 4)
        if (numbers := self.whole(card, rows[:, 0])) is None:
            return
        if not np.isfinite(rows).all():
            self.problems.append(card.fault("a coordinate is infinite or no number"))
            return
        self.mesh.numbers = np.concatenate([self.mesh.numbers, numbers])
        self.mesh.positions = np.concatenate([self.mesh.positions, rows[:, 1:]])
        if "NSET" in card.parameters:
            self.add(self.mesh.sets, self.named(card, "NSET"), numbers)

    def elements(self, card: Card) -> None:
        """Solid elements; others are counted."""
        given = card.parameters.get("TYPE", "").upper()
        name = next((name for name in sorted(KINDS, key=len, reverse=True) if given.startswith(name)), None)
        suffix = given.removeprefix(name or "")
        if name is None or suffix.strip("RIHMTLBS"):
            self.mesh.other_elements[given or "without a type"] += len(card.lines)
            return
        kind = KINDS[name]
        values = numbers_of(card, self.problems)
        if values is None or (numbers := self.whole(card, values)) is None:
            return
        if numbers.size % (kind.node_count + 1):
            text = f"an element of the type {given} is its number and the numbers of its {kind.node_count} nodes"
            self.problems.append(card.fault(text))
            return
        rows = numbers.reshape(-1, kind.node_count + 1)
        self.blocks.append(_Block(kind, rows[:, 0], rows[:, 1:]))
        if "ELSET" in card.parameters:
            self.add(self.element_sets, self.named(card, "ELSET"), rows[:, 0])

    def whole(self, card: Card, values: Array) -> Indices | None:
        """Whole positive numbers, which nodes and elements have; None after a fault."""
        if not (np.isfinite(values).all() and (values == np.floor(values)).all() and (values > 0).all()):
            self.problems.append(card.fault("the numbers of nodes and elements are whole and positive"))
            return None
        if values.max(initial=0) >= LARGEST_NUMBER:
            self.problems.append(card.fault("a number of a node or an element is too large"))
            return None
        return values.astype(np.int64)

    def members(self, card: Card, sets: dict[str, Indices]) -> Indices:
        """The numbers in a set: listed, generated, or those of other sets."""
        if "GENERATE" in card.parameters:
            values = [numbers_of(replace(card, lines=[line]), []) for line in card.lines]
            if any(row is None or not 2 <= row.size <= 3 or (row.size == 3 and row[2] < 1) for row in values):
                self.problems.append(card.fault("GENERATE needs lines with first, last and step: 1, 100, 1"))
                return np.zeros(0, np.int64)
            spans = [(int(r[0]), int(r[1]), int(r[2]) if r.size == 3 else 1) for r in values if r is not None]
            if any(last - first > 10**8 for first, last, _ in spans):
                self.problems.append(card.fault("GENERATE makes too many numbers"))
                return np.zeros(0, np.int64)
            return np.concatenate([np.arange(a, b + 1, step, dtype=np.int64) for a, b, step in spans] or [[]])  # type: ignore[list-item]
        result: list[Indices] = []
        for text in (part.strip() for line in card.lines for part in line.split(",")):
            if text.isdecimal():
                result.append(np.array([int(text)], np.int64))
            elif text.upper() in sets:
                result.append(sets[text.upper()])
            elif text:
                hint = did_you_mean(text, [self.mesh.names.get(name, name) for name in sets])
                self.problems.append(card.fault(f"there is no set {quoted(text)} before this line{hint}"))
        return np.concatenate(result) if result else np.zeros(0, np.int64)

    def property(self, card: Card) -> None:
        """Elastic constants or the density of the material above; at several temperatures the first ones count."""
        values = numbers_of(card, self.problems)
        if values is None or not self.material:
            return
        if card.keyword == "DENSITY":
            self.change(density=values[0] if values.size else None)
        elif card.parameters.get("TYPE", "ISO").upper().startswith("ISO") and values.size >= 2:
            self.change(young=values[0], poisson=values[1])
        else:
            self.mesh.cards.setdefault(f"ELASTIC, TYPE={card.parameters.get('TYPE', '')}", (card.line, 1))

    def change(self, **properties: float | None) -> None:
        """Set properties of the last material."""
        material = self.mesh.materials[self.material]
        values = {"young": material.young, "poisson": material.poisson, "density": material.density, **properties}
        self.mesh.materials[self.material] = Material(
            material.name, **{k: None if v is None else float(v) for k, v in values.items()}
        )

    def finished(self) -> KeywordMesh:
        """The mesh, after checks of what refers to nodes; a node that is given twice has its last position."""
        mesh = self.mesh
        backwards = np.unique(mesh.numbers[::-1], return_index=True)[1]
        last = np.sort(len(mesh.numbers) - 1 - backwards)
        mesh.numbers, mesh.positions = mesh.numbers[last], mesh.positions[last]
        for card in self.surfaces:
            self.surface(card)
        known = np.sort(mesh.numbers)
        for block in self.blocks:
            missing = np.setdiff1d(block.nodes, known)
            if missing.size:
                at = int(np.flatnonzero((block.nodes == missing[0]).any(axis=1))[0])
                text = f"element {block.labels[at]} has the node {missing[0]}, which *NODE does not give"
                self.problems.append(Problem("*ELEMENT", text))
        for name, numbers in mesh.sets.items():
            mesh.sets[name] = np.intersect1d(numbers, known)
            mesh.unknown += len(numbers) - len(mesh.sets[name])
        mesh.elements = [part for block in self.blocks for part in self.by_material(block)]
        return mesh

    def surface(self, card: Card) -> None:
        """The nodes of a surface, as a set: those of faces of elements, or nodes and sets of nodes."""
        name = self.named(card, "NAME")
        if card.parameters.get("TYPE", "ELEMENT").upper() == "NODE":
            self.add(self.mesh.sets, name, self.members(card, self.mesh.sets))
            return
        parts = [np.zeros(0, np.int64)]
        for line in card.lines:
            which, _, face = (part.strip().upper() for part in line.partition(","))
            labels = self.members(replace(card, lines=[which]), self.element_sets)
            number = face.rstrip(", ").removeprefix("S")
            if number.isdecimal():
                parts += [nodes for block in self.blocks for nodes in _of_face(block, labels, int(number))]
            else:
                text = f"a line is an element or a set of elements, and one of its faces such as S1, not {quoted(line)}"
                self.problems.append(card.fault(text))
                return
        if not sum(map(len, parts)):
            self.problems.append(card.fault("no element of the surface has the face that is given"))
            return
        self.add(self.mesh.sets, name, np.concatenate(parts))

    def rigid_body(self, card: Card) -> None:
        """A rigid body of a set of nodes; those of elements are among what is not read."""
        nodes = [card.parameters.get(parameter, "0") for parameter in ("REF NODE", "ROT NODE")]
        if "NSET" in card.parameters and all(node.isdecimal() for node in nodes) and int(nodes[0]):
            name = self.named(card, "NSET")
            self.mesh.rigid_bodies.append(RigidNodes(name, int(nodes[0]), int(nodes[1]), card.line))
        else:
            self.mesh.cards["RIGID BODY"] = (card.line, 1)

    def by_material(self, block: _Block) -> list[Elements]:
        """The elements of a block, of each material."""
        number = np.full(len(block.labels), -1)
        for i, (elset, _) in enumerate(self.sections):
            number[np.isin(block.labels, self.element_sets.get(elset, np.zeros(0, np.int64)))] = i
        materials = [self.sections[i][1] if i >= 0 else "" for i in np.unique(number)]
        return [
            Elements(block.kind, block.nodes[number == i], material)
            for i, material in zip(np.unique(number), materials, strict=True)
        ]


def _of_face(block: _Block, labels: Indices, face: int) -> Iterator[Indices]:
    """Yield the nodes of a face, counted from 1, of the elements of a block that have these labels."""
    shape = element_shape(block.kind)
    faces = FACES[shape.corners]
    if face not in range(1, len(faces) + 1):
        return
    corners = [corner - 1 for corner in faces[face - 1]]
    middles = [shape.corners + i for i, edge in enumerate(shape.edges) if {*edge} <= {*corners}]
    yield block.nodes[np.isin(block.labels, labels)][:, [*corners, *middles]].ravel()
