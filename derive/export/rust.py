"""`--to rust`: a crate without the standard library, whose build script compiles the C, and a test of its motion."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from derive.artifacts import MARK, File
from derive.backends.c.source import ABI
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.errors import Problem, SpecError
from derive.export.c_parts import INTEGRATOR, integrator_files, motion_file
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.reference_motion import reference_motion
from derive.ir.kernel import Kernel
from derive.ir.statements import ReturnCode
from derive.rendering import render

KEPT = ("u", "k")
"""The arguments that a value of the type `Model` holds: inputs and constants."""


_WORDS = """\
abstract as async await become box crate do dyn final fn gen impl in let loop macro match mod move mut override priv pub
ref self Self super trait try type typeof unsafe unsized use where yield
"""
WORDS = frozenset(_WORDS.split())
"""The keywords of Rust that are not in C or C++, whose keywords no specification accepts as a name."""
PATHS = frozenset(("crate", "self", "Self", "super"))
"""The keywords of Rust that r# does not turn into names."""
CRATES = frozenset(("alloc", "core", "proc_macro", "std", "test"))
"""The crates of Rust itself."""


@dataclass(frozen=True)
class CrateFunction:
    """A function of C and the method that calls it: comment, name, parameters of both, arguments of the call."""

    doc: Sequence[str]
    name: str
    declared: str
    parameters: str
    arguments: str


def rust_files(model: HostModel) -> tuple[File, ...]:
    """The files of a crate.

    Raises SpecError for a name that no crate can have, CompilerError, and what the integration of the reference motion
    raises.
    """
    name = model.name
    if name in WORDS | CRATES:
        what = "word" if name in WORDS else "crate"
        text = f"{name} is a {what} of Rust, and cannot be the name of a crate; choose another"
        raise SpecError((Problem("name", text),))
    motion = reference_motion(model)
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": name,
        "abi": ABI,
        "title": model.model.doc,
        "sizes": _sizes(model),
        "indices": _indices(model),
        "codes": [(code.name, code.value, code.meaning) for code in ReturnCode if code],
        "methods": [_method(kernel) for kernel in model.model.kernels if kernel.name != "setup"],
        "q": _numbers(x.start for x in model.coordinates),
        "v": _numbers(x.start for x in model.velocities),
        "u": _numbers(model.constant_inputs),
        "times": _numbers(motion.times),
        "rows": [_numbers(row) for row in motion.states],
        "tolerances": _numbers(motion.tolerances),
        "sources": [f"{part}.c" for part in (name, f"{name}_motion", *INTEGRATOR)],
    }
    return (
        File("Cargo.toml", render("export/rust/Cargo.toml.jinja", values)),
        File("build.rs", render("export/rust/build.rs.jinja", values)),
        File("src/lib.rs", render("export/rust/lib.rs.jinja", values)),
        File("tests/motion.rs", render("export/rust/motion.rs.jinja", values)),
        File(f"c/{name}.h", model.header.text),
        File(f"c/{name}.c", model.source.text),
        File("manifest.json", model.manifest.text),
        motion_file(model, "c/"),
        *integrator_files("c/"),
    )


def _sizes(model: HostModel) -> list[tuple[str, int]]:
    tables = [("NQ", model.coordinates), ("NV", model.velocities), ("NP", model.parameters), ("NU", model.inputs)]
    tables += [("NOUT", model.outputs), ("NLAMBDA", model.multipliers)]
    constants = sum(constant.size for constant in model.model.constants)
    return [*((name, len(table)) for name, table in tables), ("NK", constants)]


def _indices(model: HostModel) -> list[tuple[str, list[tuple[str, int]]]]:
    """Modules of the positions of coordinates and others in their arrays."""
    tables = [("q", model.coordinates), ("v", model.velocities), ("p", model.parameters), ("u", model.inputs)]
    tables += [("out", model.outputs), ("lambda", model.multipliers)]
    return [(name, [(_identifier(x.name), k) for k, x in enumerate(table)]) for name, table in tables if table]


def _identifier(name: str) -> str:
    if name in PATHS:
        return f"{name}_"
    return f"r#{name}" if name in WORDS else name


def _method(kernel: Kernel) -> CrateFunction:
    declared, parameters, arguments = [], [], []
    for argument in kernel.arguments:
        name = argument.name
        declared.append(f"{name}: f64" if argument.scalar else f"{name}: *const f64")
        if name in KEPT:
            arguments.append(f"self.{name}.as_ptr()")
        elif argument.scalar:
            parameters.append(f"{name}: f64")
            arguments.append(name)
        else:
            parameters.append(f"{name}: &[f64; {argument.size}]")
            arguments.append(f"{name}.as_ptr()")
    for output in kernel.outputs:
        declared.append(f"{output.name}: *mut f64")
        parameters.append(f"{output.name}: &mut [f64; {output.size}]")
        arguments.append(f"{output.name}.as_mut_ptr()")
    doc = prefixed([kernel.doc], "    /// ")
    return CrateFunction(doc, kernel.name, ", ".join(declared), ", ".join(parameters), ", ".join(arguments))


def _numbers(values: Iterable[float | None]) -> str:
    """Numbers as the elements of an array, on lines."""
    return "\n".join(prefixed([", ".join(repr(float(value or 0.0) + 0.0) for value in values)], "        "))


RUST = Interface(
    "programs in Rust, also without the standard library", rust_files, "cargo test --manifest-path {folder}/Cargo.toml"
)
