"""The function of a block of states as C: straight lines in a loop over the states, the innermost one.

Every loop over the modes has such a loop inside. Each state has the operations of the scalar kernel in their order, so
its bits are equal.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from derive.backends.c.batch_loops import BlockLoops, Lines, Names, loop, row
from derive.backends.c.batch_parts import StraightLines, batch_parts, block_arrays
from derive.backends.c.signatures import parameters, signature
from derive.backends.wrapping import WIDTH, join, statement
from derive.ir.analysis import expressions
from derive.ir.model import Kernel
from derive.ir.statements import Accumulate, Let, Map, MatVec, Require, Requirement, Store, TriangularSolve

SHARED = ("k", "u")
"""Arguments that all states of a batch share."""


class StateBlock:
    """The function of a kernel for a block of at most `width` states."""

    def __init__(self, kernel: Kernel, model: str, width: int) -> None:
        self.kernel, self.model, self.width = kernel, model, width
        used = kernel.used
        states = [a for a in kernel.arguments if not a.scalar and a.name not in SHARED]
        self.views = [(a.name, view) for a in states for view in a.arrays if view.name in used]
        read = {a.name for a in states if used & {*a.elements}} | {name for name, _ in self.views}
        self.unused = [a.name for a in kernel.arguments if a.name not in SHARED and a.name not in read]
        (self.k,) = (a for a in kernel.arguments if a.name == "k")
        self.inputs = [(k, n) for a in kernel.arguments if a.name == "u" for k, n in a.named_elements]
        self.has_inputs = any(a.name == "u" for a in kernel.arguments)
        elements = {name: (a.name, index) for a in states for index, name in a.named_elements}
        self.parts = batch_parts(kernel, frozenset(elements))
        names = Names(elements, frozenset(v.name for v in self.k.arrays), block_arrays(self.parts, frozenset(elements)))
        contracts = [part for part in self.parts if isinstance(part, MatVec)]
        vectors = frozenset(p.vector for c in contracts for term in c.terms for p in term.sums)
        self.loops = BlockLoops(names, f"{model}_block{width}", vectors)
        self.checked = any(isinstance(s, Require) for s in kernel.statements)
        self.failed = False
        self.inner = self._inner()

    @property
    def is_straight(self) -> bool:
        """Whether the kernel has no loop over the modes."""
        return not self.views and all(isinstance(part, StraightLines) for part in self.parts)

    @property
    def rows(self) -> int:
        """The number of values of one state that lie on the stack."""
        return sum(self.loops.arrays.values()) + len(self.loops.names.wide) + self.checked

    def text(self) -> Lines:
        """All lines of the function."""
        name = f"TISSERAND_INLINE {'int' if self.checked else 'void'} {self.model}_{self.kernel.name}_states"
        states = ["int count", "ptrdiff_t all"]
        head = signature(name, [*states, *parameters(self.kernel, "double *TISSERAND_RESTRICT ")])
        return [*head, "{", *self._declarations(), "", *(f"    {line}" for line in self.inner), *self._failures(), "}"]

    def _declarations(self) -> Lines:
        empty = [o.name for o in self.kernel.outputs if not o.size]
        lines = [f"    (void) {name};" for name in (*self.unused, *empty, *([] if self._has_rows() else ["all"]))]
        used = self.kernel.used
        lines += [f"    const double {name} = k[{index}];" for index, name in self.k.named_elements if name in used]
        read = [(index, name) for index, name in self.inputs if name in used]
        lines += [f"    const double {name} = u[{index}];" for index, name in read]
        lines += ["    (void) u;"] if self.has_inputs and not read else []
        views = [v for v in self.k.arrays if v.name in used]
        lines += [f"    const double *{v.name} = k{f' + {v.offset}' if v.offset else ''};" for v in views]
        if not views and not any(name in used for name in self.k.elements):
            lines.append("    (void) k;")
        scalars = sorted(self.loops.names.wide, key=lambda name: (len(name), name))
        lines += declarations("double", [f"{name}[{self.width}]" for name in scalars])
        lines += declarations("double", [f"{name}[{n}][{self.width}]" for name, n in self.loops.arrays.items()])
        return [
            *lines,
            *([f"    double codes[{self.width}];", "    unsigned long long failures = 0;"] if self.checked else []),
        ]

    def _has_rows(self) -> bool:
        """Whether a later element than the first is accessed, so that the distance of rows matters."""
        used, elements = self.kernel.used, self.loops.names.elements
        read = any(name in used for name, (_, index) in elements.items() if index)
        return read or self.checked or bool(self.views) or any(o.size > 1 for o in self.kernel.outputs)

    def _inner(self) -> Lines:
        lines = [line for argument, view in self.views for line in self.loops.view(view, argument)]
        for n, part in enumerate(self.parts, 1):
            match part:
                case StraightLines():
                    lines += self._straight(part)
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

    def _straight(self, part: StraightLines) -> Lines:
        names = self.loops.names
        lines = []
        for stage in part.stages:
            if stage.lets:
                loads = names.loads(let.expr for let in stage.lets)
                lines += loop([*loads, *(line for let in stage.lets for line in self._line(let))])
            lines += [f"tisserand_sines(count, {names.values(a.name)}, {a.sine}, {a.cosine});" for a in stage.angles]
        body = names.loads(e for line in part.lines for e in expressions(line))
        checks: list[Lines] = []
        for line in part.lines:
            if isinstance(line, Require):
                checks.append(self._check(line))
            else:
                body += self._line(line)
        if checks:
            # The first check that fails gives the code, so it comes last; and what failed before keeps its own.
            body += ["    double code = 0.0;", *(text for check in reversed(checks) for text in check)]
            body.append(f"    codes[b] = {'codes[b] > 0.0 ? codes[b] : ' if self.failed else ''}code;")
            self.failed = True
        return [*lines, *loop(body)]

    def _line(self, line: Let | Store) -> Lines:
        names, value = self.loops.names, self.loops.names.text(line.expr)
        if isinstance(line, Store):
            return statement("    ", f"{line.output}[{row(str(line.index))}b] = ", value, ";")
        if line.name in names.wide:
            return statement("    ", f"{line.name}[b] = ", value, ";")
        return statement("    ", f"const double {line.name} = ", value, ";")

    def _check(self, line: Require) -> Lines:
        """The lines of a requirement; they compute both values before they choose one, so that no branch is needed."""
        value = self.loops.names.text(line.expr)
        end = f" ? code : {line.code}.0; /* {line.text} */"
        match line.kind:
            case Requirement.POSITIVE:
                return statement("    ", "code = ", join(value, " > 0.0"), end)
            case Requirement.FINITE:  # a difference of what is not finite is a NaN
                lines = statement("    ", "const double finite = ", value, ";")
                return [*lines, f"    code = finite - finite == 0.0{end}"]
            case _:
                assert_never(line.kind)

    def _failures(self) -> Lines:
        """The lines that set the outputs of failed states to NaN and return the code of the first of these states.

        All codes are taken together in a loop of their own: gcc -O3 makes no vectors of a loop with that inside.
        """
        if not self.checked:
            return []
        nan = f"{self.model}_block_nan"
        return [
            *(f"    {line}" for line in loop([f"    failures |= {self.model}_block_bits(codes[b]);"])),
            "    if (!failures) return 0;",
            *(f"    {nan}(count, all, {o.size}, codes, {o.name});" for o in self.kernel.outputs),
            f"    return {self.model}_block_code(codes);",
        ]


def declarations(kind: str, arrays: Iterable[str]) -> Lines:
    """Declarations of arrays, on as few lines as possible."""
    lines: Lines = []
    for name in arrays:
        if lines and len(lines[-1]) + len(name) + 3 <= WIDTH:
            lines[-1] = f"{lines[-1][:-1]}, {name};"
        else:
            lines.append(f"    {kind} {name};")
    return lines
