"""The finite-element programs whose files `import` reads, by the suffix of the file that is given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from derive.fem.calculix.read import read_calculix
from derive.fem.model import FiniteElementModel
from derive.registry import Registry


@dataclass(frozen=True)
class ModelReader:
    """The program that writes a file, and the function that reads it and those beside it."""

    program: str
    read: Callable[[Path], FiniteElementModel]


READERS: Registry[ModelReader] = Registry(
    "file of a finite-element program", {".inp": ModelReader("CalculiX", read_calculix)}
)
"""The readers by suffixes in small letters."""
