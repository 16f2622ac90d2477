"""`--to cmake`: a library for CMake and pkg-config, a C++ wrapper, and sample programs that test themselves."""

from __future__ import annotations

from derive.artifacts import MARK, File
from derive.backends.c.source import ABI
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.reference_motion import reference_motion
from derive.rendering import render

INTEGRATOR = ("adaptive_rows", "adaptive", "dormand_prince", "fixed_step")
"""The parts of `templates/host` with which the sample programs integrate."""


def cmake_files(model: HostModel) -> tuple[File, ...]:
    """The files of a CMake project. Raises CompilerError, and what the integration of the reference motion raises."""
    name = model.name
    motion = reference_motion(model)
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": name,
        "macro": name.upper(),
        "abi": ABI,
        "title": model.model.doc,
        "coordinates": model.coordinates,
        "velocities": model.velocities,
        "states": model.states,
        "inputs": list(zip(model.inputs, model.held_inputs, strict=True)),
        "multipliers": model.multipliers,
        "integrators": [f"{part}.c" for part in INTEGRATOR],
        "times": motion.times,
        "times_text": _numbers(motion.times.tolist()),
        "states_text": _numbers(motion.states.ravel().tolist()),
        "tolerances_text": _numbers(motion.tolerances.tolist()),
        "number": repr,
    }

    def made(path: str, template: str) -> File:
        return File(path, render(f"export/cmake/{template}.jinja", values))

    return (
        made("CMakeLists.txt", "CMakeLists.txt"),
        made(f"{name}.pc.in", "model.pc.in"),
        File(f"include/{name}.h", model.header.text),
        File(f"src/{name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        made("sample/CMakeLists.txt", "sample.cmake"),
        made("sample/sample.c", "sample.c"),
        made("sample/reference.h", "reference.h"),
        *(_copy(f"{part}{ending}") for part in INTEGRATOR for ending in (".c", ".h")),
    )


def _copy(name: str) -> File:
    """A file of `templates/host`, with our mark."""
    return File(f"sample/{name}", f"/* {MARK}: a copy of templates/host/{name}. */\n{render(f'host/{name}', {})}")


def _numbers(values: list[float]) -> str:
    return "\n".join(prefixed([", ".join(map(repr, values))], "    "))


CMAKE = Interface(
    "C and C++ programs that are built with CMake or found by pkg-config, also on small processors",
    cmake_files,
    "cmake -S {folder} -B build && cmake --build build && ctest --test-dir build",
)
