"""The centrifugal terms of rotations in space as omega x (J omega + d3dot), where that takes fewer products.

The equations have them as products of the moments of inertia and of the angular velocity, J_ab oo_cd: 18 terms for a
full J, of which a diagonal one leaves 6. The components of J omega take 9 products, and omega x 6 more.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import Family, identity


def force_rows(equations: Equations) -> tuple[sp.Expr, ...]:
    """The rows of h."""
    result = [*equations.force]
    spins: dict[str, list[int]] = {}
    for k, row in enumerate(equations.rows):
        if identity(row.v).family is Family.ANGULAR_VELOCITY:
            spins.setdefault(identity(row.v).owner, []).append(k)
    for owner, rows in spins.items():
        if len(rows) == len(AXES):
            changed = _changed(equations, owner, rows)
            for k, force in zip(rows, changed, strict=True):
                result[k] = force
    return tuple(result)


def _changed(equations: Equations, owner: str, rows: Sequence[int]) -> list[sp.Expr]:
    """The rows of the rotation of a body, unchanged if they have other terms with J or if that takes no more."""
    known = {
        (of.family, of.derivative, of.components): d.symbol
        for d in equations.definitions
        if not d.zero and (of := identity(d.symbol)).owner == owner and not of.shapes
    }
    omega = [equations.rows[k].v for k in rows]

    def product_of(a: int, b: int) -> sp.Expr:
        """The product of two components of the angular velocity, as the equations have it."""
        symbol = known.get((Family.OMEGA_PRODUCT, 0, tuple(sorted((a, b)))))
        return omega[a - 1] * omega[b - 1] if symbol is None else symbol

    J = {(a, b): known.get((Family.INERTIA, 0, tuple(sorted((a, b)))), sp.S.Zero) for a, b in product(AXES, AXES)}
    moved = {a: known.get((Family.D3, 1, (a,)), sp.S.Zero) for a in AXES}
    momentum = {a: sp.Add(*(J[a, b] * omega[b - 1] for b in AXES), moved[a]) for a in AXES}
    before, own = 0, {*J.values(), *moved.values()}
    result = []
    for k, (a, b) in zip(rows, ((2, 3), (3, 1), (1, 2)), strict=True):
        of_inertia = sp.Add(*(J[b, c] * product_of(a, c) - J[a, c] * product_of(b, c) for c in AXES))
        written = of_inertia + omega[a - 1] * moved[b] - omega[b - 1] * moved[a]
        rest = equations.force[k] - written
        if rest.free_symbols & own:
            return [equations.force[k] for k in rows]
        before += len(sp.Add.make_args(written))
        result.append(rest + omega[a - 1] * momentum[b] - omega[b - 1] * momentum[a])
    after = 2 * len(AXES) + sum(len(sp.Add.make_args(of)) for of in momentum.values() if of != 0)
    return result if after < before else [equations.force[k] for k in rows]
