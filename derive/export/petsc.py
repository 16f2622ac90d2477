"""`--to petsc`: the C of a model, what TS of PETSc calls, and a sample program."""

from __future__ import annotations

from derive.artifacts import File
from derive.export.c_parts import host_copy, sample_values
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.rendering import render

HOSTS = ("fixed_step", "petsc_ts")
"""The parts of `templates/host` that the program needs."""

ONE_STEP = "-ts_type arkimex -ts_arkimex_type 5"


def petsc_files(model: HostModel) -> tuple[File, ...]:
    """The files of a project. Raises CompilerError, and what the integration of the reference motion raises."""
    index1 = " -form index1" if model.multipliers else ""
    tests = [("sample_bdf", ""), ("sample_arkimex", ONE_STEP + index1)]
    values = sample_values(model) | {"tests": tests}
    return (
        File("CMakeLists.txt", render("export/petsc/CMakeLists.txt.jinja", values)),
        File(f"{model.name}.h", model.header.text),
        File(f"{model.name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        File("sample.c", render("export/petsc/sample.c.jinja", values)),
        File("reference.h", render("export/cmake/reference.h.jinja", values)),
        *(host_copy("", f"{part}{ending}") for part in HOSTS for ending in (".c", ".h")),
    )


PETSC = Interface(
    "TS of PETSc in C: implicit equations with their sparse Jacobian, events",
    petsc_files,
    "cmake -S {folder} -B build && cmake --build build && ctest --test-dir build",
)
