"""An object as HTML: the function for its type, or for the nearest of its base classes.

The modules that know some types are imported one after the other until one knows that of the object, so that a
specification is shown without what simulations and studies need.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from derive.notebook.parts import Writers

MODULES = ("specifications", "equations", "runs", "linear", "registries", "studies")
"""The modules here with `WRITERS`, of which the later ones import more."""


def html(shown: Any) -> str:
    """An object as HTML. Raises TypeError for a type that has no function here."""
    known: list[str] = []
    for module in MODULES:
        writers: Writers = import_module(f"derive.notebook.{module}").WRITERS
        for of in type(shown).__mro__:
            if of in writers:
                return writers[of](shown)
        known += [of.__name__ for of in writers]
    raise TypeError(f"notebooks show {', '.join(known)}, not {type(shown).__name__}")
