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
    "simulation/observables/motion.py": "drawings and deflections of planar scenes take no scene in space",
    "simulation/observables/fields.py": "fields are those of bodies of a scene, or of a body alone",
    "simulation/linear/modes.py": "a body alone is linearised undeformed, a scene about its equilibrium",
    "simulation/linear/displaced.py": "the model of a beam alone has other names than that of its scene",
    "export/exudyn/floating_frame.py": "the interface is for bodies in space",
    "export/fmi/variables.py": "sizes of states are those of a scene",
    "report/model_page.py": "a beam and a body in space have other kinematics, another frame and another subtitle",
    "cli/report.py": "a scene has a page of its own, with the results of its runs",
    "cli/specifications.py": "studies that need a scene refuse a body",
    "cli/sid.py": "the command is for bodies of nodes",
    "cli/build_notes.py": "notes on the modes of a body of nodes",
    "cli/modes.py": "the state of a body alone is undeformed; a symbolic body has defaults alone",
    "spec/as_tables.py": "a scene has several tables, a body has one",
    "spec/set_values.py": "which constants may be parameters, and which names are taken",
    "spec/checks/validation.py": "functions of time are those of scenes; a symbolic body has no nodes",
    "spec/checks/plotted_columns.py": "the columns of beams and scenes are known before the derivation",
}
"""The modules of PARTS that ask, and why."""

PARTS = ("simulation", "runtime", "export", "report", "backends", "cli", "spec")


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
    modules = [path for part in PARTS for path in (ROOT / "derive" / part).rglob("*.py")]
    asking = {path.relative_to(ROOT / "derive").as_posix() for path in modules if any(questions(path.read_text()))}
    assert asking == ASKING.keys()
