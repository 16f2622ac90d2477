"""`--to cmake`: a library for CMake and pkg-config, a C++ wrapper, and sample programs that test themselves."""

from __future__ import annotations

from dataclasses import dataclass

from derive.artifacts import File
from derive.backends.wrapping import comment
from derive.errors import Problem, SpecError
from derive.export.c_parts import INTEGRATOR, c_numbers, integrator_files, sample_values
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.ir.kernel import Kernel
from derive.ir.statements import ReturnCode
from derive.rendering import render

_TARGETS = """\
all ALL_BUILD clean edit_cache help install INSTALL package PACKAGE package_source preinstall rebuild_cache RUN_TESTS
test ZERO_CHECK
"""
TARGETS = frozenset(_TARGETS.split())
"""Names that CMake keeps for its own targets."""
KEPT = ("u", "k")
"""The arguments that an object of the C++ wrapper stores: inputs and constants."""


@dataclass(frozen=True)
class MemberFunction:
    """A member function of the C++ wrapper: comment, name, typed parameters, and the arguments of the C function."""

    doc: str
    name: str
    parameters: str
    arguments: str


def cmake_files(model: HostModel) -> tuple[File, ...]:
    """The files of a CMake project.

    Raises SpecError for a name that no library can have, CompilerError, and what the integration of the reference
    motion raises.
    """
    name = model.name
    if name in TARGETS:
        raise SpecError((Problem("name", f"CMake has a target {name} of its own; choose another name"),))
    values = sample_values(model) | {
        "title": model.model.doc,
        "outputs": model.outputs,
        "energies": model.model.kernel("energy").outputs[0].size,
        "start": model.model.start,
        "codes": list(ReturnCode),
        "methods": _member_functions(model),
        "integrators": [f"{part}.c" for part in INTEGRATOR],
        "q_text": c_numbers([x.start for x in model.coordinates]),
        "v_text": c_numbers([x.start for x in model.velocities]),
        "u_text": c_numbers(model.constant_inputs),
    }

    def made(path: str, template: str) -> File:
        return File(path, render(f"export/cmake/{template}.jinja", values))

    return (
        made("CMakeLists.txt", "CMakeLists.txt"),
        made(f"{name}.pc.in", "model.pc.in"),
        File(f"include/{name}.h", model.header.text),
        made(f"include/{name}.hpp", "model.hpp"),
        File(f"src/{name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        made("sample/CMakeLists.txt", "sample.cmake"),
        made("sample/sample.c", "sample.c"),
        made("sample/sample.cpp", "sample.cpp"),
        made("sample/reference.h", "reference.h"),
        *integrator_files("sample/"),
    )


def _member_functions(model: HostModel) -> list[MemberFunction]:
    """The functions of a model but `setup`, in the order of its header; batches are called in C."""
    return [_member_function(kernel) for kernel in model.model.kernels if kernel.name != "setup"]


def _member_function(kernel: Kernel) -> MemberFunction:
    parameters, arguments = [], []
    for argument in kernel.arguments:
        if argument.name in KEPT:
            arguments.append(f"{argument.name}_.data()")
        elif argument.scalar:
            parameters.append(f"{'int' if argument.integer else 'double'} {argument.name}")
            arguments.append(argument.name)
        else:
            parameters.append(f"tisserand::span<const double, {argument.size}> {argument.name}")
            arguments.append(f"{argument.name}.data()")
    for output in kernel.outputs:
        parameters.append(f"tisserand::span<double, {output.size}> {output.name}")
        arguments.append(f"{output.name}.data()")
    doc = "\n".join(comment((kernel.doc,), "    "))
    return MemberFunction(doc, kernel.name, ", ".join(parameters), ", ".join(arguments))


CMAKE = Interface(
    "C and C++ programs that are built with CMake or found by pkg-config, also on small processors",
    cmake_files,
    "cmake -S {folder} -B build && cmake --build build && ctest --test-dir build",
)
