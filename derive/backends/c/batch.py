"""Kernels of many states at once in C: vector units take several states in one operation.

Arrays of a batch are structures of arrays: element e of state b lies at e * n + b. A batch is computed in blocks of
states, for which `batch_block.py` prints a function; this module prints the function that divides a batch into blocks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from derive.backends.c.batch_block import Lines, StateBlock
from derive.backends.c.nests import declarations
from derive.backends.c.signatures import names, parameters, signature
from derive.ir.batches import state_arguments
from derive.ir.indices import LANES
from derive.ir.model import Kernel, Model
from derive.rendering import render

KERNELS = ("mass", "force", "mass_force", "accel", "energy", "momentum", "rates")
"""The kernels that have a function for batches."""

STRAIGHT = 8
"""States of a block of a kernel without loops over the modes: one vector, or a few."""
WIDTHS = {32: 256, 16: 256, 8: 512, 4: None}
"""States of a block of a kernel with such loops, the best first, and the kilobytes of stack that it may take.

Blocks of fewer than eight states read the tables too often.
"""
SHORT = 60
"""Statements of a kernel that is compiled again for the states that fill no block, and for the batches of KNOWN.

For other kernels the function of single states computes the states that fill no block, from a copy of each.
"""
KNOWN = (STRAIGHT, 2)
"""Batches whose number of states, and with it the distance of rows, compilers know: two states take a third less."""
COPIES = {32: 128, 1: None}
"""States that are copied at once, the best first, and the kilobytes of stack that they may take; see `_spacing`."""
SPACINGS = (64, 128, 256, 512)
"""Numbers of states which may be unfavourable, with their multiples, as `_spacing` explains."""


def batch_blocks(model: Model) -> dict[str, StateBlock]:
    """The function of a block of states of each kernel that has batches, by the name of the kernel."""
    return {name: _block(model, model.kernel(name)) for name in KERNELS}


def _block(model: Model, kernel: Kernel) -> StateBlock:
    straight = StateBlock(kernel, model.name, STRAIGHT)
    if straight.is_straight:
        return straight
    blocks = ((StateBlock(kernel, model.name, width), most) for width, most in WIDTHS.items())
    return next(block for block, most in blocks if _fits(stack(block), most))


def _fits(size: int, kilobytes: int | None) -> bool:
    return kilobytes is None or size <= 1024 * kilobytes


def stack(block: StateBlock) -> int:
    """The bytes of stack that the arrays of a block or the copies of states take."""
    copies = 8 * _copies(block.kernel) * sum(_copied(block.kernel).values())
    return max(8 * block.width * block.rows, copies)


@dataclass(frozen=True)
class BatchFunction:
    """A function of a batch as text, with the static functions that it calls."""

    helpers: str
    signature: str
    body: str


def batch_function(block: StateBlock) -> BatchFunction:
    """The function for the batches of a kernel, in blocks of states."""
    model, kernel, name = block.model, block.kernel, _name(block.model, block.kernel)
    arguments = ["int n", *parameters(kernel)]
    lines = [*block.text(), ""]
    counts = [*([_copies(kernel)] if _spacing(block) else []), *([] if _is_short(block) else [1])]
    for count in counts:
        lines += [*_copying(model, kernel, count), ""]
    lines += [*signature(f"TISSERAND_APART int {name}_blocks", arguments), "{", *_blocks(block), "}"]
    head, body = signature(f"int {name}_batch", arguments), _body(model, kernel, block.checked)
    return BatchFunction("\n".join(lines), "\n".join(head), "\n".join(body))


def _name(model: str, kernel: Kernel) -> str:
    """The name of the function of single states, with which the names of the other functions begin."""
    return f"{model}_{kernel.name}"


def _is_short(block: StateBlock) -> bool:
    return block.is_straight and len(block.kernel.statements) <= SHORT


def _copied(kernel: Kernel) -> dict[str, int]:
    """The sizes of the arrays that have a value for each state."""
    return {a.name: a.size for a in state_arguments(kernel)} | {o.name: o.size for o in kernel.outputs}


def _copies(kernel: Kernel) -> int:
    """The number of states that are copied at once."""
    size = 8 * sum(_copied(kernel).values())
    return next(count for count, most in COPIES.items() if _fits(count * size, most))


def _spacing(block: StateBlock) -> int:
    """The number of states whose multiples have rows that displace each other from the cache; 0 if there is none.

    Lines of 64 bytes that lie a multiple of 4 kB apart go to one of 64 sets of a first-level cache, each with 8 places.
    Rows of n states, where 8 n is a multiple of a large power of two, go to few of the sets. The result is the least
    power for which the sets have fewer places than the arrays have rows.
    """
    rows = sum(_copied(block.kernel).values())
    fitting = [n for n in SPACINGS if n // 8 * rows > 64 * 8]
    return min(fitting, default=0) if block.is_straight and _copies(block.kernel) > 1 else 0


def _body(model: str, kernel: Kernel, checked: bool) -> Lines:
    """The body of the function of a batch, which passes a single state on to the function of single states.

    Both have the same layout of arrays for one state.
    """
    name, passed = _name(model, kernel), ", ".join(names(kernel))
    if not checked:
        return [f"    return n == 1 ? {name}({passed}) : {name}_blocks(n, {passed});"]
    fill = [f"for (int e = 0; code && e < {o.size}; e++) {o.name}[e] = (double) NAN;" for o in kernel.outputs]
    single = [
        "    if (n == 1) {",
        f"        const int code = {name}({passed});",
        *fill,
        "        return code;",
        "    }",
    ]
    return [*single, f"    return {name}_blocks(n, {passed});"]


def _blocks(block: StateBlock) -> Lines:
    kernel = block.kernel
    name, passed = _name(block.model, kernel), ", ".join(names(kernel))
    checked, short = block.checked, _is_short(block)

    def states(count: str, stride: str) -> str:
        return f"{name}_states({count}, {stride}, {passed});"

    def part(head: str, call: str, *then: str) -> Lines:
        first = [f"const int failed = {call}", "if (code == 0) code = failed;"] if checked else [call]
        return [f"    {head} {{", *(f"        {line}" for line in (*first, *then)), "    }"]

    def moves(step: int) -> str:
        return " ".join(f"{array} += {step};" for array in _copied(kernel))

    lines = ["    const ptrdiff_t all = n;", f"    int left = n{', code = 0' if checked else ''};", ""]
    if short:
        result = "code" if checked else "0"
        for count in KNOWN:
            lines += part(f"if (n == {count})", states(str(count), str(count)), f"return {result};")
    copies, spacing, width = _copies(kernel), _spacing(block), block.width
    if spacing:
        head = f"for (; n % {spacing} == 0 && left > 0; left -= {copies})"
        lines += part(head, f"{name}_copied{copies}(all, {passed});", moves(copies))
    lines += part(f"for (; left >= {width}; left -= {width})", states(str(width), "all"), moves(width))
    if short:
        lines += part("if (left > 0)", states("left", "all"))
    else:
        lines += part("for (; left > 0; left--)", f"{name}_copied1(all, {passed});", moves(1))
    return [*lines, f"    return {'code' if checked else '0'};"]


def _copying(model: str, kernel: Kernel, count: int) -> Lines:
    """The function that computes `count` states in arrays of their own."""
    name = _name(model, kernel)
    head = signature(f"TISSERAND_APART int {name}_copied{count}", ["ptrdiff_t all", *parameters(kernel)])
    copies = {array: f"{array}_b" for array in _copied(kernel)}
    passed = ", ".join(copies.get(argument, argument) for argument in names(kernel))
    over_states = f" for (int b = 0; b < {count}; b++)" if count > 1 else ""
    own, among = (f"{count} * e + b", "e * all + b") if count > 1 else ("e", "e * all")
    lines = declarations([f"{copies[array]}[{count * size}]" for array, size in _copied(kernel).items()])
    lines += ["    int code;"]
    for a in state_arguments(kernel):
        loops = f"for (int e = 0; e < {a.size}; e++){over_states}"
        lines.append(f"    {loops} {copies[a.name]}[{own}] = {a.name}[{among}];")
    lines.append(f"    code = {name}_batch({count}, {passed});")
    for o in kernel.outputs:
        loops = f"for (int e = 0; e < {o.size}; e++){over_states}"
        lines.append(f"    {loops} {o.name}[{among}] = {copies[o.name]}[{own}];")
    return ["/* States in arrays of their own. */", *head, "{", *lines, "    return code;", "}"]


def batch_helpers(model: Model, blocks: Mapping[str, StateBlock]) -> str:
    """The static functions that the functions of the batches call: products with tables for each width, and codes."""
    widths = sorted({block.width for block in blocks.values() if block.multiplies})
    checked = any(block.checked for block in blocks.values())
    values = {"name": model.name, "widths": widths, "checked": checked, "lanes": range(LANES)}
    return render("c/block.c.jinja", values)
