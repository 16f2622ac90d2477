"""Lanes as C: the four rows of a block, or the four terms of a sum that are added apart, in vector registers.

A loop over the lanes takes as many at a time as a register of the target has. gcc and clang get vectors explicitly,
since they do not make any of such loops by themselves at all levels; for other compilers a vector is a number. Lanes do
not mix, so that the bits are the same in every way.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import assert_never

from derive.backends.expression_text import C, Named, element, strided, text
from derive.backends.source_map import SourceLine, defining, plain
from derive.backends.wrapping import BreakableText, join, statement
from derive.ir.expressions import ArrayAccess, Expr, MatrixEntry, Operation, Operator, ScalarRef, TableValue, walk
from derive.ir.statements import LANES, Let

Lines = list[SourceLine]

LANES_MACRO = """\
/* Lanes are computed TISSERAND_WIDTH at a time: in the vectors of gcc and clang, else, and with -DTISSERAND_NO_VECTORS,
   one by one. All widths give the same bits. gcc does not align the stack for vectors of 32 bytes on Windows. */
#ifndef TISSERAND_WIDTH
#  if !defined(__GNUC__) || defined(TISSERAND_NO_VECTORS)
#    define TISSERAND_WIDTH 1
#  elif defined(__AVX__) && (defined(__clang__) || !defined(_WIN32))
#    define TISSERAND_WIDTH 4
#  elif defined(__SSE2__) || defined(__aarch64__)
#    define TISSERAND_WIDTH 2
#  else
#    define TISSERAND_WIDTH 1
#  endif
#  if TISSERAND_WIDTH > 1
typedef double tisserand_lanes __attribute__((vector_size(8 * TISSERAND_WIDTH)));
typedef double tisserand_loose __attribute__((vector_size(8 * TISSERAND_WIDTH), aligned(8), may_alias));
#  else
typedef double tisserand_lanes, tisserand_loose;
#  endif
#  define TISSERAND_LOAD(address) (*(const tisserand_loose *) (address))
#  define TISSERAND_STORE(address, value) (*(tisserand_loose *) (address) = (value))
/* Lanes to elements at a distance. */
#  if TISSERAND_WIDTH == 4
#    define TISSERAND_SCATTER(address, stride, value) do { \\
         const tisserand_lanes lanes_ = (value); \\
         double *to_ = (address); \\
         to_[0] = lanes_[0], to_[stride] = lanes_[1], to_[2 * (stride)] = lanes_[2], to_[3 * (stride)] = lanes_[3]; \\
     } while (0)
#  elif TISSERAND_WIDTH == 2
#    define TISSERAND_SCATTER(address, stride, value) do { \\
         const tisserand_lanes lanes_ = (value); \\
         double *to_ = (address); \\
         to_[0] = lanes_[0], to_[stride] = lanes_[1]; \\
     } while (0)
#  else
#    define TISSERAND_SCATTER(address, stride, value) (*(address) = (value))
#  endif
#endif

/* Before a short loop: gcc would unroll it first, and then not make vectors of it. */
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 8
#  define TISSERAND_SHORT _Pragma("GCC unroll 1")
#else
#  define TISSERAND_SHORT
#endif
"""

SHORT = 16
"""Iterations that gcc unrolls completely before it makes vectors."""

ARITHMETIC = frozenset({Operator.ADD, Operator.SUB, Operator.MUL, Operator.DIV, Operator.NEG})
"""The operators that vectors have."""


def over_lanes(body: Iterable[SourceLine], lanes: int = LANES) -> Lines:
    """A loop over the lanes l; fewer than four where no row has more."""
    return [*plain(f"for (int l = 0; l < {lanes}; l += TISSERAND_WIDTH) {{"), *indented(body), *plain("}")]


def load(address: str | BreakableText) -> BreakableText:
    """Lanes from an address on."""
    return join("TISSERAND_LOAD(", address, ")")


def store(address: str | BreakableText, value: str | BreakableText) -> list[str]:
    """The statement that stores lanes from an address on."""
    return statement("", "", join("TISSERAND_STORE(", address, ", ", value, ")"), ";")


def scatter(output: str, offset: int, stride: int, value: BreakableText) -> list[str]:
    """The statement that stores lanes of rows i + l in elements offset + stride (i + l) of an output."""
    address = join(f"{output} + ", f"{offset} + " if offset else "", strided(0, stride, BreakableText(("i", " + l"))))
    if stride == 1:
        return store(address, value)
    return statement("", "", join("TISSERAND_SCATTER(", address, f", {stride}, ", value, ")"), ";")


def in_lanes(leaf: Named) -> BreakableText:
    """A leaf in rows i + l, or in row i + l and column j of a matrix; what is the same in all lanes is a number."""
    match leaf:
        case ScalarRef():
            return element(leaf)
        case MatrixEntry():
            return load(f"{leaf.table}_j + l")
        case ArrayAccess():
            if leaf.index == "j":
                return element(leaf, BreakableText(("j",)))
            return load(join(f"{leaf.array} + ", strided(leaf.offset, 1, BreakableText(("i", " + l")))))
        case _:
            assert_never(leaf)


def has_lanes(expr: Expr, names: Collection[str] = ()) -> bool:
    """Whether the value of an expression differs from lane to lane; `names` are the scalars that do."""
    for part in walk(expr):
        match part:
            case ScalarRef(name) if name in names:
                return True
            case MatrixEntry() | ArrayAccess(index="i"):
                return True
    return False


def fits_vectors(expr: Expr) -> bool:
    """Whether vectors have all operations of an expression, and its arrays are read element after element."""
    for part in walk(expr):
        match part:
            case Operation():
                fits = part.kind in ARITHMETIC
            case ArrayAccess():
                fits = part.stride == 1
            case _:
                fits = not isinstance(part, TableValue)
        if not fits:
            return False
    return True


def lane_let(let: Let, names: set[str]) -> Lines:
    """A value, which is a vector if it differs from lane to lane; then its name is added to `names`, which do."""
    kind = "double"
    if has_lanes(let.expr, names):
        kind = "tisserand_lanes"
        names.add(let.name)
    return defining(statement("", f"const {kind} {let.name} = ", text(let.expr, C, in_lanes), ";"), let.name)


def loop_head(index: str, stop: int, start: int = 0, body: str = "{", short: bool = True) -> str:
    """The head of a loop; see LANES_MACRO for the pragma before a short loop."""
    pragma = "TISSERAND_SHORT " if short and 1 < stop - start <= SHORT else ""
    return f"{pragma}for (int {index} = {start}; {index} < {stop}; {index}++) {body}".rstrip()


def indented(lines: Iterable[SourceLine]) -> Lines:
    """Lines, one step further to the right."""
    return [line.indented() for line in lines]
