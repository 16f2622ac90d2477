"""The public interface: `dir`, `help`, no slow import, and nothing in examples from deeper than one level."""

from __future__ import annotations

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
    assert {"read", "Scene", "simulate", "JOINTS", "__version__"} <= set(derive.__all__)
    text = pydoc.plain(pydoc.render_doc(derive))
    words = set(re.findall(r"\w+", derive.__doc__))
    for name in derive.__all__:
        if name == "__version__":
            continue
        value = getattr(derive, name)
        assert name in words, f"{name} is not in the docstring of derive"
        assert inspect.getdoc(value), name
        assert re.search(rf"^ +(class )?{name}\b", text, re.MULTILINE), name


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        derive.simulat  # noqa: B018


def test_the_import_loads_nothing_heavy() -> None:
    code = "import derive, sys; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert not {"numpy", "scipy", "sympy", "casadi", "matplotlib", "pydantic"} & set(done.stdout.split())
