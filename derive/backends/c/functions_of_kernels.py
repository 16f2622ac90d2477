"""The text of the C functions of kernels: in one function, in parts, or one that forms of equations have in common."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from derive.backends.c.beginnings import shared_signature, without_last
from derive.backends.c.forms import form_call, form_signature
from derive.backends.c.function_parts import DividedFunction, NumberedNodes, divided_function
from derive.backends.c.linear_sums import KernelSums
from derive.backends.c.loop_text import filled_by_few, vector_starts
from derive.backends.c.nests import CNests
from derive.backends.c.shared_sections import SharedSections
from derive.backends.c.signatures import parameters, signature
from derive.backends.description import section_text
from derive.backends.source_map import SourceLine, plain
from derive.backends.wrapping import comment, prefixed
from derive.ir.analysis import expressions, names_read
from derive.ir.expansion import expand
from derive.ir.expressions import Expr, Operation, Operator, walk
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.lanes import section_in_lanes
from derive.ir.loop_nests import Node
from derive.ir.model import Model
from derive.ir.sines_of_bodies import with_sines_of_bodies
from derive.ir.statements import Let, Statement
from derive.ir.tiles import (
    NO_TABLES,
    in_tiles,
    kept_in_tiles,
    numbers_of_instances,
    tiles_read,
    with_kept_in_tiles,
)
from derive.ir.variants import Variants


def shared_function(model: Model, kernel: Kernel, whole: Kernel, shared: SharedSections) -> list[SourceLine]:
    """The static function of a kernel that begins with another one, after which it ends if the caller wants no more."""
    return function(whole, shared_signature(model, whole), shared, {len(kernel.sections): without_last(whole)})


def function(
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
    tables = numbers_of_instances(kernel.constants)
    sections = [_in_lanes(body, tables) for body in _numbered_statements(kernel, sums)]
    nodes = [node for section in sections for _, part in section for node in part]
    passed = {
        array for section in kernel.sections if section.body in shared for array, _ in shared[section.body].arrays
    }
    kept = kept_in_tiles(nodes, passed)
    sections = [
        [(n, tuple(with_kept_in_tiles(node, kept) for node in part)) for n, part in section] for section in sections
    ]
    nodes = [node for section in sections for _, part in section for node in part]
    whole = filled_by_few(nodes) - passed
    starts = vector_starts(nodes, whole)
    counter = "ptrdiff_t" if kernel.repeats else "int"
    filled = tiles_read(tables) | whole
    nests = CNests({o.name for o in kernel.outputs}, starts=starts, counter=counter, filled=filled)
    loads = _element_loads(kernel)
    for k, (section, body) in enumerate(zip(kernel.sections, sections, strict=True)):
        lines += plain(*(before or {}).get(k, ()))
        if not body:
            continue
        lines += plain(*([""] if k or named or sums else []), *comment([section_text(section)], "    "))
        call = shared.get(section.body)
        lines += [line.of(k, 0) for line in call.call()] if call else _section(body, k, nests, loads)
    return [*lines, *plain("    return 0;", "}")]


def function_of_forms(model: Model, of: Variants) -> list[SourceLine]:
    """The static function that the functions of some forms call, behind its tables."""
    kernel = of.kernels[0]
    used = frozenset(name for k in of.kernels for name in k.used)
    named = [*_arguments(kernel, used), *([] if of.differ else [f"    (void) {of.selector};"])]
    lines = plain(*form_signature(model, of), "{", *named, "")
    nests = CNests({o.name for o in kernel.outputs}, counter="ptrdiff_t")
    body = with_sines_of_bodies([(node,) for node in of.nodes])
    lines += _section(((0, nodes) for nodes in body), 0, nests, _element_loads(kernel))
    tables = (line for table in of.tables for line in constant_array(table))
    return [*plain(*tables), *lines, *plain("    return 0;", "}", "")]


def function_of_form(model: Model, kernel: Kernel, of: Variants) -> list[SourceLine]:
    """The function of a form: what comes before the loops, and a call."""
    (section,) = kernel.sections
    lines = plain(*signature_of(model, kernel), "{", *comment([section_text(section)], "    "))
    before = _in_lanes([*enumerate(of.before[of.kernels.index(kernel)])])
    nests = CNests({o.name for o in kernel.outputs}, counter="ptrdiff_t")
    return [*lines, *_section(before, 0, nests, _element_loads(kernel)), *form_call(model, kernel, of)]


def divided(model: Model, kernel: Kernel, sums: KernelSums | None) -> DividedFunction | None:
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


def function_in_parts(function: DividedFunction, head: Sequence[str], sums: KernelSums | None) -> list[SourceLine]:
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


def _in_lanes(
    body: Sequence[tuple[int, Statement]], tables: Mapping[str, ConstantArray] = NO_TABLES
) -> list[tuple[int, tuple[Node, ...]]]:
    """The statements of a section as plain statements, with their numbers."""
    numbers = [number for number, _ in body]
    made = section_in_lanes([statement for _, statement in body])
    return [(numbers[n], tuple(in_tiles(node, tables) for node in nodes)) for n, nodes in made]


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


def signature_of(model: Model, kernel: Kernel) -> list[str]:
    """The lines of the signature of the function of a kernel."""
    return signature(f"int {model.name}_{kernel.name}", parameters(kernel))


def has_sine(item: Statement) -> bool:
    """Whether a statement contains a sine or a cosine."""
    return any(_is_sine(part) for e in expressions(item) for part in walk(e))


def _is_sine(part: Expr) -> bool:
    return isinstance(part, Operation) and part.kind in (Operator.SIN, Operator.COS)


def constant_array(array: ConstantArray, in_tiles: bool = False) -> list[str]:
    """The definition of a constant array."""
    placed = " TISSERAND_IN_TILES" if in_tiles else ""
    kind = "int" if array.integers else "double"
    values = (str(value) if array.integers else repr(float(value)) for value in array.values)
    return [f"static const {kind} {array.name}[]{placed} = {{", *prefixed([", ".join(values)], "    "), "};", ""]
