"""The function of a block of states as C, whose innermost loops run over the states."""

from __future__ import annotations

from copy import copy

from derive.backends.c.linear_sums import KernelSums
from derive.backends.c.loop_text import declarations
from derive.backends.c.nests import CNests
from derive.ir.analysis import codes_in_order
from derive.ir.batches import SHARED, batch, state_arguments, state_elements, state_views
from derive.ir.kernel import Kernel
from derive.ir.loop_nests import BlockProduct, For, LoopKind, every

Lines = list[str]


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

    def of_width(self, width: int) -> StateBlock:
        """The function for a block of another number of states."""
        other = copy(self)
        other.width = width
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
        """The statements of the function."""
        outputs = {o.name for o in self.kernel.outputs}
        arrays = outputs | {a.name for a in state_arguments(self.kernel)}
        counter = "ptrdiff_t" if self.repeats else "int"
        codes = codes_in_order(self.batch.nodes) or (None,)
        helpers = f"{self.model}_block{self.width}"
        nests = CNests(outputs, arrays, helpers, self.repeats, codes[0], counter=counter)
        return [line.text for line in nests.lines(self.batch.nodes)]

    def declarations(self) -> Lines:
        """The lines before the statements, which name what these read and declare their arrays."""
        kernel, used = self.kernel, self.kernel.used
        read = {a.name for a in state_arguments(kernel) if used & {*a.elements}}
        read |= {argument for argument, _ in state_views(kernel)}
        unused = [a.name for a in kernel.arguments if a.name not in SHARED and a.name not in read]
        unused += [o.name for o in kernel.outputs if not o.size]
        lines = [f"    (void) {name};" for name in (*unused, *([] if self._has_rows() else ["all"]))]
        shared = [a for name in SHARED for a in kernel.arguments if a.name == name]
        for a in shared:
            elements = ((index, name) for index, name in a.named_elements if name in used)
            views = (view for view in a.parts if view.name in used)
            lines += [f"    const double {name} = {a.name}[{index}];" for index, name in elements]
            lines += [f"    const double *{v.name} = {a.name}{f' + {v.offset}' if v.offset else ''};" for v in views]
        lines += [f"    (void) {a.name};" for a in reversed(shared) if used.isdisjoint(a.names)]
        scalars = sorted(self.batch.scalars, key=lambda name: (len(name), name))
        lines += declarations([f"{name}[{self.width}]" for name in scalars])
        lines += declarations([f"{name}[{n}][{self.width}]" for name, n in self.batch.arrays.items()])
        codes = [
            f"    double codes[{self.width}]{' = {0.0}' if self.repeats else ''};",
            "    unsigned long long failures = 0;",
        ]
        return [*lines, *(codes if self.checked else [])]

    def _has_rows(self) -> bool:
        """Whether a later element than the first is accessed, so that the distance of rows matters."""
        elements = state_elements(self.kernel).items()
        later = any(element.index and element.index.offset for name, element in elements if name in self.kernel.used)
        several = any(o.size > 1 for o in self.kernel.outputs)
        return later or several or self.checked or bool(state_views(self.kernel))
