"""Kernels with loops over the shapes, put together section by section from generic equations.

What expressions need is computed before them: table sums first, then mode
sums, then scalars.
In a loop, expressions are sums of products of what depends on its index; their factors are computed before it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import count

import casadi as ca
import sympy as sp

from derive.ir.expressions import ArrayAccess, Expr, Leaf, MatrixEntry, Number, Operation, Operator, ScalarRef
from derive.ir.model import Argument, Kernel, Output, Section
from derive.ir.statements import (
    Accumulate,
    Let,
    Map,
    MatrixStore,
    MatVec,
    MatVecTerm,
    Packing,
    Require,
    Statement,
    Store,
    StoreLocal,
    StoreStrided,
    Sum,
    reads,
)
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Constants, Graph
from derive.lowering.flat.schedule import Named, Step, Stored, Want, schedule
from derive.lowering.functions import ModelFunction, OutputElements
from derive.mechanics.sums import ModeSum, TableSum, canonical
from derive.mechanics.symbols import I, Symbol, amplitude, identity, is_indexed, local
from derive.mechanics.terms import Intermediate, rotation_symbols

Target = Symbol | Store | Require
"""The target of a scalar: a symbol that is known from then on, or a statement whose expression is replaced."""

Scalar = tuple[Target, sp.Expr]
"""A scalar: its target and its value."""

IndexedStore = tuple[StoreLocal | StoreStrided, sp.Expr]
"""The target of an expression in index i, and the expression."""

Assignment = Let | Store | Require | StoreLocal | StoreStrided
"""A statement that assigns or checks the value of one expression."""

NOTHING = Number(Fraction(0))


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
        self._factors: dict[sp.Expr, Symbol] = {}

    def sums(self, exprs: Iterable[sp.Expr]) -> None:
        """Compute the table sums and the mode sums that expressions refer to."""
        symbols = _symbols(exprs)
        mode_sums = [t for s, t in self.mode_sums.items() if s in symbols and s not in self.known]
        inside = symbols | _symbols(e for t in mode_sums for e in (t.offset, t.term))
        self._add_table_sums([c for s, c in self.table_sums.items() if s in inside and s not in self._arrays])
        self.add_mode_sums(mode_sums)

    def _add_table_sums(self, table_sums: list[TableSum]) -> None:
        terms = []
        for c in table_sums:
            self._arrays.add(c.symbol)
            pairs = tuple((self._vector(factor, entry), array(canonical(entry))) for factor, entry in c.sums)
            terms.append(MatVecTerm(array(c.symbol), array(c.offset) if c.offset != 0 else "", pairs))
        if terms:
            section = Section("tables", "appendix", _described(table_sums), (MatVec(self.packing, tuple(terms)),))
            self.sections.append(section)

    def _vector(self, factor: Symbol, entry: Symbol) -> str:
        """The factor of a table; of an odd table with its indices exchanged, the factor with its sign changed."""
        vector = array(factor)
        if canonical(entry) == entry:
            return vector
        name = f"minus_{vector}"
        if local(name) not in self._arrays:
            self._arrays.add(local(name))
            negated = StoreLocal(name, Operation(Operator.NEG, (ArrayAccess(vector, "i"),)))
            self.sections.append(Section(name, "", f"{vector} with its sign changed", (self._each((negated,)),)))
        return name

    def add_mode_sums(self, mode_sums: Iterable[ModeSum]) -> None:
        """Compute mode sums in a single loop."""
        mode_sums = tuple(mode_sums)
        if not mode_sums:
            return
        body = self._loop([(StoreLocal("", NOTHING), by_vector(t.term)) for t in mode_sums])
        lets = tuple(item for item in body if isinstance(item, Let))
        terms = [item.expr for item in body if not isinstance(item, Let)]
        offsets: list[Leaf] = [NOTHING if t.offset == 0 else self.known[t.offset] for t in mode_sums]
        sums = tuple(Sum(t.symbol.name, base, term) for t, base, term in zip(mode_sums, offsets, terms, strict=True))
        loop = Accumulate(self.packing.count, lets, sums)
        self.sections.append(Section("sums", "appendix", _described(mode_sums), (loop,)))
        self.known |= {t.symbol: ScalarRef(t.symbol.name) for t in mode_sums}

    def scalars(self, name: str, equation: str, doc: str, wants: Iterable[Scalar]) -> None:
        """Compute scalars in straight line, with the definitions that they need; symbols are known from then on."""
        wants = tuple(wants)
        if wants:
            self.straight(name, equation, doc, lambda symbols: [(t, symbols(expr)) for t, expr in wants])

    def straight(
        self, name: str, equation: str, doc: str, make: Callable[[Symbols], list[tuple[Target, ca.SX]]]
    ) -> None:
        """Like `scalars`, of what `make` makes of the symbols."""
        symbols = Symbols(early=frozenset(), late=self._rotation())
        for symbol, leaf in self.known.items():
            symbols.input(symbol, leaf)
        groups: dict[str, list[Intermediate]] = {}
        for d in self.definitions:
            if d.symbol not in symbols.values and d.expr.free_symbols <= symbols.values.keys():
                symbols.define(d.symbol, d.expr)
                groups.setdefault(d.section, []).append(d)
        steps = tuple(
            Step(section, ds[0].equation, ds[0].doc, tuple(Named(str(d.symbol), symbols.values[d.symbol]) for d in ds))
            for section, ds in groups.items()
        )
        wants = make(symbols)
        stored: list[Want] = []
        for k, (target, value) in enumerate(wants):
            stored += [Named(target.name, value)] if isinstance(target, Symbol) else []
            stored.append(Stored("", k, value))
        targets = [Let(t.name, NOTHING) if isinstance(t, Symbol) else t for t, _ in wants]
        for section in schedule(
            Graph(Constants(frozenset())),
            symbols,
            steps,
            (Step(name, equation, doc, tuple(stored)),),
            self._temporaries,
        ):
            placed = (_targeted(item, targets) for item in section.body)
            body = tuple(t for t in placed if isinstance(t, Let | Store | Require) and not _is_redundant(t))
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
        pairs: Iterable[tuple[MatrixStore, sp.Expr, sp.Expr]] = (),
    ) -> None:
        """Scalars, then a loop for rows, then a loop for each block of pairs (its expression, that of its diagonal)."""
        scalars, rows, pairs = tuple(scalars), tuple(rows), tuple(pairs)
        self.sums([*(e for _, e in (*scalars, *rows)), *(e for _, *both in pairs for e in both)])
        before = len(self._factors)
        lines = [(target, self.linear(expr)) for target, expr in rows]
        blocks = [(loop, self.linear(full), self.linear(diagonal)) for loop, full, diagonal in pairs]
        fresh = list(self._factors.items())[before:]
        factors: list[Scalar] = [(symbol, expr) for expr, symbol in fresh]
        self.scalars(name, equation, doc, (*factors, *scalars))
        loops: list[Statement] = []
        if lines and self.packing.count:
            loops.append(self._each(self._loop(lines)))
        for loop, full, diagonal in blocks:
            inside, extra = self._pair(full), None if diagonal == 0 else self._pair(diagonal)
            loops.append(MatrixStore(loop.packing, loop.output, loop.offset, loop.stride, inside, extra))
        if loops and self.packing.count:
            self.sections.append(Section(f"{name}_i", equation, f"{doc}, for each mode", tuple(loops)))

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
        of the program; `method` completes the sentence that says what the function computes.
        """
        arguments = tuple(inputs[name] for name in function.arguments)
        given = ((name, doc, outputs[name]) for name, doc in function.outputs.items())
        results = tuple(Output(name, e.names, doc, e.pattern, e.count) for name, doc, e in given)
        sections = [*self.sections, *more]
        while True:
            used = {n for section in sections for statement in section.body for n in reads(statement)}
            kept = [
                replace(s, body=tuple(b for b in s.body if not isinstance(b, Let) or b.name in used)) for s in sections
            ]
            if kept == sections:
                doc = f"{function.doc}{method}"
                return Kernel(function.name, doc, arguments, results, tuple(s for s in sections if s.body))
            sections = kept

    def linear(self, expr: sp.Expr) -> sp.Expr:
        """An expression of indices as a sum of products of indexed symbols, with scalar factors that have a name."""
        grouped: dict[sp.Expr, sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(expr)):
            scalar, indexed = term.as_independent(*(s for s in term.free_symbols if is_indexed(s)), as_Add=False)
            grouped[indexed] = grouped.get(indexed, sp.S.Zero) + scalar
        return sp.Add(*(self._factor(scalar) * indexed for indexed, scalar in grouped.items()))

    def _factor(self, expr: sp.Expr) -> sp.Expr:
        """A scalar as it occurs in a loop: a number, a known name, or a new name for it; signs stay outside."""
        if expr.could_extract_minus_sign():
            return -self._factor(-expr)
        if expr.is_Rational or expr in self.known:
            return expr
        if expr not in self._factors:
            own = local(f"f{len(self._factors) + 1}")
            self._factors[expr] = expr if any(d.symbol == expr for d in self.definitions) else own
        return self._factors[expr]

    def _each(self, body: tuple[Let | StoreLocal | StoreStrided, ...]) -> Map:
        return Map(self.packing.count, body)

    def _loop(self, rows: list[IndexedStore]) -> tuple[Let | StoreLocal | StoreStrided, ...]:
        """The body of a loop over i."""
        symbols = Symbols(early=frozenset(self.known), late=frozenset())
        for symbol in sorted(_symbols(e for _, e in rows), key=str):
            symbols.input(symbol, ArrayAccess(array(symbol), "i") if is_indexed(symbol) else self.known[symbol])
        stored = tuple(Stored("", k, symbols(expr)) for k, (_, expr) in enumerate(rows))
        step = Step("loop", "", "", stored)
        (section,) = schedule(Graph(Constants(frozenset())), symbols, (), (step,), self._temporaries)
        targets = [target for target, _ in rows]
        placed = (_targeted(item, targets) for item in section.body)
        return tuple(item for item in placed if isinstance(item, Let | StoreLocal | StoreStrided))

    def _pair(self, expr: sp.Expr) -> Expr:
        """An expression of i and j, without names in between."""
        symbols = Symbols(early=frozenset(self.known), late=frozenset())
        for symbol in sorted(expr.free_symbols, key=str):
            symbols.input(symbol, _pair_leaf(symbol) if is_indexed(symbol) else self.known[symbol])
        step = Step("pair", "", "", (Stored("", 0, symbols(expr)),))
        (section,) = schedule(Graph(Constants(frozenset())), symbols, (), (step,), self._temporaries)
        (item,) = section.body
        assert isinstance(item, Store)
        return item.expr


def array(symbol: sp.Basic) -> str:
    """What an indexed quantity is called as an array: S_i_11 is S_11."""
    return replace(identity(symbol), shapes=()).name


def by_vector(term: sp.Expr) -> sp.Expr:
    """alpha_i a + alpha_i b as alpha_i (a + b)."""
    vectors = [amplitude(I, derivative) for derivative in range(3)]
    grouped: dict[sp.Expr, list[sp.Expr]] = {}
    for part in sp.Add.make_args(sp.expand(term)):
        first = next((v for v in vectors if v in part.free_symbols), sp.S.One)
        grouped.setdefault(first, []).append(part / first)
    return sp.Add(*(sp.Mul(v, sp.Add(*rest), evaluate=False) for v, rest in grouped.items()), evaluate=False)


def _pair_leaf(symbol: sp.Symbol) -> Leaf:
    return MatrixEntry(array(symbol)) if len(identity(symbol).shapes) == 2 else ArrayAccess(array(symbol), "i")


def _targeted(item: Statement, targets: Sequence[Assignment]) -> Assignment:
    """A statement of a schedule, with its target replaced by the target of the scalar."""
    if not isinstance(item, Store):
        assert isinstance(item, Let | Require)
        return item
    match targets[item.index]:
        case Let(name):
            return Let(name, item.expr)
        case Store(output, index):
            return Store(output, index, item.expr)
        case Require(kind, _, code, text):
            return Require(kind, item.expr, code, text)
        case StoreLocal(name):
            return StoreLocal(name, item.expr)
        case StoreStrided(output, offset, stride):
            return StoreStrided(output, offset, stride, item.expr)
    raise AssertionError("a target is a statement that assigns a value")


def _is_redundant(item: Assignment) -> bool:
    """Whether a definition only assigns a name to itself."""
    return isinstance(item, Let) and item.expr == ScalarRef(item.name)


def _symbols(exprs: Iterable[sp.Expr]) -> set[sp.Symbol]:
    return {s for e in exprs for s in sp.sympify(e).free_symbols}


def _described(sums: Iterable[TableSum | ModeSum]) -> str:
    """The descriptions of sums, `S_i = ...`, once for all components of a quantity."""
    docs: dict[str, str] = {}
    for s in sums:
        stem = replace(s.symbol.identity, components=()).name
        docs.setdefault(stem, s.doc)
    return "; ".join(f"{stem} = {doc}" for stem, doc in docs.items())
