"""Python objects that are kept in the cache between runs: they consist of classes of the package that are trusted."""

from __future__ import annotations

import hashlib
import io
import pickle
import platform
import sys
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from derive import cache as kept
from derive.garbage_collection import paused
from derive.rendering import templates_folder
from derive.version import VERSION

TRUSTED = (
    "derive.artifacts",
    "derive.backends.source_map",
    "derive.ir.expressions",
    "derive.ir.indices",
    "derive.ir.kernel",
    "derive.ir.model",
    "derive.ir.packing",
    "derive.ir.patterns",
    "derive.ir.statements",
    "derive.roles",
    "derive.spec.model.quantity",
    "derive.spec.model.time_function",
    "fractions",
)
"""The modules whose classes a kept object consists of; no others are loaded."""

PACKAGES = ("sympy", "casadi", "numpy", "scipy", "jinja2")

DEPTH = 4000
"""The depth of calls while an object is written, for which a stack of a megabyte has room."""

T = TypeVar("T")


def kept_object(kind: str, source: str, made: Callable[[], T]) -> T:
    """The result of `made`, from the cache if it is there; otherwise it is kept there for `kind` and `source`.

    source: the text of all that the result depends on, besides this package and those that it uses.
    """
    name = kept.key(kind, source, package_hash(), *_versions())
    data = kept.read(name)
    if data is not None:
        try:
            with paused():  # the search would go through the many objects again and again while they are read
                result: T = _Reader(io.BytesIO(data)).load()
        except (pickle.UnpicklingError, AttributeError, EOFError, ImportError):  # it has been written by other means
            pass
        else:
            return result
    result = made()
    if (written := dumped(result)) is not None:
        kept.write(name, written)
    return result


def dumped(result: object) -> bytes | None:
    """An object as bytes; None where its expressions, such as sums of thousands of terms, are nested too deeply."""
    usual = sys.getrecursionlimit()
    sys.setrecursionlimit(max(usual, DEPTH))
    try:
        return pickle.dumps(result, pickle.HIGHEST_PROTOCOL)
    except RecursionError:
        return None
    finally:
        sys.setrecursionlimit(usual)


@cache
def package_hash() -> str:
    """The SHA-256 of all source files and templates of this package."""
    digest = hashlib.sha256()
    for folder, pattern in ((Path(__file__).parent, "**/*.py"), (templates_folder(), "**/*")):
        for path in sorted(folder.glob(pattern)):
            if path.is_file():
                digest.update(f"{path.relative_to(folder)}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _versions() -> tuple[str, ...]:
    return VERSION, platform.python_version(), *(f"{name} {version(name)}" for name in PACKAGES)


class _Reader(pickle.Unpickler):
    """An unpickler that reads classes of the trusted modules alone, so that a file cannot call anything else."""

    def find_class(self, module: str, name: str) -> Any:
        """The class of that name. Raises UnpicklingError for anything else."""
        result = super().find_class(module, name) if module in TRUSTED else None
        if not (isinstance(result, type) and result.__module__ == module):
            raise pickle.UnpicklingError(f"{module}.{name} is no part of a kept object")
        return result
