"""Objects as HTML and as data frames: a higher layer registers the functions, so that no lower layer imports it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

_functions: dict[str, Callable[[object], Any]] = {}


def register(html: Callable[[object], str], data_frame: Callable[[object], Any]) -> None:
    """Let these functions write objects as HTML, and their tables as data frames of pandas."""
    _functions.update({"html": html, "data_frame": data_frame})


def html(shown: object) -> str:
    """An object as HTML. Raises LookupError when no function is registered."""
    return str(_registered("html")(shown))


def data_frame(shown: object) -> Any:
    """The table of a study as a data frame. Raises PandasMissing, LookupError when no function is registered."""
    return _registered("data_frame")(shown)


class Tabulated:
    """A study with a table of its figures, which notebooks show as HTML."""

    _repr_html_ = html

    def to_pandas(self) -> Any:
        """The table as a pandas.DataFrame.

        Raises:
            PandasMissing: if pandas is not installed.
        """
        return data_frame(self)


def _registered(name: str) -> Callable[[object], Any]:
    if name not in _functions:
        raise LookupError(f"no function is registered for {name}; `import derive` registers one")
    return _functions[name]
