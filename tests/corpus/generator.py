"""A random valid scene from a seed.

    corpus_scene(7).write(folder)      # scene_7.toml in the folder, with the tables that it refers to

A scene is plain tables, which become TOML. What kinds of joints, forces, outputs, frames and shapes there are comes
from the registries and enumerations of the package, so that a new one enters by itself; a key for which the generator
has no value raises NotImplementedError, and `test_generator.py` finds the keys and forms that no scene uses. Beams are
stiff enough to carry their own weight with a deflection of at most 1 % of their length, drives and loads are about as
strong, linkages close and can move, and durations are short.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import tomlkit

from corpus.actions import act
from corpus.beams import make_bodies
from corpus.draft import Draft, Table
from corpus.draws import Draws, rounded
from corpus.instances import count_some, expanded
from corpus.linkages import REDUNDANT, link
from corpus.lone_bodies import LONE, lone_beam, spatial_body
from corpus.many_bodies import SHARE, many_bodies
from corpus.observations import observe
from corpus.spatial_scenes import FIRST, spatial_scene
from corpus.spelling import respell
from derive.spec.tables.json_schema import schema_of
from derive.spec.tables.spatial_scene import spatial_specification_table
from derive.spec.tables.specification import specification_table


@dataclass(frozen=True)
class CorpusScene:
    """A scene of the corpus: its tables, the files beside it, and the linkage it was made from.

    tables: with all instances of tables with a count; written: as the file has them.
    """

    seed: int
    tables: Table
    written: Table
    files: dict[str, str | Path]
    linkage: str

    @property
    def name(self) -> str:
        """The name of the model."""
        return str(self.tables["name"])

    @property
    def text(self) -> str:
        """The scene as TOML."""
        return tomlkit.dumps(self.written)

    def write(self, folder: Path) -> Path:
        """Write the scene and its files; the path of the scene."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in self.files.items():
            if isinstance(content, Path):
                (folder / name).write_bytes(content.read_bytes())
            else:
                (folder / name).write_text(content)
        path = folder / f"{self.name}.toml"
        path.write_text(self.text)
        return path


def corpus_scene(seed: int) -> CorpusScene:
    """The scene of a seed; those from FIRST on are in space."""
    draws = Draws(seed)
    if seed >= FIRST:
        tables, files, linkage = spatial_scene(draws, f"scene_{seed}")
        respell(tables, spatial_schema(), draws, 0.15)
        _choose_coordinates(tables, Draws(f"coordinates {seed}"))
        return CorpusScene(seed, tables, tables, files, linkage)
    tables, files, linkage = _parts(draws, f"scene_{seed}")
    many = Draws(f"many {seed}")
    if many.chance(SHARE):
        (tables, linkage), files = many_bodies(many, f"scene_{seed}"), {}
    count_some(tables, Draws(f"count {seed}"), 0.1)
    _lower(tables, Draws(f"lowering {seed}"))
    _treat_redundancy(tables, linkage, Draws(f"redundant {seed}"))
    respell(tables, _schema(), draws, 0.6 if linkage in LONE else 0.15)
    return CorpusScene(seed, expanded(tables), tables, files, linkage)


def _lower(tables: Table, draws: Draws) -> None:
    """Ask for loops over instances in a quarter of the scenes, and for others in a few."""
    lowering = draws.choice(["instances"] * 5 + ["auto", "flat"] + [""] * 13)
    if lowering and "bodies" in tables:
        tables.setdefault("scene", {})["lowering"] = lowering


def _choose_coordinates(tables: Table, draws: Draws) -> None:
    """Choose the coordinates of a scene in space in half of the cases, and in some a joint that closes a loop."""
    chosen = draws.choice(["", "", "", "auto", "relative", "absolute"])
    if chosen:
        tables.setdefault("scene", {})["coordinates"] = chosen
    if tables.get("joints") and draws.chance(0.15):
        tables["joints"][draws.choice([*tables["joints"]])]["closes_loop"] = True


def _treat_redundancy(tables: Table, linkage: str, draws: Draws) -> None:
    """Resolve redundant joints in some scenes, whether there are any or not, and refuse them in a few without."""
    treatment = draws.choice(["resolve"] * 4 + ["auto", "error"] + [""] * 24)
    if treatment and "bodies" in tables and not (treatment == "error" and linkage in REDUNDANT):
        tables.setdefault("scene", {})["redundant"] = treatment


@cache
def _schema() -> dict[str, Any]:
    schema: dict[str, Any] = schema_of(specification_table())
    return schema


@cache
def spatial_schema() -> dict[str, Any]:
    """The schema of scenes in space."""
    schema: dict[str, Any] = schema_of(spatial_specification_table())
    return schema


def _parts(draws: Draws, name: str) -> tuple[Table, dict[str, str | Path], str]:
    """The tables, the files beside them, and the linkage."""
    kind = draws.between(0, 1)
    if kind < LONE["beam"]:
        return *lone_beam(draws, name), "beam"
    if kind < LONE["beam"] + LONE["body"]:
        return *spatial_body(draws, name), "body"
    draft = Draft(draws, size=rounded(draws.scale(0.15, 2), 2))
    draft.tables["name"] = name
    draft.names.add(name)
    draft.rate = rounded(math.sqrt(9.81 / draft.size) * draws.between(0.5, 1.5), 2)
    draft.stiff = draft.rate
    link(draft)
    make_bodies(draft)
    act(draft)
    observe(draft)
    order = [key for key in _schema()["properties"] if key in draft.tables]
    return {key: draft.tables[key] for key in order}, dict(draft.files), draft.linkage
