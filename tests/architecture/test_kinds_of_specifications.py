"""Simulations and exports take scenes; few modules ask what kind of specification a scene comes from."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from conftest import ROOT

KINDS = {"Scene", "PlanarBeam", "NodalBody", "SymbolicBody"}
ASKING = {
    "simulation/simulated_scene.py": "makes the scene of a specification",
    "simulation/prepared_run.py": "a body in space has its own size, initial state and generated model",
    "simulation/initial/start_state.py": "that initial state",
    "simulation/linear/modes.py": "a body alone is linearised undeformed, a scene about its equilibrium",
    "simulation/linear/displaced.py": "the model of a beam alone has other names than that of its scene",
    "export/exudyn/floating_frame.py": "the interface is for bodies in space",
    "export/fmi/variables.py": "sizes of states are those of a scene",
}
"""The modules of `simulation`, `runtime` and `export` that ask, and why."""


def questions(text: str) -> Iterator[int]:
    """The lines with `isinstance` or `case` of a kind of specification."""
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.Call(func=ast.Name("isinstance"), args=[_, kinds]) | ast.MatchClass(cls=kinds):
                if KINDS & {part.id for part in ast.walk(kinds) if isinstance(part, ast.Name)}:
                    yield kinds.lineno


def test_questions_are_noticed() -> None:
    text = "isinstance(x, int | Scene)\nmatch x:\n    case NodalBody():\n        isinstance(x, int)\n"
    assert sorted(questions(text)) == [1, 3]


def test_few_modules_ask_for_the_kind_of_a_specification() -> None:
    modules = [path for part in ("simulation", "runtime", "export") for path in (ROOT / "derive" / part).rglob("*.py")]
    asking = {path.relative_to(ROOT / "derive").as_posix() for path in modules if any(questions(path.read_text()))}
    assert asking == ASKING.keys()
