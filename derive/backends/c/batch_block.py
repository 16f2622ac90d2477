"""The function of a block of states as C, whose innermost loops run over the states."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from copy import copy
from functools import cached_property
from itertools import groupby

from derive.backends.c.block_parts import BlockPart, block_parts
from derive.backends.c.linear_sums import KernelSums
from derive.backends.c.loop_text import declarations
from derive.backends.c.nests import CNests
from derive.backends.c.signatures import parameters, signature
from derive.backends.wrapping import prefixed
from derive.ir.analysis import codes_in_order
from derive.ir.batches import SHARED, batch, state_arguments, state_elements, state_views
from derive.ir.kernel import Kernel
from derive.ir.loop_nests import BlockProduct, For, LoopKind, Sines, every

Lines = list[str]

TOGETHER = "TISSERAND_TOGETHER"
"""The macro before functions that run one after the other for a block of states."""


class StateBlock:
    """The function of a kernel for a block of at most `width` states.

    sums: what the kernel becomes if it has sums of a table.
    """

    def __init__(self, kernel: Kernel, model: str, width: int, sums: KernelSums | None = None) -> None:
        self.kernel, self.model, self.width, self.sums = kernel, model, width, sums
        self.batch = batch(sums.kernel, sums.nodes(row_by_row=True)) if sums else batch(kernel)
        self.checked = kernel.checked
        self.repeats = kernel.repeats
        self.multiplies = any(isinstance(node, BlockProduct) for node in every(self.batch.nodes))
        self.calls_sines = self.repeats and any(isinstance(node, Sines) for node in every(self.batch.nodes))

    def of_width(self, width: int) -> StateBlock:
        """The function for a block of another number of states."""
        other = copy(self)
        other.width = width
        other.__dict__.pop("_lines", None)
        return other

    @property
    def is_straight(self) -> bool:
        """Whether the kernel has no loop over the modes, besides sums at its beginning."""
        return bool(self.sums) or all(
            node.kind is LoopKind.STATES for node in self.batch.nodes if isinstance(node, For)
        )

    @property
    def rows(self) -> int:
        """The number of values of one state that lie on the stack."""
        return sum(self.batch.arrays.values()) + len(self.batch.scalars) + self.checked

    def body(self) -> Lines:
        """The statements of the function. What all states share is named behind sines, which may call a function."""
        parts = [self._call(number) or lines for number, lines in enumerate(self._lines)]
        first = sum(part.sines for part in self.parts[:1])
        return [line for lines in (*parts[:first], self._shared(self._used_here), *parts[first:]) for line in lines]

    def functions(self) -> list[Lines]:
        """The type of the local arrays of a block in parts, and the static functions of its long parts."""
        if not self.is_divided:
            return []
        members = declarations(f"{name}{_brackets(shape)}" for name, shape in self._shapes.items())
        return [["typedef struct {", *members, f"}} {self._work};", ""]] + [
            [
                *signature(
                    f"{TOGETHER} TISSERAND_SHARED void {self._name(number)}", [p for p, _ in self._parameters(part)]
                ),
                "{",
                f"    const int count = {self.width};",
                *self._shared(part.names),
                *self._named({*part.names, *(["codes"] if part.checked else [])}, "work->"),
                *self._lines[number],
                "}",
                "",
            ]
            for number, part in enumerate(self.parts)
            if part.apart
        ]

    @cached_property
    def parts(self) -> list[BlockPart]:
        """Its statements, in parts of which the long ones have functions."""
        return block_parts(self.batch.nodes, self.repeats)

    @cached_property
    def _lines(self) -> list[Lines]:
        """The lines of each part."""
        outputs = {o.name for o in self.kernel.outputs}
        arrays = outputs | {a.name for a in state_arguments(self.kernel)}
        counter = "ptrdiff_t" if self.repeats else "int"
        codes = codes_in_order(self.batch.nodes) or (None,)
        helpers = f"{self.model}_block{self.width}"
        nests = CNests(outputs, arrays, helpers, self.repeats, codes[0], counter=counter)
        return [[line.text for line in nests.lines(part.nodes)] for part in self.parts]

    def _name(self, number: int) -> str:
        return f"{self.model}_{self.kernel.name}_part{sum(part.apart for part in self.parts[: number + 1])}"

    @property
    def is_divided(self) -> bool:
        """Whether there are functions of parts."""
        return any(part.apart for part in self.parts)

    @property
    def _work(self) -> str:
        """The type of the local arrays, of which a part gets one address: compilers keep none for each array."""
        return f"{self.model}_{self.kernel.name}_work"

    @property
    def _shapes(self) -> dict[str, tuple[int, ...]]:
        """The shapes of the local arrays by their names."""
        scalars = sorted(self.batch.scalars, key=lambda name: (len(name), name))
        shapes: dict[str, tuple[int, ...]] = dict.fromkeys(scalars, (self.width,))
        shapes |= {name: (rows, self.width) for name, rows in self.batch.arrays.items()}
        return shapes | ({"codes": (self.width,)} if self.checked else {})

    def _named(self, used: Collection[str], work: str) -> Lines:
        """The lines that name members of the local arrays."""
        shapes = {name: shape for name, shape in self._shapes.items() if name in used}
        pointers = {name: f"(*const {name})" if shape[1:] else f"*const {name}" for name, shape in shapes.items()}
        return [f"    double {pointers[name]}{_brackets(shape[1:])} = {work}{name};" for name, shape in shapes.items()]

    def _call(self, number: int) -> Lines:
        """The call of a part, if it has a function."""
        if not self.parts[number].apart:
            return []
        passed = ", ".join(name for _, name in self._parameters(self.parts[number]))
        first, *others = prefixed([f"{self._name(number)}({passed});"], " " * 8)
        return [first.removeprefix("    "), *others]

    def _parameters(self, part: BlockPart) -> list[tuple[str, str]]:
        """The parameters of the function of a part, and what is passed for them."""
        used, kernel = part.names, self.kernel
        of_states = {a.name for a in state_arguments(kernel)}
        outputs = {o.name for o in kernel.outputs}
        result = [("ptrdiff_t all", "all")] if used & (of_states | outputs) else []
        for argument, kind in zip(kernel.arguments, parameters(kernel), strict=False):
            if used & {argument.name, *argument.names}:
                result.append((kind, argument.name))
        result += [(f"double *TISSERAND_RESTRICT {name}", name) for name in sorted(outputs & used)]
        return [*result, (f"{self._work} *TISSERAND_RESTRICT work", "&work")]

    def declarations(self) -> Lines:
        """The lines before the statements, which declare their arrays."""
        kernel, used = self.kernel, self.kernel.used
        read = {a.name for a in state_arguments(kernel) if used & {*a.elements}}
        read |= {argument for argument, _ in state_views(kernel)}
        unused = [a.name for a in kernel.arguments if a.name not in SHARED and a.name not in read]
        unused += [o.name for o in kernel.outputs if not o.size]
        lines = [f"    (void) {name};" for name in (*unused, *([] if self._has_rows() else ["all"]))]
        shared = [a for name in SHARED for a in kernel.arguments if a.name == name]
        lines += [f"    (void) {a.name};" for a in reversed(shared) if used.isdisjoint(a.names)]
        lines += ["    (void) count;"] if self.is_divided else []
        codes = ["    unsigned long long failures = 0;"] if self.checked else []
        if not self.is_divided:
            zeros = {"codes": " = {0.0}"} if self.repeats else {}
            groups = groupby(self._shapes.items(), lambda item: (len(item[1]), item[0] == "codes"))
            arrays = ([f"{name}{_brackets(shape)}{zeros.get(name, '')}" for name, shape in of] for _, of in groups)
            return [*lines, *(line for group in arrays for line in declarations(group)), *codes]
        lines += [f"    {self._work} work;", *self._named({*self._used_here, "codes"}, "work.")]
        zero = f"    for (int b = 0; b < {self.width}; b++) codes[b] = 0.0;"
        return [*lines, *codes, *([zero] if self.checked else [])]

    @property
    def _used_here(self) -> frozenset[str]:
        """The names that statements outside of functions of parts read."""
        if not self.is_divided:
            return self.kernel.used
        return frozenset(name for part in self.parts if not part.apart for name in part.names)

    def _shared(self, used: Collection[str]) -> Lines:
        """The lines that name the elements and the parts of the arguments that all states share."""
        lines = []
        for a in (a for name in SHARED for a in self.kernel.arguments if a.name == name):
            elements = ((index, name) for index, name in a.named_elements if name in used)
            views = (view for view in a.parts if view.name in used)
            lines += [f"    const double {name} = {a.name}[{index}];" for index, name in elements]
            lines += [f"    const double *{v.name} = {a.name}{f' + {v.offset}' if v.offset else ''};" for v in views]
        return lines

    def _has_rows(self) -> bool:
        """Whether a later element than the first is accessed, so that the distance of rows matters."""
        elements = state_elements(self.kernel).items()
        later = any(element.index and element.index.offset for name, element in elements if name in self.kernel.used)
        several = any(o.size > 1 for o in self.kernel.outputs)
        return later or several or self.checked or bool(state_views(self.kernel))


def _brackets(shape: Iterable[int]) -> str:
    return "".join(f"[{size}]" for size in shape)
