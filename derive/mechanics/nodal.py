"""A body in space given by nodes, or by its shape integrals as run-time parameters.

Lumped nodes make every shape integral an exact finite sum. Sums are taken in doubles and kept as the exact numbers
that these are.
"""

from __future__ import annotations

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from derive.mechanics.body import Body, MaterialPoint, equations
from derive.mechanics.equations import Coefficient, Equations, ParameterSymbol
from derive.mechanics.mean_frame import to_mean_frame
from derive.mechanics.spatial import AXES, PAIRS, spatial_motion

Array = NDArray[np.float64]

MEAN = {
    "c1": "the choice of O (the centre of mass)",
    "c2": "condition (17) (no mean displacement)",
    "c6": "condition (19) (no mean rotation)",
    "c8": "orthogonality (modes orthonormal in the mass)",
}
"""What the mean frame makes vanish, with the reasons; c8 off its diagonal."""

NOTHING = "the sum over the nodes, which is exactly zero"


def derive_nodal(
    name: str,
    masses: ArrayLike,
    positions: ArrayLike,
    modes: ArrayLike,
    stiffness: ArrayLike,
    markers: dict[str, int] | None = None,
    *,
    mean: bool = False,
) -> Equations:
    """The equations of motion of lumped nodes whose displacements are sums of modes.

    masses (nodes,) in kg; positions (nodes, 3) in m; modes (N, nodes, 3); stiffness (N, N) in N/m, symmetric;
    `markers` names nodes by their number. With `mean` the modes are first brought to the mean frame, where c1, c2 and
    c6 vanish, c8 is the unit matrix and the stiffness is diagonal; the N coordinates then are those of `to_mean_frame`.
    Raises ValueError when a combination of the modes is a rigid motion.
    """
    m, x, phi, k = (np.asarray(a, dtype=np.float64) for a in (masses, positions, modes, stiffness))
    n = len(phi)
    if mean:
        x, phi, k = to_mean_frame(m, x, phi, k)
    values = _integrals(m, np.concatenate([x[None], phi.reshape(n, len(m), 3)]))
    integrals = tuple(
        _in_mean_frame(s, doc, unit) if mean and s.split("_")[0] in MEAN else _coefficient(s, value, doc, unit)
        for s, (value, doc, unit) in values.items()
    )
    entries = ((i, j, float(k[i, j])) for i in range(n) for j in range(i, n))
    elastic = tuple(
        Coefficient(sp.Symbol(f"K_{i + 1}_{j + 1}"), sp.Rational(v), "(13)", "stiffness", "N/m", None if v else NOTHING)
        for i, j, v in entries
    )
    points = tuple(_point(marker, node, x, phi) for marker, node in (markers or {}).items())
    doc = f"body of {len(m)} nodes with {n} modes"
    return equations(
        Body(name, doc, "", spatial_motion(n), sp.Rational(float(m.sum())), integrals, elastic, points, ())
    )


def _coefficient(symbol: str, value: float, doc: str, unit: str) -> Coefficient:
    return Coefficient(sp.Symbol(symbol), sp.Rational(value), "appendix", doc, unit, None if value else NOTHING)


def _in_mean_frame(symbol: str, doc: str, unit: str) -> Coefficient:
    """An integral whose value the mean frame fixes: exactly, where the sum over the nodes is so up to rounding."""
    name, *indices = symbol.split("_")
    value = int(name == "c8" and indices[0] == indices[1])
    return Coefficient(sp.Symbol(symbol), sp.Integer(value), "appendix", doc, unit, None if value else MEAN[name])


def derive_symbolic(name: str, n: int) -> Equations:
    """The equations of motion of a body with n modes whose mass, shape integrals and stiffness are all parameters."""
    symbols: dict[str, tuple[float, str, str]] = {"m": (1.0, "mass of the body", "kg")}
    symbols |= _integrals(np.ones(1), np.zeros((n + 1, 1, 3)))
    pairs = [(i, j) for i in range(1, n + 1) for j in range(i, n + 1)]
    symbols |= {f"K_{i}_{j}": (float(i == j), f"stiffness of modes {i}, {j}", "N/m") for i, j in pairs}
    parameters = {
        s: ParameterSymbol(sp.Symbol(f"{s}_"), doc, unit, _default(s, value), s == "m")
        for s, (value, doc, unit) in symbols.items()
    }
    coefficients = [
        Coefficient(sp.Symbol(s), p.symbol, "appendix", p.doc, p.unit) for s, p in parameters.items() if s != "m"
    ]
    elastic = tuple(c for c in coefficients if str(c.symbol).startswith("K_"))
    integrals = tuple(c for c in coefficients if c not in elastic)
    body = Body(
        name,
        f"body with {n} modes, all shape integrals parameters",
        "",
        spatial_motion(n),
        parameters["m"].symbol,
        integrals,
        elastic,
        (),
        tuple(parameters.values()),
    )
    return equations(body)


def _default(symbol: str, value: float) -> float:
    """A unit ball of inertia with modes that do not couple, so that the defaults make a body."""
    name, *indices = symbol.split("_")
    if name == "C3":
        return float(indices[0][0] == indices[0][1])
    if name == "c8":
        return float(indices[0] == indices[1])
    return value


def _integrals(m: Array, f: Array) -> dict[str, tuple[float, str, str]]:
    """c1 .. c8 of the fields f (field, node, 3), X first, by the names of `spatial`: value, what it is, unit."""
    shapes = range(1, len(f))
    found: dict[str, tuple[float, str, str]] = {}
    for k in AXES:
        found[f"c1_{k}"] = float(m @ f[0, :, k - 1]), f"int rho X . e{k}", "kg m"
    for i in shapes:
        for k in AXES:
            found[f"c2_{i}_{k}"] = float(m @ f[i, :, k - 1]), f"int rho Phi_{i} . e{k}", "kg"
    for a, b in PAIRS:
        found[f"C3_{a}{b}"] = _tensor(m, f[0], f[0], a, b), "int rho ((X . X) I - X X)", "kg m^2"
    for i in shapes:
        for a, b in PAIRS:
            found[f"C4_{i}_{a}{b}"] = _tensor(m, f[i], f[0], a, b), f"symmetric part of C4_{i}", "kg m"
    for i in shapes:
        for j in shapes[i - 1 :]:
            for a, b in PAIRS:
                found[f"C5_{i}_{j}_{a}{b}"] = _tensor(m, f[i], f[j], a, b), f"symmetric part of C5_{i}{j}", "kg"
    for i in shapes:
        for k, value in zip(AXES, m @ np.cross(f[0], f[i]), strict=True):
            found[f"c6_{i}_{k}"] = float(value), f"int rho X x Phi_{i} . e{k}", "kg m"
    for i in shapes:
        for j in shapes[i:]:
            for k, value in zip(AXES, m @ np.cross(f[i], f[j]), strict=True):
                found[f"c7_{i}_{j}_{k}"] = float(value), f"int rho Phi_{i} x Phi_{j} . e{k}", "kg"
    for i in shapes:
        for j in shapes[i - 1 :]:
            found[f"c8_{i}_{j}"] = float(m @ np.sum(f[i] * f[j], axis=1)), f"int rho Phi_{i} . Phi_{j}", "kg"
    return found


def _tensor(m: Array, f: Array, g: Array, a: int, b: int) -> float:
    """Entry ab of int rho {(f . g) I - sym f g}."""
    mixed = (f[:, a - 1] * g[:, b - 1] + f[:, b - 1] * g[:, a - 1]) / 2
    return float(m @ (np.sum(f * g, axis=1) * (a == b) - mixed))


def _point(name: str, node: int, x: Array, phi: Array) -> MaterialPoint:
    def exact(vector: Array) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([sp.Rational(float(value)) for value in vector])

    return MaterialPoint(name, f"node {node}", exact(x[node]), tuple(exact(mode[node]) for mode in phi))
