"""`--to sundials`: the C of a model, what CVODE, CVODES, ARKODE and IDA call, and sample programs."""

from __future__ import annotations

from derive.artifacts import MARK, File
from derive.backends.c.source import ABI
from derive.backends.description import LICENCE
from derive.export.c_parts import c_numbers, host_copy
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.reference_motion import reference_motion
from derive.rendering import render
from derive.spec.model.scene import Scene

HOSTS = ("ode", "fixed_step", "sundials", "ida")
"""The parts of `templates/host` that the programs need."""

PROGRAMS = ("sample_cvode.c", "sample_cvodes.c", "sample_arkode.c", "sample_ida.c")


def sundials_files(model: HostModel) -> tuple[File, ...]:
    """The files of a project. Raises CompilerError, and what the integration of the reference motion raises."""
    motion = reference_motion(model)
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": model.name,
        "macro": model.name.upper(),
        "abi": ABI,
        "scene": isinstance(model.spec, Scene),
        "coordinates": model.coordinates,
        "states": model.states,
        "inputs": list(zip(model.inputs, model.held_inputs, strict=True)),
        "parameters": model.parameters,
        "multipliers": model.multipliers,
        "event": len(model.velocities) - 1,
        "times": motion.times,
        "times_text": c_numbers(motion.times.tolist()),
        "states_text": c_numbers(motion.states.ravel().tolist()),
        "tolerances_text": c_numbers(motion.tolerances.tolist()),
        "number": repr,
    }
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
