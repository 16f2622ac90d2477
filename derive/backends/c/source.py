"""A model as C99: a header and a source file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate

from derive.artifacts import MARK, File
from derive.backends.c.batch import batch_body, batch_helpers, batch_widths, stack
from derive.backends.c.loops import LANES_MACRO, SHORT, Loops, panel_helper
from derive.backends.description import LICENCE, description, kernel_text, model_text, pattern_texts, section_text
from derive.backends.expression_text import c_number, statement, text
from derive.ir.model import Kernel, Model, Variable
from derive.ir.statements import Accumulate, Let, MatVec, Require, RequireFinite, Requirement, Store
from derive.rendering import comment, render, wrapped
from derive.roles import Role

ABI = 4

FORMS = {"index3": "", "ggl": "_ggl", "index1": "_index1"}
"""The forms of the equations of a scene, with what the names of their functions end in."""


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
    tables += [("lambda", model.multipliers)] if model.bodies else []
    sizes = {name: sum(v.size for v in variables) for name, variables in tables}
    mark = (f"{MARK} from a specification with SHA-256", f"{fingerprint}. Do not edit.", LICENCE, "")
    widths = batch_widths(model)
    names = {
        "model": model,
        "name": model.name,
        "macro": model.name.upper(),
        "abi": ABI,
        "roles": Role,
        "title": "\n".join(comment((*mark, f"{said.title}; see {model.name}.h."))),
        "description": "\n".join(comment((*mark, *description(said)))),
        "helpers": _helpers(model, widths),
        "defaults": defaults_text(model),
        "functions": [_function(model, kernel) for kernel in model.kernels],
        "batch_helpers": batch_helpers(model, widths),
        "batches": [_batch(model, name, width) for name, width in widths.items()],
        "batch_width": " or ".join(str(w) for w in sorted({*widths.values()})),
        "batch_stack": -(-max(stack(model, name, width) for name, width in widths.items()) // 1024),
        "patterns": pattern_texts(model, "    "),
        "markers": [(m.name, model.kernel(f"marker_{m.name}").outputs[0].size) for m in model.markers],
        "forms": FORMS if model.bodies else {},
        "energies": len(model.kernel("energy").outputs[0].elements),
        "sizes": sizes,
        "places": {name: placed(variables) for name, variables in tables},
        "momenta": len(model.kernel("momentum").outputs[0].elements),
        "tables": [{"name": n, "variables": variables} for n, variables in tables if variables],
        "members": {n: f"{model.name}_table_{n}" if variables else "0" for n, variables in tables}
        | {"markers": f"{model.name}_table_markers" if model.markers else "0"},
    }
    return (
        File(f"{model.name}/{model.name}.h", render("c/model.h.jinja", names)),
        File(f"{model.name}/{model.name}.c", render("c/model.c.jinja", names)),
    )


def _helpers(model: Model, widths: Mapping[str, int]) -> str:
    """What the loops of a model call."""
    every = [s for kernel in model.kernels for s in kernel.statements]
    lines = [LANES_MACRO] if min(widths.values()) <= SHORT or any(isinstance(s, Accumulate) for s in every) else []
    sizes = {s.packing.padded for s in every if isinstance(s, MatVec)}
    lines += [line for size in sizes for line in panel_helper(f"{model.name}_panel", size)]
    return "\n".join(lines)


def _function(model: Model, kernel: Kernel) -> Function:
    lines = _loads(kernel)
    loops = Loops(f"{model.name}_panel")
    for section in kernel.sections:
        lines += ["", *comment(section_text(section), "    ")]
        for item in section.body:
            lines += _statement(item) if isinstance(item, Let | Store | Require) else loops.lines(item)
    name = f"{model.name}_{kernel.name}"
    doc = "\n".join(comment(kernel_text(kernel)))
    return Function(name, doc, _signature(name, _parameters(kernel)), "\n".join(lines))


def _batch(model: Model, name: str, width: int) -> Function:
    kernel = model.kernel(name)
    called = f"{model.name}_{name}_batch"
    signature = _signature(called, ["int n", *_parameters(kernel)])
    return Function(called, "", signature, "\n".join(batch_body(model, kernel, width)))


def _signature(name: str, parameters: list[str]) -> str:
    return f"int {name}(\n    " + ",\n    ".join(parameters) + ")"


def _parameters(kernel: Kernel) -> list[str]:
    inputs = [
        f"double {a.name}" if a.scalar else f"const double *TISSERAND_RESTRICT {a.name}" for a in kernel.arguments
    ]
    return [*inputs, *(f"double *{o.name}" for o in kernel.outputs)]


def _loads(kernel: Kernel) -> list[str]:
    """Name the elements and arrays that are read; say which arguments are not."""
    lines = []
    used = kernel.used | {s.argument for s in kernel.statements if isinstance(s, RequireFinite)}
    for argument in kernel.arguments:
        read = [(k, n) for k, n in argument.named_elements if n in used]
        arrays = [view for view in argument.arrays if view.name in used]
        lines += [f"    const double {name} = {argument.name}[{k}];" for k, name in read]
        lines += [
            f"    const double *{v.name} = {argument.name}{f' + {v.offset}' if v.offset else ''};" for v in arrays
        ]
        if not read and not arrays and argument.name not in used:
            lines.append(f"    (void) {argument.name};")
    lines += [f"    (void) {o.name};" for o in kernel.outputs if not o.size]
    return lines


def _statement(item: Let | Store | Require) -> list[str]:
    value = text(item.expr, c_number)
    if isinstance(item, Let):
        return statement("    ", f"const double {item.name} = ", value, ";")
    if isinstance(item, Store):
        return statement("    ", f"{item.output}[{item.index}] = ", value, ";")
    test = f"!({value} > 0.0)" if item.kind is Requirement.POSITIVE else f"!isfinite({value})"
    return statement("    ", "if (", test, f") return {item.code}; /* {item.text} */")


def placed(variables: tuple[Variable, ...]) -> list[tuple[str, int]]:
    """Where each variable begins."""
    places = accumulate((v.size for v in variables), initial=0)
    return [(v.name, place) for v, place in zip(variables, places, strict=False)]


def defaults_text(model: Model) -> str:
    """The body of the function that fills p with the defaults."""
    values = model.defaults
    if not values:
        return "    (void) p;"
    kept = [(k, x) for k, x in enumerate(values) if x]
    if 2 * len(kept) > len(values) or len(kept) < 9:
        head = ", ".join(repr(x) for x in values)
        lines = wrapped([head], "        ")
        body = ["    static const double values[] = {", *lines, "    };"]
        return "\n".join([*body, f"    for (int i = 0; i < {len(values)}; i++) p[i] = values[i];"])
    places = wrapped([", ".join(str(k) for k, _ in kept)], "        ")
    numbers = wrapped([", ".join(repr(x) for _, x in kept)], "        ")
    return "\n".join(
        [
            *("    static const int indices[] = {", *places, "    };"),
            *("    static const double values[] = {", *numbers, "    };"),
            f"    for (int i = 0; i < {len(values)}; i++) p[i] = 0.0;",
            f"    for (int i = 0; i < {len(kept)}; i++) p[indices[i]] = values[i];",
        ]
    )
