"""`--to fortran`: a module of Fortran 2018 with the functions of a model, by `iso_c_binding`, and a sample program."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.errors import Problem, SpecError
from derive.export.c_parts import INTEGRATOR, integrator_files, motion_file
from derive.export.host_model import HostModel, HostVariable
from derive.export.interface import Interface
from derive.export.reference_motion import reference_motion
from derive.ir.kernel import Kernel
from derive.ir.statements import ReturnCode
from derive.rendering import render

LONGEST = 63
"""Characters of a name in Fortran."""
MOST = 400
"""Numbers of a statement, which are at least two on each of its lines."""


@dataclass(frozen=True)
class Procedure:
    """A function of C in Fortran: its comment, its name, the names of its arguments, and their declarations."""

    doc: Sequence[str]
    name: str
    arguments: str
    declarations: Sequence[str]


def fortran_files(model: HostModel) -> tuple[File, ...]:
    """The files of a Fortran module. Raises SpecError where a name is too long for Fortran, CompilerError."""
    _check_names(model)
    name, motion = model.name, reference_motion(model)
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": name,
        "title": model.model.doc,
        "sizes": _sizes(model),
        "indices": _indices(model),
        "codes": [(code.name.lower(), code.value, code.meaning) for code in ReturnCode],
        "procedures": [_procedure(kernel) for kernel in model.model.kernels],
        "start": [
            *_assigned("q", [x.start for x in model.coordinates]),
            *_assigned("v", [x.start for x in model.velocities]),
        ],
        "constant_inputs": _numbers(model.constant_inputs) if model.inputs else "",
        "nlambda": len(model.multipliers),
        "reference": [
            *_assigned("times", motion.times.tolist()),
            *_assigned("tolerances", motion.tolerances.tolist()),
            *(
                part
                for j, row in enumerate(motion.states.tolist(), 1)
                for part in _assigned("reference", row, f", {j}")
            ),
        ],
        "count": len(motion.times),
        "sources": " ".join(f"{part}.c" for part in (name, f"{name}_motion", *INTEGRATOR)),
    }
    return (
        File("Makefile", render("export/fortran/Makefile.jinja", values)),
        File(f"{name}_fortran.f90", render("export/fortran/model.f90.jinja", values)),
        File("sample.f90", render("export/fortran/sample.f90.jinja", values)),
        File(f"{name}.h", model.header.text),
        File(f"{name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        motion_file(model, ""),
        *integrator_files(""),
    )


def _check_names(model: HostModel) -> None:
    names = [kernel.name for kernel in model.model.kernels] + [name for name, _ in _indices(model)]
    if long := [name for name in names if len(name) > LONGEST]:
        text = f"Fortran allows {LONGEST} characters, and these names have more: {', '.join(long)}; choose shorter ones"
        raise SpecError((Problem("", text),))


def _sizes(model: HostModel) -> list[tuple[str, int]]:
    tables = [("nq", model.coordinates), ("nv", model.velocities), ("np", model.parameters), ("nu", model.inputs)]
    tables += [("nout", model.outputs), ("nlambda", model.multipliers)]
    constants = sum(constant.size for constant in model.model.constants)
    return [*((name, len(table)) for name, table in tables), ("nk", constants)]


def _indices(model: HostModel) -> list[tuple[str, int]]:
    """The positions of coordinates and others in their arrays, which begin at 1."""
    tables: list[tuple[str, Sequence[HostVariable]]] = [("q", model.coordinates), ("v", model.velocities)]
    tables += [("p", model.parameters), ("u", model.inputs), ("out", model.outputs), ("lambda", model.multipliers)]
    return [(f"{prefix}_{x.name}", index) for prefix, table in tables for index, x in enumerate(table, 1)]


def _procedure(kernel: Kernel) -> Procedure:
    """The procedure of a kernel; Fortran ignores case, so outputs named like an argument or a function are renamed."""
    names, declarations = [], []
    for argument in kernel.arguments:
        names.append(argument.name)
        shape = "" if argument.scalar else f"({argument.size})"
        kind = "value" if argument.scalar else "intent(in)"
        number = "integer(c_int)" if argument.integer else "real(c_double)"
        declarations.append(f"{number}, {kind} :: {argument.name}{shape}")
    for output in kernel.outputs:
        taken = output.name.lower() in {kernel.name, *(name.lower() for name in names)}
        names.append(f"{output.name}_out" if taken else output.name)
        declarations.append(f"real(c_double), intent(inout) :: {names[-1]}({output.size})")
    return Procedure(prefixed([kernel.doc], "        ! "), kernel.name, ", ".join(names), declarations)


def _assigned(array: str, values: Sequence[float | None], column: str = "") -> Iterator[tuple[str, str]]:
    """The parts of an array and their numbers, so many that a statement has at most 255 lines; column: of a matrix."""
    for first in range(0, len(values), MOST):
        part = values[first : first + MOST]
        bounds = f"{first + 1}:{first + len(part)}" if len(values) > MOST else ":"
        yield f"{array}({bounds}{column})", _numbers(part)


def _numbers(values: Iterable[float | None]) -> str:
    """Numbers as the elements of an array, on lines that go on."""
    lines = prefixed([", ".join(f"{value!r}_c_double" for value in map(_plain, values))], "        ")
    return " &\n".join(lines)


def _plain(value: float | None) -> float:
    return float(value or 0.0) + 0.0


FORTRAN = Interface(
    "programs in Fortran 2018",
    fortran_files,
    "make -C {folder} test",
)
