"""The appendix against the shape integrals of nodes, and against the moments that the derivation composes of them."""

from __future__ import annotations

from functools import cache

import numpy as np
import sympy as sp
from scipy.sparse import csr_array, diags_array

from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.expanded_sums import expanded_moments
from derive.mechanics.motion.spatial import PAIRS, spatial_motion
from derive.reduction import reduce
from derive.spec.model.body import BodyFrame, Damping, NodalBody
from derive.spec.model.node_data import NodeData
from paper import printed_appendix as appendix
from paper.printed_appendix import Cloud
from plain_symbols import plain

MASSES = np.array([1, 2, 3, 1, 2, 5])
X = np.array([[1, 0, 2], [-1, 3, 1], [2, -2, 0], [0, 1, -4], [3, 1, 1], [-2, -1, 3]])
SHAPES = np.array(
    [
        [[1, 2, 0], [0, -1, 3], [2, 2, 1], [-3, 0, 1], [1, 1, -2], [0, 4, 1]],
        [[0, 1, 1], [2, 0, -1], [-1, 3, 2], [1, -2, 0], [4, 1, 1], [-1, 1, -3]],
    ]
)
"""Whole numbers, so that doubles hold all sums exactly."""

ALPHA = sp.symbols("alpha1:3")
INDICES = (0, 1)


def cloud() -> Cloud:
    def vectors(rows: np.ndarray) -> tuple[sp.Matrix, ...]:
        return tuple(sp.Matrix([int(x) for x in row]) for row in rows)

    return Cloud(tuple(map(sp.Integer, MASSES.tolist())), vectors(X), tuple(map(vectors, SHAPES)))


@cache
def reduced() -> ModalBody:
    mass = csr_array(diags_array(MASSES.astype(float)))
    data = NodeData(X.astype(float), mass, None, SHAPES.astype(float), np.eye(2), "")
    body = NodalBody("cloud", data, None, BodyFrame("given"), False, Damping(), None, (), "flat")
    return reduce(body)


def same(found: np.ndarray, expected: sp.Matrix | sp.Expr) -> bool:
    entries = list(expected) if isinstance(expected, sp.MatrixBase) else [expected]
    return [sp.Rational(float(x)) for x in np.ravel(found)] == entries and any(entries)


def test_c1() -> None:
    assert same(reduced().c1, appendix.appendix_c1(cloud()))


def test_c2() -> None:
    assert all(same(reduced().c2[i], appendix.appendix_c2(cloud(), i)) for i in INDICES)


def test_C3() -> None:
    assert same(reduced().C3, appendix.appendix_C3(cloud()))


def test_C4() -> None:
    assert all(same(reduced().C4[i], appendix.appendix_C4(cloud(), i)) for i in INDICES)


def test_C5() -> None:
    assert all(same(reduced().C5[i, j], appendix.appendix_C5(cloud(), i, j)) for i in INDICES for j in INDICES)


def test_c6() -> None:
    assert all(same(reduced().c6[i], appendix.appendix_c6(cloud(), i)) for i in INDICES)


def test_c7() -> None:
    """Odd in i and j: zero on the diagonal."""
    assert all(same(reduced().c7[i, j], appendix.appendix_c7(cloud(), i, j)) for i, j in ((0, 1), (1, 0)))
    assert not any(any(appendix.appendix_c7(cloud(), i, i)) or np.any(reduced().c7[i, i]) for i in INDICES)


def test_c8() -> None:
    assert all(same(reduced().c8[i, j], appendix.appendix_c8(cloud(), i, j)) for i in INDICES for j in INDICES)


# d1, D2, d3 and J: by the appendix, by the derivation, and by r = X + sum alpha_i Phi_i at each point.


def deformed() -> Cloud:
    """r in the place of X."""
    at = cloud()
    places = tuple(x + sum((a * f[p] for a, f in zip(ALPHA, at.shapes, strict=True)), sp.zeros(3, 1))
                   for p, x in enumerate(at.X))  # fmt: skip
    return Cloud(at.masses, places, at.shapes)


@cache
def composed() -> dict[str, sp.Expr]:
    """The definitions of the derivation with the integrals of the cloud, by the appendix."""
    at = cloud()
    values: dict[str, sp.Expr] = {}

    def symmetric(name: str, tensor: sp.Matrix) -> None:
        values.update({f"{name}_{a}{b}": (tensor + tensor.T)[a - 1, b - 1] / 2 for a, b in PAIRS})

    def vector(name: str, entries: sp.Matrix) -> None:
        values.update({f"{name}_{k + 1}": entries[k] for k in range(3)})

    vector("c1", appendix.appendix_c1(at))
    symmetric("C3", appendix.appendix_C3(at))
    for i in INDICES:
        vector(f"c2_{i + 1}", appendix.appendix_c2(at, i))
        vector(f"c6_{i + 1}", appendix.appendix_c6(at, i))
        symmetric(f"C4_{i + 1}", appendix.appendix_C4(at, i))
        for j in INDICES:
            symmetric(f"C5_{i + 1}_{j + 1}", appendix.appendix_C5(at, i, j))
            vector(f"c7_{i + 1}_{j + 1}", appendix.appendix_c7(at, i, j))
    known = {sp.Symbol(name): value for name, value in values.items()}
    for definition in expanded_moments(spatial_motion(2))[0]:
        known[plain(definition.symbol)] = sp.expand(plain(definition.expr).xreplace(known))
    return {symbol.name: value for symbol, value in known.items()}


def found(name: str) -> sp.Matrix:
    return sp.Matrix([composed()[f"{name}_{k}"] for k in (1, 2, 3)])


def found_tensor(name: str) -> sp.Matrix:
    return sp.Matrix(3, 3, lambda a, b: composed()["{}_{}{}".format(name, *sorted((a + 1, b + 1)))])


def agree(*matrices: sp.Matrix) -> bool:
    first, *others = (matrix.expand() for matrix in matrices)
    return all(first == other for other in others) and not first.is_zero_matrix


def test_d1() -> None:
    at = cloud()
    stated = appendix.appendix_d1(appendix.appendix_c1(at), [appendix.appendix_c2(at, i) for i in INDICES], ALPHA)
    assert agree(found("d1"), stated, appendix.appendix_c1(deformed()))


def test_D2() -> None:
    """The derivation holds the symmetric part of D2_i as S_i, and the antisymmetric one as d3_i."""
    at = cloud()
    for i in INDICES:
        C5 = [appendix.appendix_C5(at, i, j) for j in INDICES]
        stated = appendix.appendix_D2(appendix.appendix_C4(at, i), C5, ALPHA)
        x, y, z = found(f"d3_{i + 1}")
        composed_of_both = found_tensor(f"S_{i + 1}") - sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]]) / 2
        assert agree(composed_of_both, stated, appendix.appendix_C4(deformed(), i))


def test_d3() -> None:
    at = cloud()
    for i in INDICES:
        c7 = [appendix.appendix_c7(at, i, j) for j in INDICES]
        stated = appendix.appendix_d3(appendix.appendix_c6(at, i), c7, ALPHA)
        assert agree(found(f"d3_{i + 1}"), stated, appendix.appendix_c6(deformed(), i))


def test_J() -> None:
    at = cloud()
    C4 = [appendix.appendix_C4(at, i) for i in INDICES]
    C5 = [[appendix.appendix_C5(at, i, j) for j in INDICES] for i in INDICES]
    stated = appendix.appendix_J(appendix.appendix_C3(at), C4, C5, ALPHA)
    assert agree(found_tensor("J"), stated, appendix.appendix_C3(deformed()))
