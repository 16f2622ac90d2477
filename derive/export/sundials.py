"""`--to sundials`: the C of a model, what CVODE, CVODES, ARKODE and IDA call, and sample programs."""

from __future__ import annotations

from derive.artifacts import File
from derive.export.c_parts import host_copy, sample_values
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.rendering import render

HOSTS = ("ode", "fixed_step", "sundials", "ida")
"""The parts of `templates/host` that the programs need."""

PROGRAMS = ("sample_cvode.c", "sample_cvodes.c", "sample_arkode.c", "sample_ida.c")


def sundials_files(model: HostModel) -> tuple[File, ...]:
    """The files of a project. Raises CompilerError, and what the integration of the reference motion raises."""
    values = sample_values(model)
    programs = (File(path, render(f"export/sundials/{path}.jinja", values)) for path in (*PROGRAMS, "sample.h"))
    return (
        File("CMakeLists.txt", render("export/sundials/CMakeLists.txt.jinja", values)),
        File(f"{model.name}.h", model.header.text),
        File(f"{model.name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        *programs,
        File("reference.h", render("export/cmake/reference.h.jinja", values)),
        *(host_copy("", f"{part}{ending}") for part in HOSTS for ending in (".c", ".h")),
    )


SUNDIALS = Interface(
    "CVODE, CVODES, ARKODE and IDA of SUNDIALS in C: events, projection, sparse Jacobians, sensitivities",
    sundials_files,
    "cmake -S {folder} -B build && cmake --build build && ctest --test-dir build",
    sensitivities=True,
)
