"""Tables of matrices of factors, of which half is read if they are symmetric or antisymmetric, and offsets once."""

from __future__ import annotations

from fractions import Fraction

from derive.ir.symmetric_tables import MatrixKind, MatrixRow, SymmetricTable, matrices


def fractions(*row: int) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, row))


def test_half_of_a_symmetric_matrix_of_factors_is_read() -> None:
    """Matrices whose entries differ across the diagonal for one instance stay rows of a table."""
    rows = [fractions(*row) for row in ((1, 2, 3, 4, 5, 6), (7, 8, 5, 6, 9, 10)) for _ in range(3)]
    ((kind, found),) = matrices(rows, 2, 2, True)
    assert (kind, len(found)) == (MatrixKind(2, 2, True), 3)
    table = SymmetricTable("c", kind)
    assert table.place([rows[0::3]]) == 0
    assert table.array.values == fractions(1, 2, 7, 8, 3, 4, 5, 6, 9, 10)
    rows[4] = fractions(7, 8, 5, 7, 9, 10)
    assert not [*matrices(rows, 2, 2, True)]


def test_constant_terms_that_are_factors_of_a_row_are_read_once() -> None:
    """J has the factors C4, which are the constant terms of S; without one of the rows, each table has its own."""
    rows = [fractions(k, *row) for row in ((3, 5), (5, 9)) for k in (1, 2, 4)]
    offsets = [fractions(20 + k, k, k) for k in (1, 2, 4)]
    ((kind, found),) = matrices([*rows, *offsets], 2, 1, True)
    assert kind == MatrixKind(2, 1, True, has_row_of_offsets=True)
    assert found[1] == [MatrixRow(1), MatrixRow(4), MatrixRow(7)]
    table = SymmetricTable("c", kind)
    table.place([[rows[1], rows[4], offsets[1]]])
    assert table.array.values == fractions(2, 2, 22, 3, 5, 9)
    ((without, _),) = matrices([*rows, *offsets[:2]], 2, 1, True)
    assert not without.has_row_of_offsets
    alike = [fractions(2 if row[0] == 1 else int(row[0]), *map(int, row[1:])) for row in rows]
    ((without, _),) = matrices([*alike, *offsets], 2, 1, True)  # two with the constant terms 2, 2
    assert not without.has_row_of_offsets


def test_half_of_an_antisymmetric_matrix_of_factors_is_read() -> None:
    """Rows may come in any order and with any signs; one entry that is not opposite leaves too few matrices."""
    of_three = [[fractions(0, k, 2 * k), fractions(-k, 0, 3 * k), fractions(-2 * k, -3 * k, 0)] for k in (1, 4, 9)]
    rows = [row for matrix in reversed(of_three) for row in reversed(matrix)]
    rows[4] = tuple(-value for value in rows[4])
    ((kind, found),) = matrices(rows, 3, 1, False)
    assert kind == MatrixKind(3, 1, False, is_antisymmetric=True)
    assert found[1] == [MatrixRow(5), MatrixRow(4, True), MatrixRow(3)]
    table = SymmetricTable("c", kind)
    table.place(of_three)
    assert table.array.values == fractions(-1, -2, -3, -4, -8, -12, -9, -18, -27)
    rows[3] = fractions(-8, -11, 0)
    assert not [*matrices(rows, 3, 1, False)]
