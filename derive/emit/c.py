"""A model as C99: a header and a source file."""

from __future__ import annotations

from dataclasses import dataclass

from derive.emit.document import LICENCE, description, kernel_text, model_text, pattern_texts, section_text
from derive.emit.expression import c_number, statement, text
from derive.emit.files import MARK, File
from derive.emit.template import comment, render
from derive.kernel.ir import Kernel, Let, Statement, Store
from derive.kernel.model import Model

ABI = 2


@dataclass(frozen=True)
class Function:
    """One C function as text."""

    name: str
    doc: str
    signature: str
    body: str


def c_files(model: Model, fingerprint: str) -> tuple[File, ...]:
    """`NAME.h` and `NAME.c`."""
    said = model_text(model)
    tables = [("p", model.parameters), ("k", model.constants), ("q", model.coordinates), ("v", model.rates)]
    mark = (f"{MARK} from a specification with SHA-256", f"{fingerprint}. Do not edit.", LICENCE, "")
    names = {
        "model": model,
        "name": model.name,
        "macro": model.name.upper(),
        "abi": ABI,
        "title": "\n".join(comment((*mark, f"{said.title}; see {model.name}.h."))),
        "description": "\n".join(comment((*mark, *description(said)))),
        "functions": [_function(model, kernel) for kernel in model.kernels],
        "patterns": pattern_texts(model, "    "),
        "markers": [(m.name, len(model.kernel(f"marker_{m.name}").outputs[0].elements)) for m in model.markers],
        "energies": len(model.kernel("energy").outputs[0].elements),
        "momenta": len(model.kernel("momentum").outputs[0].elements),
        "tables": [{"name": n, "variables": variables} for n, variables in tables if variables],
        "members": {n: f"{model.name}_table_{n}" if variables else "0" for n, variables in tables}
        | {"markers": f"{model.name}_table_markers" if model.markers else "0"},
    }
    return (
        File(f"{model.name}/{model.name}.h", render("c/model.h.jinja", names)),
        File(f"{model.name}/{model.name}.c", render("c/model.c.jinja", names)),
    )


def _function(model: Model, kernel: Kernel) -> Function:
    lines = [*_loads(kernel)]
    for section in kernel.sections:
        lines += ["", *comment(section_text(section), "    ")]
        for item in section.body:
            lines += _statement(item)
    inputs = [
        f"double {a.name}" if a.scalar else f"const double *TISSERAND_RESTRICT {a.name}" for a in kernel.arguments
    ]
    outputs = [f"double *{o.name}" for o in kernel.outputs]
    name = f"{model.name}_{kernel.name}"
    signature = f"int {name}(\n    " + ",\n    ".join([*inputs, *outputs]) + ")"
    return Function(name, "\n".join(comment(kernel_text(kernel))), signature, "\n".join(lines))


def _loads(kernel: Kernel) -> list[str]:
    """Name the elements that are read; say which arguments are not."""
    lines = []
    used = kernel.used
    for argument in kernel.arguments:
        read = [(k, n) for k, n in enumerate(argument.elements) if n in used]
        lines += [f"    const double {name} = {argument.name}[{k}];" for k, name in read]
        if not read and argument.name not in used:
            lines.append(f"    (void) {argument.name};")
    lines += [f"    (void) {o.name};" for o in kernel.outputs if not o.elements]
    return lines


def _statement(item: Statement) -> list[str]:
    value = text(item.expr, c_number)
    if isinstance(item, Let):
        return statement("    ", f"const double {item.name} = ", value, ";")
    if isinstance(item, Store):
        return statement("    ", f"{item.output}[{item.index}] = ", value, ";")
    test = f"!({value} > 0.0)" if item.kind == "positive" else f"!isfinite({value})"
    return statement("    ", "if (", test, f") return {item.code}; /* {item.text} */")
