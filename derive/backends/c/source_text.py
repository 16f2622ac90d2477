"""The text of C99: the functions of a model, their batches, patterns and descriptor."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate, groupby

from derive.artifacts import MARK, File
from derive.backends.c.batch import KERNELS as BATCHED
from derive.backends.c.batch import batch_blocks, batch_function, batch_helpers, stack
from derive.backends.c.batch_block import StateBlock
from derive.backends.c.beginnings import (
    beginnings,
    by_solution,
    calling,
    calling_repeated,
    calling_solution,
    repeated_functions,
)
from derive.backends.c.composed_names import ComposedNames, composed_names
from derive.backends.c.forms import shared_forms
from derive.backends.c.functions_of_kernels import (
    constant_array,
    divided,
    function,
    function_in_parts,
    function_of_form,
    function_of_forms,
    has_sine,
    shared_function,
    signature_of,
)
from derive.backends.c.linear_sums import LinearSums, linear_sums
from derive.backends.c.optional_parts import REDUCED_FORMS, OptionalPart, optional_part
from derive.backends.c.packed import entries, packed_functions
from derive.backends.c.shared_sections import shared_sections
from derive.backends.c.splines import spline_lines
from derive.backends.description import (
    LICENCE,
    MODEL_HASH,
    description,
    integer_lines,
    kernel_text,
    model_text,
    pattern_texts,
)
from derive.backends.source_map import SourceBuilder, plain
from derive.backends.wrapping import comment, prefixed
from derive.enumerations import enumeration
from derive.function_names import OF_MODELS
from derive.ir.model import Model, Variable
from derive.ir.sums_over_modes import with_sums_over_modes
from derive.ir.tiles import numbers_of_instances, tiled
from derive.ir.variants import Variants
from derive.ir.written_out_rows import with_rows_written_out
from derive.rendering import render
from derive.roles import Role

SOLVING = frozenset(("setup", "accel", "solve", "project_velocity", "solve_kkt"))
"""The functions that check what they compute: pivots, and that results are finite."""

FORMS = {"index3": "", **REDUCED_FORMS}
"""The forms of the equations of a scene, with the suffixes of the names of their functions."""


def header_and_source(
    model: Model, fingerprint: str, abi: int, header: str, source: str, batches: bool
) -> tuple[File, File]:
    """The header and the source file of a model, with their paths.

    fingerprint: that of the specification; abi: the number of the interface; batches: whether there are functions of
    batches.
    """
    sums = linear_sums(model)
    forms = {kernel.name: of for of in shared_forms(model) for kernel in of.kernels}
    model = with_sums_over_modes(model, forms)
    blocks = batch_blocks(with_rows_written_out(model), sums) if batches else {}
    values = _template_values(model, fingerprint, abi, sums, forms, blocks)
    builder = SourceBuilder(model)
    builder.text(render("c/prologue.c.jinja", values))
    shared = {first: model.kernel(whole) for first, whole in beginnings(model).items()}
    solved = by_solution(model)
    again = {name: other for name, other in repeated_functions(model).items() if name not in {**forms, **shared}}
    written = [kernel for kernel in model.kernels if kernel.name not in (*shared, *solved, *again)]
    sections = shared_sections(model, written)
    for section in sections.values():
        builder.text("".join(f"{line.text}\n" for line in [*section.function(), *plain("")]))
    for table in sums.tables:
        builder.text("".join(f"{line.text}\n" for line in table.function()))
    for part, kernels in groupby(model.kernels, lambda kernel: optional_part(kernel.name)):
        builder.text(f"#ifndef {part.value}\n\n" if part else "")
        for kernel in kernels:
            if whole := shared.get(kernel.name):
                builder.function(whole, shared_function(model, kernel, whole, sections))
                builder.text("\n")
                builder.function(kernel, calling(model, kernel, whole))
            elif kernel in shared.values():
                builder.text("".join(f"{line.text}\n" for line in calling(model, kernel, kernel)))
            elif whole := solved.get(kernel.name):
                builder.function(kernel, calling_solution(model, kernel, whole))
            elif other := again.get(kernel.name):
                builder.function(kernel, calling_repeated(model, kernel, other))
            elif of := forms.get(kernel.name):
                if kernel is of.kernels[0]:
                    builder.text("".join(f"{line.text}\n" for line in function_of_forms(model, of)))
                builder.function(kernel, function_of_form(model, kernel, of))
            else:
                head, own = signature_of(model, kernel), sums.kernels.get(kernel.name)
                parts = divided(model, kernel, own)
                lines = function_in_parts(parts, head, own) if parts else function(kernel, head, sections, sums=own)
                builder.function(kernel, lines)
            builder.text("\n")
        builder.text("#endif\n\n" if part else "")
    builder.text(render("c/epilogue.c.jinja", values))
    return File(header, render("c/model.h.jinja", values)), builder.file("c", source)


@dataclass(frozen=True)
class Declaration:
    """The signature of a function, with the comment before it in the header."""

    doc: str
    signature: str


def _template_values(
    model: Model,
    fingerprint: str,
    abi: int,
    sums: LinearSums,
    forms: Mapping[str, Variants],
    blocks: Mapping[str, StateBlock],
) -> dict[str, object]:
    text_of_model = model_text(model)
    tables = [("p", model.parameters), ("k", model.constants), ("q", model.coordinates), ("v", model.velocities)]
    tables += [("lambda", model.multipliers)] if model.is_scene else []
    tables += [("u", model.inputs), ("out", model.outputs)]
    sizes = {name: sum(v.size for v in variables) for name, variables in tables}
    mark = (f"{MARK} from a specification with SHA-256", f"{fingerprint}. Do not edit.", LICENCE, "")
    names = composed_names(model) if model.lowering == "instances" else None
    checked = [f"{name}_batch" for name in blocks if model.kernel(name).checked]
    patterns = pattern_texts(model, "    ")
    return {
        "model": model,
        "name": model.name,
        "macro": model.name.upper(),
        "abi": abi,
        "hash": MODEL_HASH,
        "roles": Role,
        "title": "\n".join(comment((*mark, f"{text_of_model.title}; see {model.name}.h."))),
        "description": "\n".join(comment((*mark, *description(text_of_model)))),
        "helpers": _helpers(model, sums, forms, blocks),
        "defaults": defaults_text(model),
        "start": _start_text(model),
        "declarations": [
            Declaration("\n".join(comment(kernel_text(kernel))), "\n".join(signature_of(model, kernel)))
            for kernel in model.kernels
        ],
        "batch_helpers": batch_helpers(model, blocks),
        "batched": enumeration([*blocks]),
        "batch_names": [f"{name}_batch" for name in BATCHED],
        "batches": [batch_function(block) for block in blocks.values()],
        "batch_width": " or ".join(str(w) for w in sorted({block.width for block in blocks.values()})),
        "batch_stack": -(-max(map(stack, blocks.values()), default=0) // 1024),
        "patterns": patterns,
        "sparsities": defaultdict(lambda: "0", {p.name: f"&{model.name}_sparsity_{p.name}" for p in patterns}),
        "requested": OF_MODELS,
        "markers": [(m.name, m.title, model.kernel(f"marker_{m.name}").outputs[0].size) for m in model.markers],
        "forms": FORMS if model.is_scene and not model.explicit else {},
        "reduced_forms": REDUCED_FORMS,
        "without": {part.name.lower(): part.value for part in OptionalPart},
        "solving": enumeration([kernel.name for kernel in model.kernels if kernel.name in SOLVING]),
        "checked_forces": model.is_scene and model.kernel("force").checked,
        "attitude": any(q.role is Role.QUATERNION for q in model.coordinates),
        "several_checked": len(checked) > 1,
        "checked_batches": f"{enumeration(checked)} give{'s' if len(checked) == 1 else ''}" if checked else "",
        "entries": entries(model, tuple(blocks)),
        "packed": list(packed_functions(model, tuple(blocks))),
        "energies": len(model.kernel("energy").outputs[0].elements),
        "sizes": sizes,
        "indices": {
            name: names.indices(name) if names and _composed(names, name) else _first_indices(variables)
            for name, variables in tables
        },
        "momenta": len(model.kernel("momentum").outputs[0].elements),
        "tables": [
            {"name": n, "variables": variables} for n, variables in tables if variables and not _composed(names, n)
        ],
        "names": names,
        "integer_lines": integer_lines,
        "series_macros": names.macros(model.name.upper()) if names else [],
        "members": {n: f"{model.name}_table_{n}" if variables else "0" for n, variables in tables}
        | {"markers": f"{model.name}_table_markers" if model.markers else "0"},
    }


def _composed(names: ComposedNames | None, table: str) -> bool:
    """Whether the names of a table are composed when the descriptor is asked for."""
    return names is not None and any(of.name == table for of in names.tables)


def _helpers(model: Model, sums: LinearSums, forms: Mapping[str, Variants], blocks: Mapping[str, StateBlock]) -> str:
    """The macros, static functions and constant arrays that the functions of a model use."""
    every = [s for kernel in model.kernels for s in kernel.statements]
    parts = ["lanes"] if model.lowering != "flat" or sums.tables else []
    parts += ["instances"] if model.lowering == "instances" else []
    sines = ["sine", *(["spaced_sines"] if model.lowering == "instances" else [])]
    parts += ["states", *(sines if any(map(has_sine, every)) else [])]
    used = {array.name for kernel in model.kernels if kernel.name not in forms for array in kernel.constants}
    used |= {name for of in forms.values() for name in of.reads}
    of_batches = {array.name: array for block in blocks.values() for array in block.kernel.constants}
    constants = (
        *({a.name: a for a in model.constant_arrays if a.name in used} | of_batches).values(),
        *(table.array for table in sums.tables),
    )
    tables = numbers_of_instances(constants)
    arrays = [line for array in constants for line in constant_array(array)]
    arrays += [line for array in tables.values() for line in constant_array(tiled(array), in_tiles=True)]
    return "\n".join([*(render(f"c/{part}.c.jinja", {}) for part in parts), *spline_lines(model), *arrays])


def _first_indices(variables: tuple[Variable, ...]) -> list[tuple[str, int]]:
    """The name and the index of the first value of each variable."""
    indices = accumulate((v.size for v in variables), initial=0)
    return [(v.name, index) for v, index in zip(variables, indices, strict=False)]


def _start_text(model: Model) -> str:
    """The body of the function that fills q and v with the initial state, "" without one."""
    if model.start is None:
        return ""
    lines = []
    for name, values in (("q", model.start.q), ("v", model.start.v)):
        if not values:
            lines += [f"    (void) {name};"]
            continue
        numbers = prefixed([", ".join(repr(x) for x in values)], "        ")
        lines += [f"    static const double {name}_values[] = {{", *numbers, "    };"]
    lines += [
        f"    for (int i = 0; i < {len(values)}; i++) {name}[i] = {name}_values[i];"
        for name, values in (("q", model.start.q), ("v", model.start.v))
        if values
    ]
    return "\n".join(lines)


def defaults_text(model: Model) -> str:
    """The body of the function that fills p with the defaults."""
    values = model.defaults
    if not values:
        return "    (void) p;"
    kept = [(k, x) for k, x in enumerate(values) if x]
    if 2 * len(kept) > len(values) or len(kept) < 9:
        head = ", ".join(repr(x) for x in values)
        lines = prefixed([head], "        ")
        body = ["    static const double values[] = {", *lines, "    };"]
        return "\n".join([*body, f"    for (int i = 0; i < {len(values)}; i++) p[i] = values[i];"])
    indices = prefixed([", ".join(str(k) for k, _ in kept)], "        ")
    numbers = prefixed([", ".join(repr(x) for _, x in kept)], "        ")
    return "\n".join(
        [
            *("    static const int indices[] = {", *indices, "    };"),
            *("    static const double values[] = {", *numbers, "    };"),
            f"    for (int i = 0; i < {len(values)}; i++) p[i] = 0.0;",
            f"    for (int i = 0; i < {len(kept)}; i++) p[indices[i]] = values[i];",
        ]
    )
