"""The public interface: `dir`, `help`, no slow import, and nothing in examples from deeper than one level."""

from __future__ import annotations

import ast
import inspect
import pydoc
import re
import subprocess
import sys

import pytest

import derive
from conftest import ROOT


def test_dir_and_help_show_every_public_name() -> None:
    assert dir(derive) == sorted(derive.__all__)
    assert set(derive.__all__) == {"__version__", *derive._MODULE_OF}
    text = pydoc.plain(pydoc.render_doc(derive))
    words = set(re.findall(r"\w+", derive.__doc__))
    for name in derive.__all__:
        if name == "__version__":
            continue
        value = getattr(derive, name)
        assert name in words, f"{name} is not in the docstring of derive"
        assert inspect.getdoc(value), name
        assert re.search(rf"^ +(class )?{name}\b", text, re.MULTILINE), name


def test_the_names_that_type_checkers_see_are_those_that_are_imported() -> None:
    tree = ast.parse((ROOT / "derive/__init__.py").read_text())
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    seen = {alias.name: node.module for node in block.body for alias in node.names}  # type: ignore[attr-defined]
    assert seen == derive._MODULE_OF


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        derive.simulat  # noqa: B018


def test_the_import_loads_nothing_heavy() -> None:
    code = "import derive, sys; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert not {"numpy", "scipy", "sympy", "casadi", "matplotlib", "pydantic"} & set(done.stdout.split())
