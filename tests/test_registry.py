"""Open sets: an unknown name is an error that names the known ones."""

from __future__ import annotations

import pytest

from derive.errors import TisserandError
from derive.registry import Registry, UnknownNameError


def test_an_unknown_name_lists_the_known_ones() -> None:
    registry = Registry("joint", {"weld": 1, "revolute": 2})
    with pytest.raises(UnknownNameError, match=r'no joint "revolut"; did .* "revolute"[?] known: weld, revolute$'):
        registry["revolut"]
    assert issubclass(UnknownNameError, TisserandError)
    assert registry.get("revolut") is None and "revolut" not in registry


def test_members_come_and_go_and_never_hide_each_other() -> None:
    registry: Registry[int] = Registry("joint")
    registry.register("weld", 1)
    assert list(registry.items()) == [("weld", 1)]
    with pytest.raises(ValueError, match="registered already"):
        registry.register("weld", 2)
    registry.unregister("weld")
    assert not registry
    with pytest.raises(UnknownNameError, match="known: none"):
        registry.unregister("weld")
