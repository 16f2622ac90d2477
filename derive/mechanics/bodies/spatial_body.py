"""The general body in space: its tables as parameters or as numbers, for both ways of lowering.

The parameters of a body are m, then the tables that it has, entry by entry in the order of `entries`; gravity last.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.mechanics import motion, quantity
from derive.mechanics import virtual_work_equations as body
from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.mechanics.equations import Coefficient, Equations, ParameterSymbol
from derive.mechanics.indexed_equations import (
    GenericEquations,
    Kind,
    Table,
    generic_equations,
    indices,
    labels,
    point_tables,
)
from derive.mechanics.points import MaterialPoint
from derive.mechanics.series import PARITY
from derive.mechanics.spatial import PAIRS, spatial_motion
from derive.mechanics.virtual_work_equations import Body
from derive.spec.model.body import Gravity, SymbolicBody

Array = NDArray[np.float64]

DOCS = {
    "c1": ("int rho X", "kg m"),
    "c2": ("int rho Phi_i", "kg"),
    "C3": ("int rho ((X . X) I - X X)", "kg m^2"),
    "C4": ("symmetric part of int rho ((Phi_i . X) I - Phi_i X)", "kg m"),
    "C5": ("symmetric part of int rho ((Phi_i . Phi_j) I - Phi_i Phi_j)", "kg"),
    "c6": ("int rho X x Phi_i", "kg m"),
    "c7": ("int rho Phi_i x Phi_j", "kg"),
    "c8": ("int rho Phi_i . Phi_j", "kg"),
    "K": ("stiffness", "N/m"),
    "B": ("damping", "N s/m"),
}
"""All tables in the order of the parameters: what they are, their units."""

MEAN = {
    "c1": "the choice of O (the centre of mass)",
    "c2": "condition (17) (no mean displacement)",
    "c6": "condition (19) (no mean rotation)",
    "c8": "orthogonality (modes orthonormal in the mass)",
    "K": "orthogonality (modes orthonormal in the mass and the stiffness)",
    "B": "orthogonality (damping of each mode alone)",
}
"""Why integrals vanish in the mean frame; of c8, K and B those off the diagonal."""

NOTHING = "the sum over the nodes, which is exactly zero"
NO_SHAPES = "the number of shapes (there is none)"
ODD = "c7 is odd in its indices (one shape does not act on itself)"
UNDAMPED = "the specification (no damping)"
MASS = ParameterSymbol(sp.Symbol("m", positive=True), "mass of the body", "kg", 1.0)


def entries(table: str, n: int) -> Iterator[str]:
    """The names of the entries of a table in the order of the parameters: C5_1_2_11."""
    shapes = range(1, n + 1)
    odd = PARITY.get(table, 1) < 0
    counted: dict[str, list[tuple[int, ...]]] = {
        "": [()],
        "i": [(i,) for i in shapes],
        "ij": [(i, j) for i in shapes for j in shapes if i < j or (i == j and not odd)],
    }
    for numbers, label in product(counted[indices(table)], labels(table)):
        yield "_".join([table, *map(str, numbers), *([label] if label else [])])


def symbolic_tables(spec: SymbolicBody) -> tuple[Table, ...]:
    """What tables a body with parameters has, by its frame."""
    kinds: dict[str, tuple[Kind, str]] = {}
    if spec.frame == "mean":
        kinds |= {name: ("zero", MEAN[name]) for name in ("c1", "c2", "c6")}
        kinds |= {"c8": ("unit", MEAN["c8"]), "K": ("diagonal", MEAN["K"]), "B": ("diagonal", MEAN["B"])}
    if not spec.damping:
        kinds["B"] = ("zero", UNDAMPED)
    return _tables(spec.modes, kinds)


def modal_tables(given: ModalBody) -> tuple[Table, ...]:
    """What tables a body of numbers has: those that are not zero; c8, K and B may be diagonal; its points last."""
    kinds: dict[str, tuple[Kind, str]] = {}
    values = {name: _values(given, name) for name in DOCS}
    for name in ("c8", "K", "B"):
        matrix = {"c8": given.c8, "K": given.stiffness, "B": given.damping}[name]
        if not np.count_nonzero(matrix - np.diag(np.diag(matrix))):
            unit = name == "c8" and bool(np.all(np.diag(matrix) == 1))
            kinds[name] = "unit" if unit else "diagonal", _reason(given, name)
    kinds |= {name: ("zero", _reason(given, name)) for name, v in values.items() if not np.any(v)}
    points = (t for k, point in enumerate(given.points, 1) for t in point_tables(k, point.name))
    return (*_tables(given.modes, kinds), *points)


def _tables(n: int, kinds: dict[str, tuple[Kind, str]]) -> tuple[Table, ...]:
    found = []
    for name, (doc, unit) in DOCS.items():
        kind, zero = kinds.get(name, ("full", ""))
        if indices(name) and n == 0:
            kind, zero = "zero", NO_SHAPES
        elif name == "c7" and n == 1:
            kind, zero = "zero", ODD
        found.append(Table(name, kind, doc, unit, zero))
    return tuple(found)


def _values(given: ModalBody, name: str) -> Array:
    """The entries of a table, in the order of `entries`."""
    n = given.modes
    if name.startswith(("X", "Phi")):
        point = given.points[int(name.lstrip("XPhi")) - 1]
        return np.asarray(point.position if name.startswith("X") else point.shapes).ravel()
    if name in ("C3", "C4", "C5"):
        tensor = getattr(given, name)
        even = (tensor + np.swapaxes(tensor, -1, -2)) / 2
        components = np.stack([even[..., a - 1, b - 1] for a, b in PAIRS], axis=-1)
        return components[np.triu_indices(n)].ravel() if name == "C5" else components.ravel()
    if name in ("c8", "K", "B"):
        matrix = {"c8": given.c8, "K": given.stiffness, "B": given.damping}[name]
        return np.asarray(matrix[np.triu_indices(n)])
    if name == "c7":
        return given.c7[np.triu_indices(n, 1)].ravel()
    return np.asarray(getattr(given, name)).ravel()


def _reason(given: ModalBody, name: str) -> str:
    """Why a table vanishes, or vanishes off its diagonal: what the body says of its first zero entry."""
    said = (given.zeros[e] for e in entries(name, given.modes) if e in given.zeros)
    return next(said, NOTHING)


def parameters(given: ModalBody, tables: tuple[Table, ...], gravity: Gravity | None = None) -> Array:
    """The parameters p of a body for a model with these tables, gravity at its defaults.

    Raises ValueError when the body has an integral that the model takes to vanish.
    """
    parts = [np.array([given.mass])]
    for t in tables:
        values = _values(given, t.name)
        if t.kind == "full":
            parts.append(values)
            continue
        diagonal = np.zeros(len(values), dtype=bool)
        if indices(t.name) == "ij":
            diagonal = np.array([i == j for i, j in zip(*np.triu_indices(given.modes), strict=True)], dtype=bool)
        size = np.abs(values).max(initial=0.0)
        if np.any(np.abs(values[~diagonal] if t.kind != "zero" else values) > 1e-9 * max(size, given.mass)):
            raise ValueError(f"the model takes {t.name} to vanish ({t.zero}), but that of {given.name} does not")
        if t.kind == "unit" and np.any(np.abs(values[diagonal] - 1) > 1e-9):
            raise ValueError(
                f"the model takes {t.name} to be the unit matrix ({t.zero}), but that of {given.name} is not: "
                "bring the body to the mean frame with orthonormal modes, or scale them to modal masses of 1 kg"
            )
        if t.kind == "diagonal":
            parts.append(values[diagonal])
    _, symbols = quantity.gravity(gravity)
    return np.concatenate([*parts, [p.default for p in symbols]])


def derive_modal(given: ModalBody, gravity: Gravity | None = None) -> Equations:
    """The equations of motion of a body of numbers, written out; its integrals are folded as the doubles they are."""

    def number(entry: str, value: float) -> tuple[sp.Expr, str | None]:
        return sp.Rational(value), None if value else given.zeros.get(entry, NOTHING)

    values = {
        entry: number(entry, float(value))
        for name in DOCS
        for entry, value in zip(entries(name, given.modes), _values(given, name), strict=True)
    }
    points = tuple(map(_point, given.points))
    return _written_out(
        given.name, given.doc, _where(given), given.modes, values, sp.Rational(given.mass), points, (), gravity
    )


def derive_symbolic(spec: SymbolicBody) -> Equations:
    """The equations of motion of a body whose mass, shape integrals and stiffness are parameters, written out."""
    values: dict[str, tuple[sp.Expr, str | None]] = {}
    symbols = [MASS]
    for t in symbolic_tables(spec):
        for entry in entries(t.name, spec.modes):
            same = _on_diagonal(entry)
            if t.kind == "zero" or (t.kind != "full" and not same):
                values[entry] = sp.S.Zero, t.zero
            elif t.kind == "unit":
                values[entry] = sp.S.One, None
            else:
                symbol = sp.Symbol(f"{entry}_")
                default = float(same and t.name in ("C3", "c8", "K"))
                symbols.append(ParameterSymbol(symbol, t.doc, t.unit, default, positive=False))
                values[entry] = symbol, None
    doc = describe_symbolic(spec)
    return _written_out(spec.name, doc, "", spec.modes, values, MASS.symbol, (), tuple(symbols), spec.gravity)


def _on_diagonal(entry: str) -> bool:
    """c8_2_2, K_1_1; C3_11."""
    name, *rest = entry.split("_")
    return rest[0][0] == rest[0][-1] if name == "C3" else len(rest) > 1 and rest[0] == rest[1]


def describe_symbolic(spec: SymbolicBody) -> str:
    """What the body is, in a line."""
    frame = "mean frame" if spec.frame == "mean" else "modes as given"
    return f"free body in space, {frame}, {spec.modes} modes, shape integrals as parameters"


def _written_out(
    name: str,
    doc: str,
    origin: str,
    n: int,
    values: dict[str, tuple[sp.Expr, str | None]],
    mass: sp.Expr,
    points: tuple[MaterialPoint, ...],
    symbols: tuple[ParameterSymbol, ...],
    gravity: Gravity | None,
) -> Equations:
    by_table: dict[str, list[Coefficient]] = {table: [] for table in DOCS}
    for entry, (value, zero) in values.items():
        table = entry.split("_")[0]
        what, unit = DOCS[table]
        equation = "(13)" if table in ("K", "B") else "appendix"
        by_table[table].append(Coefficient(sp.Symbol(entry), value, equation, what, unit, zero))
    integrals = tuple(c for table, found in by_table.items() if table not in ("K", "B") for c in found)
    weight, of_gravity = quantity.gravity(gravity)
    damped = any(not c.zero for c in by_table["B"])
    return body.equations(
        Body(
            name=name,
            doc=doc,
            origin=origin,
            motion=spatial_motion(n),
            mass=mass,
            integrals=integrals,
            stiffness=tuple(by_table["K"]),
            points=points,
            parameters=(*symbols, *of_gravity),
            damping=tuple(by_table["B"]) if damped else (),
            gravity=weight,
        )
    )


def _where(given: ModalBody) -> str:
    """Where c is, as a sentence."""
    return f"c is where {given.origin} lies in the floating frame." if given.origin else ""


def _point(point: ModalPoint) -> MaterialPoint:
    def exact(vector: Array) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([sp.Rational(float(x)) for x in vector])

    return MaterialPoint(point.name, point.doc, exact(point.position), tuple(map(exact, point.shapes)))


def generic_symbolic(spec: SymbolicBody) -> GenericEquations:
    """The equations of motion of a body with parameters, for a generic shape."""
    return _generic(spec.name, describe_symbolic(spec), "", spec.modes, symbolic_tables(spec), spec.gravity)


def _generic(
    name: str, doc: str, origin: str, n: int, tables: tuple[Table, ...], gravity: Gravity | None,
    points: tuple[ModalPoint, ...] = (), data: Array | None = None, mass: float = 1.0,
) -> GenericEquations:  # fmt: skip
    weight, of_gravity = quantity.gravity(gravity)
    scalars = (Coefficient(motion.MASS, MASS.symbol, "(15)", "mass of the body", "kg"), *weight)
    first = ParameterSymbol(MASS.symbol, MASS.doc, MASS.unit, mass)
    return generic_equations(
        name,
        doc,
        origin,
        n,
        tables,
        scalars,
        (first, *of_gravity),
        tuple((p.name, p.doc) for p in points),
        None if data is None else tuple(map(float, data)),
    )


def generic_modal(given: ModalBody, gravity: Gravity | None = None) -> GenericEquations:
    """The equations of motion of a body of numbers, for a generic shape: its numbers are the defaults of parameters."""
    tables = modal_tables(given)
    data = parameters(given, tables, gravity)
    return _generic(given.name, given.doc, _where(given), given.modes, tables, gravity, given.points, data, given.mass)


Present = dict[str, NDArray[np.bool_]]
"""Which entries of C5 (N, N, 6), c7 (N, N, 3), K, B (N, N, 1), C4 (N, 6), c2 and c6 (N, 3) there are."""


def present_modal(given: ModalBody) -> Present:
    """The entries of a body of numbers that do not vanish."""
    n, found = given.modes, {}
    for name in ("C4", "c2", "c6"):
        found[name] = (_values(given, name) != 0).reshape(n, len(labels(name)))
    for name in ("C5", "c7", "K", "B"):
        full = np.zeros((n, n, len(labels(name))), dtype=bool)
        upper = np.triu_indices(n, 1 if name == "c7" else 0)
        full[upper] = (_values(given, name) != 0).reshape(-1, len(labels(name)))
        found[name] = full | full.swapaxes(0, 1)
    return found


def present_symbolic(spec: SymbolicBody) -> Present:
    """The entries that a body with parameters has."""
    n, found = spec.modes, {}
    for t in symbolic_tables(spec):
        if indices(t.name):
            full = np.full((n,) * len(indices(t.name)) + (len(labels(t.name)),), t.kind == "full")
            if t.kind == "diagonal":
                full |= np.eye(n, dtype=bool)[..., None]
            found[t.name] = full
    return found
