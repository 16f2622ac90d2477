"""A kernel with loops over the modes under construction, section by section, from indexed equations.

What expressions need is computed before them: table sums first, then mode sums, then scalars, then loops.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import count
from typing import TypeAlias

import casadi as ca

from derive.algebra import sp
from derive.ir.analysis import reads
from derive.ir.expressions import Expr, Leaf, Number, ScalarRef
from derive.ir.kernel import Argument, Kernel, Output, Section
from derive.ir.packing import Packing
from derive.ir.statements import (
    Accumulate,
    Let,
    Map,
    MatrixStore,
    MatVec,
    MatVecTerm,
    Product,
    Require,
    Statement,
    Store,
    StoreLocal,
    StoreStrided,
    Sum,
)
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import NamedValue, OutputValue, Step, StepItem, schedule
from derive.lowering.loops.assignments import (
    NOTHING,
    Assignment,
    IndexedStore,
    Scalar,
    Target,
    assignments,
    free_symbols,
    map_body,
    pair_expression,
)
from derive.lowering.loops.loop_invariants import LoopInvariants, by_vector
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.sums import PARITY, ModeSum, TableSum, canonical
from derive.mechanics.symbols import identity, is_indexed
from derive.mechanics.terms import Intermediate, rotation_symbols
from derive.mechanics.typed_symbol import Symbol
from derive.roles import Source

Pair: TypeAlias = "tuple[MatrixStore, sp.Expr, sp.Expr]"
"""A block of pairs of modes: where it is stored, its expression, and that of its diagonal."""


class Program:
    """A kernel under construction; `known` maps the scalars computed so far to their leaves in the kernel."""

    def __init__(
        self,
        packing: Packing,
        known: Mapping[sp.Symbol, Number | ScalarRef],
        definitions: Iterable[Intermediate],
        table_sums: Iterable[TableSum],
        mode_sums: Iterable[ModeSum],
    ) -> None:
        self.packing = packing
        self.known: dict[sp.Symbol, Number | ScalarRef] = dict(known)
        self.definitions = [d for d in definitions if not d.zero]
        self.table_sums = {c.symbol: c for c in table_sums}
        self.mode_sums = {t.symbol: t for t in mode_sums}
        self.sections: list[Section] = []
        self._arrays: set[sp.Symbol] = set()
        self._temporaries = (f"t{k}" for k in count(1))
        self._invariants = LoopInvariants(self.known, self.definitions)

    def sums(self, exprs: Iterable[sp.Expr], stores: tuple[MatrixStore, ...] = (), doc: str = "") -> None:
        """Compute the table sums and the mode sums that expressions refer to.

        `stores` are stored together with the table sums, block by block, while the tables are in the nearest memory;
        `doc` describes them.
        """
        symbols = free_symbols(exprs)
        mode_sums = [t for s, t in self.mode_sums.items() if s in symbols and s not in self.known]
        inside = symbols | free_symbols(e for t in mode_sums for e in (t.offset, t.term))
        wanted = [c for s, c in self.table_sums.items() if s in inside and s not in self._arrays]
        self._add_table_sums(wanted, stores, doc)
        self.add_mode_sums(mode_sums)

    def _add_table_sums(self, table_sums: list[TableSum], stores: tuple[MatrixStore, ...], doc: str) -> None:
        terms = []
        for c in table_sums:
            self._arrays.add(c.symbol)
            sums = tuple(_product(factor, entry) for factor, entry in c.sums)
            base = identity(c.offset).array if c.offset != 0 else ""
            terms.append(MatVecTerm(c.symbol.identity.array, base, sums))
        products = [MatVec(self.packing, tuple(terms))] if terms else []
        body: tuple[Statement, ...] = (*products, *stores)
        if body:
            docs = [*([_described(table_sums)] if terms else []), *([doc] if stores else [])]
            self.sections.append(Section("tables", Source.APPENDIX, "; ".join(docs), body))

    def add_mode_sums(self, mode_sums: Iterable[ModeSum]) -> None:
        """Compute mode sums in a single loop."""
        mode_sums = tuple(mode_sums)
        if not mode_sums:
            return
        rows = [(StoreLocal("", NOTHING), by_vector(t.term)) for t in mode_sums]
        body = map_body(rows, self.known, self._temporaries)
        lets = tuple(item for item in body if isinstance(item, Let))
        terms = [item.expr for item in body if not isinstance(item, Let)]
        offsets: list[Leaf] = [NOTHING if t.offset == 0 else self.known[t.offset] for t in mode_sums]
        sums = tuple(Sum(t.symbol.name, base, term) for t, base, term in zip(mode_sums, offsets, terms, strict=True))
        loop = Accumulate(self.packing.count, lets, sums)
        self.sections.append(Section("sums", Source.APPENDIX, _described(mode_sums), (loop,)))
        self.known |= {t.symbol: ScalarRef(t.symbol.name) for t in mode_sums}

    def scalars(self, name: str, equation: str, doc: str, wants: Iterable[Scalar]) -> None:
        """Compute scalars in straight line, with the definitions that they need; symbols are known from then on."""
        wants = tuple(wants)
        if wants:
            self.straight(name, equation, doc, lambda symbols: [(t, symbols(expr)) for t, expr in wants])

    def straight(
        self, name: str, equation: str, doc: str, make: Callable[[Symbols], list[tuple[Target, ca.SX]]]
    ) -> None:
        """Compute the values that `make` returns for the symbols, with the definitions that they need."""
        symbols = Symbols(early=frozenset(), late=self._rotation())
        for symbol, leaf in self.known.items():
            symbols.input(symbol, leaf)
        groups: dict[str, list[Intermediate]] = {}
        for d in self.definitions:
            if d.symbol not in symbols.values and d.expr.free_symbols <= symbols.values.keys():
                symbols.define(d.symbol, d.expr)
                groups.setdefault(d.section, []).append(d)
        steps = tuple(
            Step(
                section,
                ds[0].equation,
                ds[0].doc,
                tuple(NamedValue(str(d.symbol), symbols.values[d.symbol]) for d in ds),
            )
            for section, ds in groups.items()
        )
        wants = make(symbols)
        stored: list[StepItem] = []
        for k, (target, value) in enumerate(wants):
            stored += [NamedValue(target.name, value)] if isinstance(target, Symbol) else []
            stored.append(OutputValue("", k, value))
        targets = [Let(t.name, NOTHING) if isinstance(t, Symbol) else t for t, _ in wants]
        for section in schedule(
            Graph(),
            symbols,
            steps,
            (Step(name, equation, doc, tuple(stored)),),
            self._temporaries,
        ):
            assigned = assignments(section.body, targets)
            body = tuple(t for t in assigned if isinstance(t, Let | Store | Require) and not _is_redundant(t))
            names = {item.name for item in section.body if isinstance(item, Let)}
            self.known |= {d.symbol: ScalarRef(str(d.symbol)) for d in self.definitions if str(d.symbol) in names}
            self.sections.append(Section(section.name, section.equation, section.doc, body))
        self.known |= {t: ScalarRef(t.name) for t, _ in wants if isinstance(t, Symbol)}

    def _rotation(self) -> frozenset[sp.Symbol]:
        return rotation_symbols(self.definitions)

    def phase(
        self,
        name: str,
        equation: str,
        doc: str,
        scalars: Iterable[Scalar] = (),
        rows: Iterable[IndexedStore] = (),
        pairs: Iterable[Pair] = (),
    ) -> None:
        """Compute scalars, rows in a loop, and each block of pairs (its expression, that of its diagonal) in a loop.

        Blocks that need no sums are stored while the tables are read for the sums, all others at the end.
        """
        scalars, rows, pairs = tuple(scalars), tuple(rows), tuple(pairs)
        hoisted = self._invariants.hoisted
        early = [pair for pair in pairs if self.packing.count and self._is_available(pair[1:])]
        first = [(loop, hoisted(full), hoisted(diagonal)) for loop, full, diagonal in early]
        if first:
            self.scalars(name, equation, doc, self._invariants.unassigned())
        wanted = [*(e for _, e in (*scalars, *rows)), *(e for _, *both in pairs for e in both)]
        self.sums(wanted, tuple(map(self._matrix_store, first)), f"{doc}, for each pair of modes")
        lines = [(target, hoisted(expr)) for target, expr in rows]
        late = [
            (loop, hoisted(full), hoisted(diagonal))
            for loop, full, diagonal in pairs
            if (loop, full, diagonal) not in early
        ]
        self.scalars(name, equation, doc, (*self._invariants.unassigned(), *scalars))
        loops: list[Statement] = []
        if lines and self.packing.count:
            loops.append(self._each(map_body(lines, self.known, self._temporaries)))
        loops += map(self._matrix_store, late)
        if loops and self.packing.count:
            self.sections.append(Section(f"{name}_i", equation, f"{doc}, for each mode", tuple(loops)))

    def _is_available(self, exprs: Iterable[sp.Expr]) -> bool:
        """Whether expressions depend on no sums, neither directly nor through definitions."""
        scalars = set(self.known)
        for d in self.definitions:
            if d.expr.free_symbols <= scalars:
                scalars.add(d.symbol)
        symbols = free_symbols(exprs)
        return all(s not in self.table_sums if is_indexed(s) else s in scalars for s in symbols)

    def _matrix_store(self, pair: Pair) -> MatrixStore:
        """The statement of a block of pairs."""
        loop, full, diagonal = pair
        extra = None if diagonal == 0 else self._pair(diagonal)
        return replace(loop, expr=self._pair(full), diagonal=extra)

    def kernel(
        self,
        function: ModelFunction,
        inputs: Mapping[str, Argument],
        outputs: Mapping[str, OutputElements],
        *more: Section,
        method: str = "",
    ) -> Kernel:
        """The kernel of a function, without names that nothing reads.

        `inputs` are the arguments by their names, `outputs` the elements of each output; `more` sections follow those
        of the program; `method` completes the sentence that documents the function.
        """
        arguments = tuple(inputs[name] for name in function.arguments)
        given = ((name, doc, outputs[name]) for name, doc in function.outputs.items())
        results = tuple(Output(name, e.names, doc, e.pattern, e.count) for name, doc, e in given)
        sections = _without_unread([*self.sections, *more])
        doc = f"{function.doc}{method}"
        return Kernel(function.name, doc, arguments, results, tuple(s for s in sections if s.body))

    def _pair(self, expr: sp.Expr) -> Expr:
        return pair_expression(expr, self.known, self._temporaries)

    def _each(self, body: tuple[Let | StoreLocal | StoreStrided, ...]) -> Map:
        return Map(self.packing.count, body)


def _product(factor: Symbol, entry: Symbol) -> Product:
    """The product of a table and a factor; an odd table with its indices exchanged has its sign changed."""
    kept = canonical(entry)
    sign = 1 if kept == entry else PARITY[entry.identity.family]
    return Product(factor.identity.array, kept.identity.array, sign)


def _without_unread(sections: list[Section]) -> list[Section]:
    """Sections without names that nothing reads."""
    while True:
        used = {n for section in sections for statement in section.body for n in reads(statement)}
        kept = [replace(s, body=tuple(b for b in s.body if not isinstance(b, Let) or b.name in used)) for s in sections]
        if kept == sections:
            return sections
        sections = kept


def _is_redundant(item: Assignment) -> bool:
    """Whether a definition only assigns a name to itself."""
    return isinstance(item, Let) and item.expr == ScalarRef(item.name)


def _described(sums: Iterable[TableSum | ModeSum]) -> str:
    """The descriptions of sums, `S_i = ...`, once for all components of a quantity."""
    docs: dict[str, str] = {}
    for s in sums:
        stem = replace(s.symbol.identity, components=()).name
        docs.setdefault(stem, s.doc)
    return "; ".join(f"{stem} = {doc}" for stem, doc in docs.items())
