"""The finite-element programs whose files `import` reads, by the suffix of the file that is given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from derive.fem.abaqus.read import matrix_files, read_abaqus
from derive.fem.ansys.read import read_ansys
from derive.fem.calculix.read import read_calculix
from derive.fem.mbdyn.read import read_mbdyn
from derive.fem.model import FiniteElementModel
from derive.fem.nastran.read import read_nastran
from derive.fem.standard_input import read_standard_input
from derive.registry import Registry


@dataclass(frozen=True)
class ModelReader:
    """The program that writes a file, and the function that reads it and those beside it."""

    program: str
    read: Callable[[Path], FiniteElementModel]


def read_keywords(path: Path) -> FiniteElementModel:
    """The part of an input of keywords: of Abaqus where its matrices are beside it, and otherwise of CalculiX."""
    of_abaqus = any(matrix_files(path).values()) and not path.with_suffix(".sti").exists()
    return read_abaqus(path) if of_abaqus else read_calculix(path)


READERS: Registry[ModelReader] = Registry(
    "file of a finite-element program",
    {
        ".inp": ModelReader("CalculiX or Abaqus", read_keywords),
        **dict.fromkeys((".bdf", ".nas"), ModelReader("Nastran", read_nastran)),
        ".cdb": ModelReader("ANSYS", read_ansys),
        ".fem": ModelReader("MBDyn", read_mbdyn),
        **dict.fromkeys((".sid", ".sid_fem"), ModelReader("standard input data", read_standard_input)),
    },
)
"""The readers by suffixes in small letters."""
