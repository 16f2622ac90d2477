"""The context of the lowering of a model to straight-line code: arguments, symbols, and constants of setup."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import casadi as ca

from derive.algebra import fraction, sp
from derive.ir.expressions import Number, ScalarRef
from derive.ir.kernel import Argument, Kernel, Output, Section
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph, representable
from derive.lowering.flat.gyroscopic_terms import force_rows
from derive.lowering.flat.schedule import NamedValue, OutputValue, RequiredValue, Step, StepItem, schedule
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.flat.shared_sums import SharedSums
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.equations import Equations
from derive.mechanics.fixed_symbols import t
from derive.mechanics.symbols import local, state_rate
from derive.mechanics.terms import Intermediate, ModelConstant, rotation_symbols


@dataclass(frozen=True)
class Input:
    """An argument of a kernel, and the symbols of the derivation for its elements."""

    argument: Argument
    symbols: tuple[sp.Symbol, ...]

    @property
    def elements(self) -> tuple[str, ...]:
        """The names of the elements."""
        return self.argument.elements


def array_input(name: str, symbols: Iterable[sp.Symbol], doc: str) -> Input:
    """An array argument whose elements are named after their symbols."""
    symbols = tuple(symbols)
    return Input(Argument(name, tuple(s.name for s in symbols), doc), symbols)


def scalar_input(symbol: sp.Symbol, doc: str) -> Input:
    """A scalar argument."""
    return Input(Argument(symbol.name, (), doc, scalar=True), (symbol,))


@dataclass(frozen=True, eq=False)
class KktSolution:
    """The solution of a system with the KKT matrix.

    pivots: the values of its factorisation, in their order. values: of the accelerations, then of the multipliers.
    checks: of the pivots. text: in which order they are eliminated.
    """

    pivots: tuple[StepItem, ...]
    values: list[ca.SX]
    checks: tuple[StepItem, ...]
    text: str


class Context:
    """The data that all kernels of a model share during its lowering to straight-line code."""

    def __init__(
        self,
        equations: Equations,
        elimination: EliminationRule = EliminationRule.SAFE,
        proximal: bool = False,
        sensitivities: bool = False,
    ) -> None:
        """proximal: whether redundant constraints have multipliers of least norm, see `derive.lowering.proximal`;
        sensitivities: whether there are derivatives, for which results have to be exact beside unit quaternions too.
        """
        self.equations, self.elimination, self.proximal = equations, elimination, proximal
        self.sensitivities = sensitivities
        self.coefficients = tuple(c for c in equations.coefficients if not c.zero)
        symbolic = (str(c.symbol) for c in self.coefficients if not c.value.is_Rational)
        self.constants = Constants(frozenset(symbolic))
        self.names = tuple(str(c.q) for c in equations.coordinates)
        self.sums = SharedSums(equations.definitions, self.coefficients)
        self.rows = tuple(row.name for row in equations.rows)
        self.rates = tuple(str(row.v) for row in equations.rows)
        self.accelerations = tuple(str(row.a) for row in equations.rows)
        scene = bool(equations.constraints or equations.poses)
        self.t = scalar_input(t, "time" if scene else "time (a free body does not depend on it)")
        q, v = tuple(c.q for c in equations.coordinates), tuple(row.v for row in equations.rows)
        self.state, self.state_rates = q + v, (*map(state_rate, q), *(row.a for row in equations.rows))
        self.q = array_input("q", q, "generalised coordinates")
        self.v = array_input("v", v, "generalised velocities")
        self.k = Input(Argument("k", (), "constants from setup"), ())
        self.y = array_input("y", self.state, "first-order state [q; v]")
        self.ydot = array_input("ydot", self.state_rates, "time derivative of y")
        self.multipliers = tuple(c.name for c in equations.constraints)
        self.forces = tuple(c.multiplier for c in equations.constraints)
        self.vdot = array_input("vdot", (row.a for row in equations.rows), "accelerations, as from solve")
        self.lam = array_input("lam", self.forces, "constraint reactions on body 2 of each joint, as from solve")
        self.u = array_input("u", (given.symbol for given in equations.inputs), "inputs")
        self.cj = scalar_input(local("cj"), "factor of dF/dydot")
        every = (self.t, self.q, self.v, self.vdot, self.lam, self.u, self.k, self.y, self.ydot, self.cj)
        self._symbols: dict[tuple[sp.Symbol, ...], Symbols] = {}
        self._constant_symbols: Symbols | None = None
        self.solutions: dict[Symbols, KktSolution] = {}
        self.inputs: Mapping[str, Input] = {argument.argument.name: argument for argument in every}

    @cached_property
    def force_rows(self) -> tuple[sp.Expr, ...]:
        """The rows of h."""
        return force_rows(self.equations)

    @cached_property
    def symbols_of_accelerations(self) -> Symbols:
        """The symbols of t, q and v that the functions for accelerations share, one with multipliers and one without.

        They need the same solution, which is kept in `solutions`.
        """
        return self.symbols(self.t, self.q, self.v)

    def symbols(self, *inputs: Input) -> Symbols:
        """The CasADi symbols of arguments and of the coefficients, with all definitions that follow from them.

        An argument may be a definition, which is then not computed.

        A kernel with the argument t also has the argument u, the run-time inputs.
        """
        if self.t in inputs:
            inputs = (*inputs, self.u)
        symbols_of_inputs = tuple(chain.from_iterable(argument.symbols for argument in inputs))
        if symbols_of_inputs not in self._symbols:
            self._symbols[symbols_of_inputs] = self._new_symbols(symbols_of_inputs)
        return self._symbols[symbols_of_inputs].copy()

    def _new_symbols(self, inputs: tuple[sp.Symbol, ...]) -> Symbols:
        if self._constant_symbols is None:
            self._constant_symbols = self._of_constants()
        symbols = self._constant_symbols.copy()
        for symbol in inputs:
            symbols.input(symbol, ScalarRef(symbol.name))
        defined = {d.symbol for d in self.equations.definitions}
        symbols.fixed |= {symbol: symbols.values[symbol] for symbol in inputs if symbol in defined}
        define(symbols, self.equations.definitions)
        return symbols

    def _of_constants(self) -> Symbols:
        """The CasADi symbols of the coefficients alone; what is made of them shares the order of terms."""
        eq = self.equations
        symbols = Symbols(frozenset(row.v for row in eq.rows), rotation_symbols(eq.definitions), eq.name, self.sums)
        for c in self.coefficients:
            value = c.value
            leaf = Number(representable(fraction(value))) if value.is_Rational else ScalarRef(str(c.symbol))
            symbols.input(c.symbol, leaf)
        return symbols

    def add_constant(self, constant: ModelConstant) -> None:
        """Add a constant that setup computes from the parameters, for a kernel that follows."""
        self.coefficients = (*self.coefficients, constant)
        self._symbols.clear()
        self._constant_symbols = None
        self.solutions.clear()
        self.__dict__.pop("symbols_of_accelerations", None)
        self.constants.coefficients |= {str(constant.symbol)}

    def definition_steps(self, symbols: Symbols) -> tuple[Step, ...]:
        """A step for each section of definitions that have a value in `symbols`, in the order of the derivation."""
        sections: dict[str, list[Intermediate]] = {}
        values = symbols.values
        for d in self.equations.definitions:
            if d.symbol in values and not d.zero:
                sections.setdefault(d.section, []).append(d)
        return tuple(
            Step(
                name,
                group[0].equation,
                "; ".join(_abbreviated(group)),
                (*(NamedValue(d.symbol.name, values[d.symbol]) for d in group), *_divisors(symbols, group)),
            )
            for name, group in sections.items()
        )

    def kernel(
        self,
        function: ModelFunction,
        outputs: Mapping[str, OutputElements],
        symbols: Symbols,
        *steps: Step,
        inputs: Iterable[Input] = (),
        method: str = "",
    ) -> Kernel:
        """The kernel of a function, from the definitions and the given steps.

        outputs: the elements of each output, by name. inputs: arguments that only this function has, or that replace
        those of the context. method: the end of the sentence that documents the function.
        """
        available = {**self.inputs, **{argument.argument.name: argument for argument in inputs}}
        arguments = tuple(available[name].argument for name in function.arguments)
        results = tuple(
            Output(name, outputs[name].names, doc, outputs[name].pattern) for name, doc in function.outputs.items()
        )
        sections = self.sections(symbols, *steps)
        return Kernel(function.name, f"{function.doc}{method}", arguments, results, sections)

    def sections(self, symbols: Symbols, *steps: Step) -> tuple[Section, ...]:
        """The sections of the definitions and the given steps."""
        return schedule(Graph(self.constants), symbols, self.definition_steps(symbols), steps)

    def mass_pattern(self) -> Pattern:
        """The pattern of the lower triangle of the mass matrix, without structural zeros."""
        mass = self.equations.mass
        n = mass.rows
        return pattern(n, n, {(i, j) for i in range(n) for j in range(i + 1) if mass[i, j] != 0}, symmetric=True)


def define(symbols: Symbols, definitions: tuple[Intermediate, ...]) -> tuple[NamedValue, ...]:
    """Add the definitions that follow from the symbols so far; returns their values by name."""
    result = []
    for d in definitions:
        if d.needs <= symbols.values.keys():
            result.append(NamedValue(d.symbol.name, symbols.define(d.symbol, d.expr)))
    return tuple(result)


def _divisors(symbols: Symbols, definitions: Iterable[Intermediate]) -> Iterator[RequiredValue]:
    """The checks that the divisors in definitions are positive."""
    for d in definitions:
        if d.divisor is not None:
            value, needed_by = symbols.values[d.divisor], d.symbol.name
            yield RequiredValue(Requirement.POSITIVE, value, ReturnCode.NOT_FINITE, d.divisor_text, needed_by)


def stores(output: str, values: list[ca.SX]) -> tuple[StepItem, ...]:
    """The items that store `values` as the elements of an output, in order."""
    return tuple(OutputValue(output, index, value) for index, value in enumerate(values))


def _abbreviated(definitions: list[Intermediate]) -> list[str]:
    """The descriptions of the first and the last of a group of definitions, with an ellipsis in between."""
    first, last = definitions[0], definitions[-1]
    if len(definitions) == 1:
        return [f"{first.symbol} = {first.doc}"]
    return [f"{first.symbol} = {first.doc}", *(["..."] if len(definitions) > 2 else []), f"{last.symbol} = {last.doc}"]
