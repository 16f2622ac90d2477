"""`--to octave`: a MEX function with the functions of a model, xdot for solvers, and a script that tests both."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.export.c_parts import INTEGRATOR, integrator_files, motion_file
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.reference_motion import reference_motion
from derive.ir.kernel import Argument, Kernel
from derive.ir.statements import ReturnCode
from derive.rendering import render


@dataclass(frozen=True)
class MexBranch:
    """A function that the MEX function calls by its name: arguments with their lengths, and those of its results."""

    name: str
    arguments: tuple[tuple[str, int], ...]
    results: tuple[tuple[str, int], ...]
    call: str


def octave_files(model: HostModel) -> tuple[File, ...]:
    """The files of a MEX function. Raises CompilerError, and what the integration of the reference motion raises."""
    name, motion = model.name, reference_motion(model)
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": name,
        "macro": name.upper(),
        "nu": len(model.inputs),
        "nlambda": len(model.multipliers),
        "codes": [(code.name.lower(), int(code), code.meaning) for code in ReturnCode if code],
        "branches": [_branch(name, kernel) for kernel in model.model.kernels],
        "tables": [
            ("states", model.states),
            ("inputs", model.inputs),
            ("outputs", model.outputs),
            ("parameters", model.parameters),
        ],
        "nq": len(model.coordinates),
        "end": f"{motion.times[-1]:g}",
        "constant_inputs": _numbers(model.constant_inputs),
        "numbers": _numbers,
        "times": _numbers(motion.times),
        "rows": [_numbers(row) for row in motion.states],
        "tolerances": _numbers(motion.tolerances),
        "sources": " ".join(f"{part}.c" for part in (f"{name}_mex", name, f"{name}_motion", *INTEGRATOR)),
    }
    return (
        File("build.m", render("export/octave/build.m.jinja", values)),
        File("sample.m", render("export/octave/sample.m.jinja", values)),
        File(f"{name}_info.m", render("export/octave/info.m.jinja", values)),
        File(f"{name}_ode.m", render("export/octave/ode.m.jinja", values)),
        File(f"{name}_mex.c", render("export/octave/mex.c.jinja", values)),
        File(f"{name}.h", model.header.text),
        File(f"{name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        motion_file(model, ""),
        *integrator_files("", name),
    )


def _branch(model: str, kernel: Kernel) -> MexBranch:
    arguments = tuple((a.name, 1 if a.scalar else a.size) for a in kernel.arguments)
    results = tuple((o.name, o.size) for o in kernel.outputs)
    given = [f"{_conversion(a)}in[{n}]" for n, a in enumerate(kernel.arguments)]
    call = ", ".join([*given, *(f"out[{n}]" for n in range(len(results)))])
    return MexBranch(kernel.name, arguments, results, f"{model}_{kernel.name}({call})")


def _conversion(argument: Argument) -> str:
    """The operators that make an argument of C of the address of its first number."""
    return ("(int) *" if argument.integer else "*") if argument.scalar else ""


def _numbers(values: Iterable[float | None]) -> str:
    """Numbers as the elements of a matrix, on lines that go on."""
    lines = prefixed([", ".join(repr(float(value or 0.0) + 0.0) for value in values)], "    ")
    return " ...\n".join(lines)


OCTAVE = Interface(
    "GNU Octave, by a MEX function",
    octave_files,
    "cd {folder} && octave-cli --no-history build.m && octave-cli --no-history sample.m",
)
