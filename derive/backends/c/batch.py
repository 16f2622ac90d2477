"""Kernels of many states at once in C: vector units take several states in one operation.

Arrays of a batch are structures of arrays: element e of state b lies at e * n + b. A batch is computed in blocks of
states, for which `batch_block.py` prints a function; this module prints the function that divides a batch into blocks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from derive.backends.c.batch_block import TOGETHER, StateBlock
from derive.backends.c.linear_sums import NO_SUMS, KernelSums, LinearSums
from derive.backends.c.loop_text import declarations
from derive.backends.c.signatures import names, parameters, signature
from derive.function_names import OF_MODELS
from derive.ir.batches import state_arguments
from derive.ir.indices import LANES
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.statements import ReturnCode
from derive.rendering import render

KERNELS = ("mass", "force", "mass_force", "accel", "energy", "momentum", "rates")
"""The kernels that have a function for batches; functions of models on request, `OF_MODELS`, have one as well."""

STRAIGHT = 8
"""States of a block of a kernel without loops over the modes: one vector, or a few."""
WIDTHS = {32: 256, 16: 256, 8: 512, 4: None}
"""States of a block of a kernel with such loops, the best first, and the kilobytes of stack that it may take.

Blocks of fewer than eight states read the tables too often.
"""
REPEATED = {8: 32, 4: None}
"""States of a block of a kernel with loops over bodies, and the kilobytes of its arrays.

Eight states hide more waiting of a processor than four, as long as what they keep stays in a first-level cache.
"""
SHORT = 60
"""Statements of a kernel that is compiled again for the states that fill no block, and for the batches of KNOWN.

For other kernels the function of single states computes the states that fill no block, from a copy of each.
"""
KNOWN = (STRAIGHT, 2, 1)
"""Batches whose number of states, and with it the distance of rows, compilers know: two states take a third less.

Each has a function, which keeps no registers for what other batches need.
"""
COPIES = {32: 128, 1: None}
"""States that are copied at once, the best first, and the kilobytes of stack that they may take; see `_spacing`."""
SPACINGS = (64, 128, 256, 512)
"""Numbers of states which may be unfavourable, with their multiples, as `_spacing` explains."""


def batch_blocks(model: Model, sums: LinearSums = NO_SUMS) -> dict[str, StateBlock]:
    """The function of a block of states of each kernel that has batches, by the name of the kernel."""
    requested = [name for name in OF_MODELS if any(kernel.name == name for kernel in model.kernels)]
    return {name: _block(model, model.kernel(name), sums.kernels.get(name)) for name in (*KERNELS, *requested)}


def _block(model: Model, kernel: Kernel, sums: KernelSums | None) -> StateBlock:
    straight = StateBlock(kernel, model.name, STRAIGHT, sums)
    if straight.is_straight:
        return straight
    widths, size = (REPEATED, _own_stack) if straight.repeats else (WIDTHS, stack)
    blocks = ((straight.of_width(width), most) for width, most in widths.items())
    return next(block for block, most in blocks if _fits(size(block), most))


def _fits(size: int, kilobytes: int | None) -> bool:
    return kilobytes is None or size <= 1024 * kilobytes


def stack(block: StateBlock) -> int:
    """The bytes of stack that the arrays of a block or the copies of states take."""
    copies = 8 * _copies(block.kernel) * sum(_copied(block.kernel).values())
    return max(_own_stack(block), copies)


def _own_stack(block: StateBlock) -> int:
    return 8 * block.width * block.rows


@dataclass(frozen=True)
class BatchFunction:
    """The signature of a function of a batch, and its text with that of the static functions that it calls."""

    signature: str
    text: str


def batch_function(block: StateBlock) -> BatchFunction:
    """The function for the batches of a kernel, in blocks of states, with the static functions that it calls."""
    kernel, short = block.kernel, _is_short(block)
    counts = [*([_copies(kernel)] if _spacing(block) else []), *([] if short else [1])]
    values = {
        "model": block.model,
        "name": f"{block.model}_{kernel.name}",
        "parameters": parameters(kernel),
        "restricted": parameters(kernel, "double *TISSERAND_RESTRICT "),
        "passed": ", ".join(names(kernel)),
        "inputs": state_arguments(kernel),
        "outputs": kernel.outputs,
        "arrays": [*state_arguments(kernel), *kernel.outputs],
        "declarations": "\n".join(block.declarations()),
        "parts": "\n".join(line for lines in block.functions() for line in lines),
        "body": "\n".join(block.body()),
        "checked": block.checked,
        "counted": not block.repeats,
        "together": f"{TOGETHER} " if block.is_divided else "",
        "copies": [_copying(kernel, count) for count in counts],
        "spacing": _spacing(block),
        "known": KNOWN if short else (),
        "width": block.width,
    }
    head = signature(f"int {values['name']}_batch", ["int n", *parameters(kernel)])
    return BatchFunction("\n".join(head), render("c/batch.c.jinja", values).rstrip())


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


@dataclass(frozen=True)
class StateCopies:
    """Some states in arrays of their own: the declarations of these, and the arguments of a function that uses them."""

    count: int
    declarations: str
    passed: str


def _copying(kernel: Kernel, count: int) -> StateCopies:
    sizes = _copied(kernel)
    lines = declarations(f"{array}_b[{count * size}]" for array, size in sizes.items())
    passed = ", ".join(f"{name}_b" if name in sizes else name for name in names(kernel))
    return StateCopies(count, "\n".join(lines), passed)


def batch_helpers(model: Model, blocks: Mapping[str, StateBlock]) -> str:
    """The static functions that the functions of the batches call: sines and products for each width, and codes."""
    widths = sorted({block.width for block in blocks.values() if block.multiplies})
    checked = any(block.checked for block in blocks.values())
    sines = sorted({block.width for block in blocks.values() if block.calls_sines})
    values = {"name": model.name, "widths": widths, "sines": sines, "checked": checked, "lanes": range(LANES)}
    values |= {"not_finite": int(ReturnCode.NOT_FINITE)}
    return render("c/block.c.jinja", values)
