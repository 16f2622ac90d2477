"""Kernels of many states at once in C: vector units take several states in one operation.

Arrays of a batch are structures of arrays: element e of state b lies at e * n + b. A function takes blocks of states.
In a block, straight lines run in a loop over its states, the innermost one, and every loop over the modes has such a
loop inside. Each state has the operations of the scalar kernel in their order, so its bits are equal.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import assert_never

from derive.backends.c.batch_loops import BlockLoops, Lines, Names, rows_helper, scatter
from derive.backends.c.batch_parts import StraightLines, batch_parts, block_arrays
from derive.backends.wrapping import WIDTH, join, statement
from derive.ir.analysis import expressions
from derive.ir.model import Kernel, Model
from derive.ir.statements import Accumulate, Let, Map, MatVec, Require, Requirement, Store, TriangularSolve
from derive.rendering import render

KERNELS = ("mass", "force", "accel")
SHARED = ("k", "u")
"""Arguments that all states of a batch share."""
WIDTHS = {32: 256, 16: 256, 8: 512, 4: None}
"""States of a block, the best first, and the kilobytes of stack that it may take.

More than sixteen need no `TISSERAND_LANES`; fewer than eight read the tables too often.
"""


def batch_widths(model: Model) -> dict[str, int]:
    """States of a block, by the name of the kernel."""

    def fits(name: str, width: int, most: int | None) -> bool:
        return most is None or stack(model, name, width) <= 1024 * most

    return {name: next(w for w, most in WIDTHS.items() if fits(name, w, most)) for name in KERNELS}


def stack(model: Model, name: str, width: int) -> int:
    """Bytes that the arrays of a block take."""
    return 8 * width * _Body(model.kernel(name), model.name, width).rows


def batch_body(model: Model, kernel: Kernel, width: int) -> Lines:
    """The body of the function of a kernel."""
    return _Body(kernel, model.name, width).text()


@dataclass(frozen=True)
class Helpers:
    """The helpers of functions with blocks of one width: `pads` where kernels read states, `gathers` their arrays."""

    name: str
    width: int
    pads: bool
    gathers: bool
    products: str


def batch_helpers(model: Model, widths: Mapping[str, int]) -> str:
    """The helpers of the functions of the batches, for each width of a block."""
    blocks = []
    for width in sorted({*widths.values()}):
        name = f"{model.name}_block{width}"
        kernels = [model.kernel(kernel) for kernel, w in widths.items() if w == width]
        bodies = [_Body(kernel, model.name, width) for kernel in kernels]
        multiplies = any(isinstance(s, MatVec) for k in kernels for s in k.statements)
        products = "".join(f"{line}\n" for line in rows_helper(name, width)) if multiplies else ""
        pads, gathers = any(body.states for body in bodies), any(body.views for body in bodies)
        blocks.append(Helpers(name, width, pads, gathers, products))
    checked = any(isinstance(s, Require) for kernel in KERNELS for s in model.kernel(kernel).statements)
    return render("c/block.c.jinja", {"name": model.name, "blocks": blocks, "checked": checked})


class _Body:
    """The text of one function."""

    def __init__(self, kernel: Kernel, model: str, width: int) -> None:
        self.kernel, self.model, self.width = kernel, model, width
        self.prefix = f"{model}_block{width}"
        (self.output,) = kernel.outputs
        used = kernel.used
        states = [a for a in kernel.arguments if not a.scalar and a.name not in SHARED]
        self.states = [a for a in states if used & {*a.elements}]
        self.views = [(a.name, view) for a in states for view in a.arrays if view.name in used]
        read = {a.name for a in self.states} | {name for name, _ in self.views}
        self.unused = [a.name for a in kernel.arguments if a.name not in SHARED and a.name not in read]
        self.moved = [a.name for a in states if a.name in read]
        (self.k,) = (a for a in kernel.arguments if a.name == "k")
        self.inputs = [(k, n) for a in kernel.arguments if a.name == "u" for k, n in a.named_elements]
        self.has_inputs = any(a.name == "u" for a in kernel.arguments)
        self.parts = batch_parts(kernel)
        elements = {name: (a.name, index) for a in states for index, name in a.named_elements}
        names = Names(width, elements, frozenset(v.name for v in self.k.arrays), block_arrays(self.parts))
        contracts = [part for part in self.parts if isinstance(part, MatVec)]
        vectors = frozenset(p.vector for c in contracts for term in c.terms for p in term.sums)
        self.loops = BlockLoops(names, self.prefix, vectors)
        self.stored = sorted(s.index for s in kernel.statements if isinstance(s, Store))
        self.checked = any(isinstance(s, Require) for s in kernel.statements)
        self.failed = False
        self.inner = self._inner()
        self.tails = {f"{a.name}_tail": len(a.elements) for a in self.states}
        self.rows_of = {**self.loops.arrays, **({f"{self.output.name}_block": len(self.stored)} if self.stored else {})}
        self.lines = [*sorted(names.wide, key=_natural), *(["codes"] if self.checked else [])]

    @property
    def rows(self) -> int:
        """Numbers of one state that lie on the stack."""
        return sum(self.tails.values()) + sum(self.rows_of.values()) + len(self.lines)

    def text(self) -> Lines:
        """All lines of the body."""
        lines = [f"    (void) {name};" for name in self.unused]
        used = self.kernel.used
        lines += [f"    const double {name} = k[{index}];" for index, name in self.k.named_elements if name in used]
        read = [(index, name) for index, name in self.inputs if name in used]
        lines += [f"    const double {name} = u[{index}];" for index, name in read]
        lines += ["    (void) u;"] if self.has_inputs and not read else []
        views = [v for v in self.k.arrays if v.name in used]
        lines += [f"    const double *{v.name} = k{f' + {v.offset}' if v.offset else ''};" for v in views]
        if not views and not any(name in used for name in self.k.elements):
            lines.append("    (void) k;")
        width = self.width
        lines += _declared([f"{name}[{rows * width}]" for name, rows in self.tails.items()])
        lines += _declared([f"{name}[{width}]" for name in self.lines])
        lines += _declared([f"{name}[{rows}][{width}]" for name, rows in self.rows_of.items()])
        lines += ["    const ptrdiff_t all = n;", *(["    int code = 0;"] if self.checked else [])]
        return [
            *lines,
            "",
            f"    for (int left = n; left > 0; left -= {width}) {{",
            f"        const int count = left < {width} ? left : {width};",
            *(f"        {line}" if line else "" for line in (*self._blocks(), *self.inner, *self._outputs())),
            *(f"        {name} += count;" for name in (*self.moved, self.output.name)),
            "    }",
            *(["    return code;"] if self.checked else ["    return 0;"]),
        ]

    def _blocks(self) -> Lines:
        """Where the states of a block are: among all, or, of the last block, in a copy."""
        if not self.states:
            return []
        width = self.width
        strides = any(self.loops.names.indices)  # the first element of a state needs none
        return [
            *([f"const ptrdiff_t stride = count < {width} ? {width} : all;"] if strides else []),
            *(
                f"const double *{a.name}_block = count < {width} ? "
                f"{self.prefix}_pad(all, count, {len(a.elements)}, {a.name}, {a.name}_tail) : {a.name};"
                for a in self.states
            ),
        ]

    def _inner(self) -> Lines:
        lines = [line for argument, view in self.views for line in self.loops.view(view, argument)]
        for n, part in enumerate(self.parts, 1):
            match part:
                case StraightLines():
                    lines += self._run(part)
                case Map():
                    lines += self.loops.map(part)
                case Accumulate():
                    lines += self.loops.accumulate(part, f"sums{n}")
                case MatVec():
                    lines += self.loops.matvec(part)
                case TriangularSolve():
                    lines += self.loops.triangular_solve(part)
                case _:
                    assert_never(part)
        return lines

    def _run(self, run: StraightLines) -> Lines:
        names = self.loops.names
        lines = []
        if run.early:
            loads = names.loads(let.expr for let in run.early)
            lines = names.loop([*loads, *(line for let in run.early for line in self._line(let))])
        body = names.loads(e for line in run.lines for e in expressions(line))
        checks: list[Lines] = []
        for line in run.lines:
            if isinstance(line, Require):
                checks.append(self._check(line))
            else:
                body += self._line(line)
        if checks:
            # The first check that fails gives the code, so it comes last; and what failed before keeps its own.
            body += ["    double code_b = 0.0;", *(text for check in reversed(checks) for text in check)]
            body.append(f"    codes[b] = {'codes[b] > 0.0 ? codes[b] : ' if self.failed else ''}code_b;")
            self.failed = True
        return [*lines, *names.loop(body)]

    def _line(self, line: Let | Store) -> Lines:
        names, value = self.loops.names, self.loops.names.text(line.expr)
        if isinstance(line, Store):
            row = self.stored.index(line.index)
            return statement("    ", f"{line.output}_block[{row}][b] = ", value, ";")
        if line.name in names.wide:
            return statement("    ", f"{line.name}[b] = ", value, ";")
        return statement("    ", f"const double {line.name} = ", value, ";")

    def _check(self, line: Require) -> Lines:
        """Both values are computed before one is chosen, so that compilers need no branch."""
        value = self.loops.names.text(line.expr)
        end = f" ? code_b : {line.code}.0; /* {line.text} */"
        match line.kind:
            case Requirement.POSITIVE:
                return statement("    ", "code_b = ", join(value, " > 0.0"), end)
            case Requirement.FINITE:  # a difference of what is not finite is a NaN
                lines = statement("    ", "const double finite = ", value, ";")
                return [*lines, f"    code_b = finite - finite == 0.0{end}"]
            case _:
                assert_never(line.kind)

    def _outputs(self) -> Lines:
        name, lines = self.output.name, []
        for _, run in groupby(enumerate(self.stored), lambda pair: pair[1] - pair[0]):
            pairs = list(run)
            row, first = pairs[0]
            to = f"{name} + {first} * all" if first else name
            lines.append(scatter(self.prefix, len(pairs), to, f"{name}_block", row))
        if self.checked:
            rows, refuse = self.output.size, f"{self.model}_block_fail"
            lines += [
                f"const int failed = {refuse}(all, count, {rows}, codes, {name});",
                "if (code == 0) code = failed;",
            ]
        return lines


def _natural(name: str) -> tuple[int, str]:
    return len(name), name


def _declared(arrays: list[str]) -> Lines:
    """Arrays in as many declarations as lines."""
    lines: Lines = []
    for name in arrays:
        if lines and len(lines[-1]) + len(name) + 3 <= WIDTH:
            lines[-1] = f"{lines[-1][:-1]}, {name};"
        else:
            lines.append(f"    double {name};")
    return lines
