"""The backend of C99: the functions of a model, their batches, patterns and descriptor."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, groupby

from derive.artifacts import MARK, File
from derive.backends.c.batch import KERNELS as BATCHED
from derive.backends.c.batch import batch_blocks, batch_function, batch_helpers, stack
from derive.backends.c.beginnings import beginnings, calling, shared_signature, without_last
from derive.backends.c.composed_names import ComposedNames, composed_names
from derive.backends.c.forms import form_call, form_signature, shared_forms
from derive.backends.c.function_parts import DividedFunction, NumberedNodes, divided_function
from derive.backends.c.linear_sums import KernelSums, LinearSums, linear_sums
from derive.backends.c.loop_text import vector_starts
from derive.backends.c.nests import CNests
from derive.backends.c.optional_parts import REDUCED_FORMS, OptionalPart, optional_part
from derive.backends.c.packed import entries, packed_functions
from derive.backends.c.shared_sections import SharedSections, shared_sections
from derive.backends.c.signatures import parameters, signature
from derive.backends.c.splines import spline_lines
from derive.backends.description import (
    LICENCE,
    MODEL_HASH,
    description,
    integer_lines,
    kernel_text,
    model_text,
    pattern_texts,
    section_text,
)
from derive.backends.source_map import SourceBuilder, SourceLine, plain
from derive.backends.wrapping import comment, prefixed
from derive.ir.analysis import expressions, names_read
from derive.ir.expansion import expand
from derive.ir.expressions import Expr, Operation, Operator, walk
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.lanes import section_in_lanes
from derive.ir.loop_nests import For, Node, every, expressions_of
from derive.ir.model import Model, Variable
from derive.ir.statements import Let, Statement
from derive.ir.variants import Variants
from derive.rendering import render
from derive.roles import Role

ABI = 8
SOLVING = frozenset(("setup", "accel", "solve", "project_velocity", "solve_kkt"))
"""The functions that check what they compute: pivots, and that results are finite."""

MANY = 24
"""Iterations of a loop over bodies beside which a function computes the sines of single bodies.

Compilers take as long for a sine as for the rest of a body, and a call takes up to a quarter of the time of a body:
two bodies of ten cost the Jacobian of a chain 5 %, two of a hundred nothing that can be measured.
"""

FORMS = {"index3": "", **REDUCED_FORMS}
"""The forms of the equations of a scene, with the suffixes of the names of their functions."""


class CBackend:
    """C99 that is also valid C++: a header and a source file."""

    name = "c"

    def file_names(self, model: str) -> tuple[str, ...]:
        """The paths of the files of a model below the output folder: the header and the source file."""
        return f"{model}/{model}.h", f"{model}/{model}.c"

    def files(self, model: Model, fingerprint: str) -> tuple[File, ...]:
        """`NAME.h`, and `NAME.c` with its source map; `fingerprint` is that of the specification."""
        header, source = self.file_names(model.name)
        sums = linear_sums(model)
        forms = {kernel.name: of for of in shared_forms(model) for kernel in of.kernels}
        values = _template_values(model, fingerprint, sums, forms)
        builder = SourceBuilder(model)
        builder.text(render("c/prologue.c.jinja", values))
        shared = {first: model.kernel(whole) for first, whole in beginnings(model).items()}
        sections = shared_sections(model, [kernel for kernel in model.kernels if kernel.name not in shared])
        for section in sections.values():
            builder.text("".join(f"{line.text}\n" for line in [*section.function(), *plain("")]))
        for table in sums.tables:
            builder.text("".join(f"{line.text}\n" for line in table.function()))
        for part, kernels in groupby(model.kernels, lambda kernel: optional_part(kernel.name)):
            builder.text(f"#ifndef {part.value}\n\n" if part else "")
            for kernel in kernels:
                if whole := shared.get(kernel.name):
                    builder.function(whole, _shared_function(model, kernel, whole, sections))
                    builder.text("\n")
                    builder.function(kernel, calling(model, kernel, whole))
                elif kernel in shared.values():
                    builder.text("".join(f"{line.text}\n" for line in calling(model, kernel, kernel)))
                elif of := forms.get(kernel.name):
                    if kernel is of.kernels[0]:
                        builder.text("".join(f"{line.text}\n" for line in _of_forms(model, of)))
                    builder.function(kernel, _of_form(model, kernel, of))
                else:
                    head, own = _signature_of(model, kernel), sums.kernels.get(kernel.name)
                    parts = _divided(model, kernel, own)
                    lines = _function_in_parts(parts, head, own) if parts else None
                    builder.function(kernel, lines or _function(kernel, head, sections, sums=own))
                builder.text("\n")
            builder.text("#endif\n\n" if part else "")
        builder.text(render("c/epilogue.c.jinja", values))
        return File(header, render("c/model.h.jinja", values)), builder.file(self.name, source)


@dataclass(frozen=True)
class Declaration:
    """The signature of a function, with the comment before it in the header."""

    doc: str
    signature: str


def _template_values(
    model: Model, fingerprint: str, sums: LinearSums, forms: Mapping[str, Variants]
) -> dict[str, object]:
    text_of_model = model_text(model)
    tables = [("p", model.parameters), ("k", model.constants), ("q", model.coordinates), ("v", model.velocities)]
    tables += [("lambda", model.multipliers)] if model.bodies else []
    tables += [("u", model.inputs), ("out", model.outputs)]
    sizes = {name: sum(v.size for v in variables) for name, variables in tables}
    mark = (f"{MARK} from a specification with SHA-256", f"{fingerprint}. Do not edit.", LICENCE, "")
    names = composed_names(model) if model.lowering == "instances" else None
    blocks = batch_blocks(model, sums)
    checked = [f"{name}_batch" for name in blocks if model.kernel(name).checked]
    return {
        "model": model,
        "name": model.name,
        "macro": model.name.upper(),
        "abi": ABI,
        "hash": MODEL_HASH,
        "roles": Role,
        "title": "\n".join(comment((*mark, f"{text_of_model.title}; see {model.name}.h."))),
        "description": "\n".join(comment((*mark, *description(text_of_model)))),
        "helpers": _helpers(model, sums, forms),
        "defaults": defaults_text(model),
        "start": _start_text(model),
        "declarations": [
            Declaration("\n".join(comment(kernel_text(kernel))), "\n".join(_signature_of(model, kernel)))
            for kernel in model.kernels
        ],
        "batch_helpers": batch_helpers(model, blocks),
        "batched": enumerated(BATCHED),
        "batch_names": [f"{name}_batch" for name in BATCHED],
        "batches": [batch_function(block) for block in blocks.values()],
        "batch_width": " or ".join(str(w) for w in sorted({block.width for block in blocks.values()})),
        "batch_stack": -(-max(map(stack, blocks.values())) // 1024),
        "patterns": pattern_texts(model, "    "),
        "markers": [(m.name, m.title, model.kernel(f"marker_{m.name}").outputs[0].size) for m in model.markers],
        "forms": FORMS if model.bodies and not model.explicit else {},
        "reduced_forms": REDUCED_FORMS,
        "without": {part.name.lower(): part.value for part in OptionalPart},
        "solving": enumerated([kernel.name for kernel in model.kernels if kernel.name in SOLVING]),
        "checked_forces": bool(model.bodies) and model.kernel("force").checked,
        "attitude": any(q.role is Role.QUATERNION for q in model.coordinates),
        "several_checked": len(checked) > 1,
        "checked_batches": f"{enumerated(checked)} give{'s' if len(checked) == 1 else ''}" if checked else "",
        "entries": entries(model, BATCHED),
        "packed": list(packed_functions(model, BATCHED)),
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


def enumerated(names: Sequence[str]) -> str:
    """Names as in a sentence."""
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def _helpers(model: Model, sums: LinearSums, forms: Mapping[str, Variants]) -> str:
    """The macros, static functions and constant arrays that the functions of a model use."""
    every = [s for kernel in model.kernels for s in kernel.statements]
    parts = ["lanes"] if model.lowering != "flat" or sums.tables else []
    parts += ["instances"] if model.lowering == "instances" else []
    sines = ["sine", *(["sine_apart"] if model.lowering == "instances" else [])]
    parts += ["states", *(sines if any(map(_has_sine, every)) else [])]
    used = {array.name for kernel in model.kernels if kernel.name not in forms for array in kernel.constants}
    used |= {name for of in forms.values() for name in of.reads}
    constants = (
        *(array for array in model.constant_arrays if array.name in used),
        *(table.array for table in sums.tables),
    )
    arrays = (line for array in constants for line in _constant_array(array))
    return "\n".join([*(render(f"c/{part}.c.jinja", {}) for part in parts), *spline_lines(model), *arrays])


def _constant_array(array: ConstantArray) -> list[str]:
    """The definition of a constant array."""
    kind = "int" if array.integers else "double"
    values = (str(value) if array.integers else repr(float(value)) for value in array.values)
    return [f"static const {kind} {array.name}[] = {{", *prefixed([", ".join(values)], "    "), "};", ""]


def _shared_function(model: Model, kernel: Kernel, whole: Kernel, shared: SharedSections) -> list[SourceLine]:
    """The static function of a kernel that begins with another one, after which it ends if the caller wants no more."""
    return _function(whole, shared_signature(model, whole), shared, {len(kernel.sections): without_last(whole)})


def _function(
    kernel: Kernel,
    head: Sequence[str],
    shared: SharedSections,
    before: Mapping[int, Sequence[str]] | None = None,
    sums: KernelSums | None = None,
) -> list[SourceLine]:
    """The function of a kernel. Elements of arguments are loaded where they are needed first.

    head: its signature; shared: the sections that have a function; before: lines before its sections, by the numbers of
    these; sums: what it becomes if it has sums of a table.

    Compilers keep values in the order of the text: what is loaded before a call, such as that of a sine far from
    0, or long before its use, goes to the stack in between.
    """
    named = _arguments(kernel, kernel.used)
    lines = [*plain(*head, "{", *named), *(sums.lines if sums else ())]
    sections = [_in_lanes(body) for body in _numbered_statements(kernel, sums)]
    nodes = [node for section in sections for _, part in section for node in part]
    starts = vector_starts(nodes)
    counter = "ptrdiff_t" if kernel.repeats else "int"
    apart = kernel.repeats and _sines_of_many(nodes)
    nests = CNests({o.name for o in kernel.outputs}, starts=starts, counter=counter, sines_apart=apart)
    loads = _element_loads(kernel)
    for k, (section, body) in enumerate(zip(kernel.sections, sections, strict=True)):
        lines += plain(*(before or {}).get(k, ()))
        if not body:
            continue
        lines += plain(*([""] if k or named or sums else []), *comment([section_text(section)], "    "))
        call = shared.get(section.body)
        lines += [line.of(k, 0) for line in call.call()] if call else _section(body, k, nests, loads)
    return [*lines, *plain("    return 0;", "}")]


def _of_forms(model: Model, of: Variants) -> list[SourceLine]:
    """The static function that the functions of some forms call, behind its tables."""
    kernel = of.kernels[0]
    used = frozenset(name for k in of.kernels for name in k.used)
    named = [*_arguments(kernel, used), *([] if of.differ else [f"    (void) {of.selector};"])]
    lines = plain(*form_signature(model, of), "{", *named, "")
    nests = CNests({o.name for o in kernel.outputs}, counter="ptrdiff_t")
    lines += _section(((0, (node,)) for node in of.nodes), 0, nests, _element_loads(kernel))
    tables = (line for table in of.tables for line in _constant_array(table))
    return [*plain(*tables), *lines, *plain("    return 0;", "}", "")]


def _of_form(model: Model, kernel: Kernel, of: Variants) -> list[SourceLine]:
    """The function of a form: what comes before the loops, and a call."""
    (section,) = kernel.sections
    lines = plain(*_signature_of(model, kernel), "{", *comment([section_text(section)], "    "))
    before = _in_lanes([*enumerate(of.before[of.kernels.index(kernel)])])
    nests = CNests({o.name for o in kernel.outputs}, counter="ptrdiff_t")
    return [*lines, *_section(before, 0, nests, _element_loads(kernel)), *form_call(model, kernel, of)]


def _sines_of_many(nodes: Iterable[Node]) -> bool:
    """Whether a loop over many bodies computes sines, so that those of single bodies take little of the time."""
    loops = (node for node in every(nodes) if isinstance(node, For) and (node.count or 0) >= MANY)
    parts = (part for loop in loops for line in every(loop.body) for e in expressions_of(line) for part in walk(e))
    return any(map(_is_sine, parts))


def _divided(model: Model, kernel: Kernel, sums: KernelSums | None) -> DividedFunction | None:
    """The parts of a long function in straight-line code, which compilers take less time for."""
    if model.lowering != "flat":
        return None
    body = [
        NumberedNodes(k, number, tuple(expand(statement)))
        for k, section in enumerate(_numbered_statements(kernel, sums))
        for number, statement in section
    ]
    arrays = (array for array, _ in sums.arrays) if sums else ()
    return divided_function(f"{model.name}_{kernel.name}", kernel, body, arrays)


def _function_in_parts(function: DividedFunction, head: Sequence[str], sums: KernelSums | None) -> list[SourceLine]:
    """The static functions of the parts of a kernel, and the function of the kernel, which calls them."""
    kernel, lines = function.kernel, list[SourceLine]()
    section = -1
    for part in function.parts:
        nests = CNests({o.name for o in kernel.outputs})
        loads = _element_loads(kernel)
        loads |= {name: f"    const double {name} = {function.kept}[{place}];" for name, place in part.loaded.items()}
        body: list[SourceLine] = []
        for item in part.body:
            if item.section != section:
                section = item.section
                heading = comment([section_text(kernel.sections[section])], "    ")
                body += plain(*([""] if body else []), *heading)
            body += _section([(item.statement, item.nodes)], section, nests, loads)
            for node in item.nodes:
                if isinstance(node, Let) and node.name in part.stored:
                    body += plain(f"    {function.kept}[{part.stored[node.name]}] = {node.name};")
        lines += function.function(part, body)
    return [*lines, *plain(*head, "{"), *(sums.lines if sums else ()), *function.calls(), *plain("    return 0;", "}")]


def _numbered_statements(kernel: Kernel, sums: KernelSums | None) -> Iterable[Sequence[tuple[int, Statement]]]:
    """The statements of the sections with their numbers, without the sums of a table."""
    return sums.parts.sections if sums else [tuple(enumerate(section.body)) for section in kernel.sections]


def _in_lanes(body: Sequence[tuple[int, Statement]]) -> list[tuple[int, tuple[Node, ...]]]:
    """The statements of a section as plain statements, with their numbers."""
    numbers = [number for number, _ in body]
    return [(numbers[n], nodes) for n, nodes in section_in_lanes([statement for _, statement in body])]


def _section(
    body: Iterable[tuple[int, tuple[Node, ...]]], number: int, nests: CNests, loads: dict[str, str]
) -> list[SourceLine]:
    """The lines of a section; matrices that are stored block by block are within the products before them.

    body: its plain statements with the numbers of its statements. loads: the lines that load elements; those that the
    section needs are taken out.
    """
    lines: list[SourceLine] = []
    for n, nodes in body:
        lines += plain(*(loads.pop(name) for name in dict.fromkeys(names_read(nodes)) if name in loads))
        printed = nests.lines(nodes)
        lines += [line.of(number, n if line.statement is None else line.statement) for line in printed]
    return lines


def _has_sine(item: Statement) -> bool:
    return any(_is_sine(part) for e in expressions(item) for part in walk(e))


def _is_sine(part: Expr) -> bool:
    return isinstance(part, Operation) and part.kind in (Operator.SIN, Operator.COS)


def _signature_of(model: Model, kernel: Kernel) -> list[str]:
    return signature(f"int {model.name}_{kernel.name}", parameters(kernel))


def _element_loads(kernel: Kernel) -> dict[str, str]:
    """The lines that name the elements of arguments, by these names."""
    return {
        name: f"    const double {name} = {argument.name}[{index}];"
        for argument in kernel.arguments
        for index, name in argument.named_elements
    }


def _arguments(kernel: Kernel, used: frozenset[str]) -> list[str]:
    """Name the arrays that are read; mark the arguments that are not."""
    lines = []
    for argument in kernel.arguments:
        read = any(name in used for name in argument.elements)
        arrays = [view for view in argument.parts if view.name in used]
        lines += [
            f"    const double *{v.name} = {argument.name}{f' + {v.offset}' if v.offset else ''};" for v in arrays
        ]
        if not read and not arrays and argument.name not in used:
            lines.append(f"    (void) {argument.name};")
    lines += [f"    (void) {o.name};" for o in kernel.outputs if not o.size]
    return lines


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
