"""No module imports itself through others, imports inside functions and for type checks included.

The layers themselves are contracts of import-linter in pyproject.toml; `make test` checks them.
"""

from __future__ import annotations

import tomllib

import grimp

from conftest import ROOT


def cycles(imports: dict[str, set[str]]) -> list[list[str]]:
    """The groups of modules that import each other: Tarjan's strongly connected components of more than one."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(module: str) -> None:
        order[module] = lowest[module] = len(order)
        stack.append(module)
        for other in sorted(imports[module]):
            if other not in order:
                visit(other)
            if other in stack:
                lowest[module] = min(lowest[module], lowest[other])
        if lowest[module] == order[module]:
            group = stack[stack.index(module) :]
            del stack[stack.index(module) :]
            if len(group) > 1:
                groups.append(sorted(group))

    for module in sorted(imports):
        if module not in order:
            visit(module)
    return groups


def imports() -> dict[str, set[str]]:
    graph = grimp.build_graph("derive", cache_dir=None)
    return {module: set(graph.find_modules_directly_imported_by(module)) for module in graph.modules}


def test_cycles_are_noticed() -> None:
    assert cycles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]


def test_no_modules_import_each_other() -> None:
    below = {module: others - {"derive"} for module, others in imports().items() if module != "derive"}
    assert len(below) > 200
    assert cycles(below) == []


def test_every_package_is_in_a_layer() -> None:
    """A package that nobody put into the list of layers would escape the check."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    listed = {name.strip() for layer in contracts[0]["layers"] for name in layer.split("|")}
    covered = {name for name in imports() if any(name == x or name.startswith(f"{x}.") for x in listed)}
    apart = {"derive", "derive.__main__", "derive.spec"}
    assert {m for m in imports() if m not in covered} == apart
