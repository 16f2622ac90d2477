"""A report that uses everything a page can hold, with text that would like to be markup."""

from __future__ import annotations

from derive.report.document.formula import (
    Call,
    Equation,
    Fenced,
    Formula,
    FormulaRow,
    Matrix,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
    Root,
)
from derive.report.document.page import (
    Cell,
    CodeLine,
    CodeSpan,
    Columns,
    Details,
    EquationBlock,
    Heading,
    Hyperlink,
    Listing,
    Math,
    Page,
    Paragraph,
    Picture,
    Strong,
    TableBlock,
)

EVIL = "</style><script>alert(1)</script> & \" ' <!-- \\end{document} #set $x$ `q` | _a_ *b* 100% {c} ~ ^ ] [x](y) @z"
M, PHI = Name("m"), Name("phi")
TWO, THREE = NumberToken("2"), NumberToken("3")
PHI1, PHI2 = Name("phi", dots=1), Name("phi", dots=2)
RHO = Name("rho")
PLUS, MINUS, DOT, CROSS, EQUALS, INTEGRAL, DELTA = (OperatorToken(c) for c in "+-·\u00d7=∫δ")


def alpha(i: int, dots: int = 0) -> Name:
    return Name("alpha", dots=dots, below=(str(i),))


def row(*parts: Formula) -> FormulaRow:
    return FormulaRow(parts)


def square(base: Formula) -> Power:
    return Power(base, TWO)


def turning(n: int) -> Equation:
    """The row of phi of a beam with n shapes in a frame of a point."""
    c1, c2 = Name("c", 2, ("1",)), Name("c", 2, ("2",))
    parts = [
        Part(
            "+",
            row(Quotient(row(M, square(Name("l"))), NumberToken("12")), PHI2),
            "phi-1",
            "accelerations",
            "J, of X. (15)",
            "#line-12",
        ),
        Part(
            "-",
            row(Quotient(M, THREE), alpha(1), c1, Call("cos", PHI)),
            "phi-2",
            "accelerations",
            "d1 \u00d7 c, from (15)",
        ),
        Part(
            "-",
            row(Quotient(M, THREE), alpha(1), c2, Call("sin", PHI)),
            "phi-3",
            "accelerations",
            "d1 \u00d7 c, from (15)",
        ),
    ]
    for i in range(1, n + 1):
        over = Quotient(M, NumberToken(str(2 * i + 3)))
        parts += [
            Part("+", row(over, square(alpha(i)), PHI2), f"phi-a{i}", "accelerations", f"J, of Phi_{i}. (15)"),
            Part("+", row(Quotient(row(M, Name("l")), NumberToken("10")), alpha(i, 2)), f"phi-b{i}", "accelerations"),
        ]
    parts += [
        Part(
            "+",
            row(Quotient(row(TWO, M), NumberToken(str(2 * i + 3))), alpha(i), alpha(i, 1), PHI1),
            f"phi-c{i}",
            "rates",
            "Coriolis",
        )
        for i in range(1, n + 1)
    ]
    return Equation(row(DELTA, PHI), tuple(parts), ":", "33", "row-phi")


def deforming(i: int) -> Equation:
    over = Quotient(M, NumberToken(str(2 * i + 3)))
    elastic = row(Quotient(row(NumberToken("64"), Name("EI")), Power(Name("l"), THREE)), alpha(i))
    return Equation(
        row(DELTA, alpha(i)),
        (
            Part("+", row(over, alpha(i, 2)), f"a{i}-1", "accelerations", "C5"),
            Part("-", row(over, square(PHI1), alpha(i)), f"a{i}-2", "rates", "centrifugal force"),
            Part("+", elastic, f"a{i}-3", "elastic", "bending stiffness"),
        ),
        ":",
        "33",
        f"row-alpha{i}",
    )


VECTOR = Equation(
    row(OperatorToken("δ"), Name("c", style="vector"), DOT),
    (
        Part("+", row(M, Name("c", 2, style="vector")), "c-1", "accelerations", "inertia of the mass", "#line-14"),
        Part("+", row(Name("omega", 1, style="vector"), CROSS, Name("d", below=("1",), style="vector")), "c-2"),
        Part(
            "+",
            row(
                Name("omega", style="vector"),
                CROSS,
                Fenced(row(Name("omega", style="vector"), CROSS, Name("d", below=("1",), style="vector"))),
            ),
            "c-3",
        ),
        Part("+", row(TWO, Name("omega", style="vector"), CROSS, Name("d", 1, ("1",), style="vector")), "c-4"),
        Part("-", row(Name("F", style="vector"), PLUS, Name("G", style="vector"))),
    ),
    number="15",
    anchor="eq-15",
)

INTEGRALS = Equation(
    Name("C", below=("i", "j"), above=("5",), style="tensor"),
    (
        Part(
            "+",
            row(
                Name("∫", below=("V",)),
                RHO,
                Fenced(
                    row(
                        Fenced(
                            row(
                                Name("Phi", below=("i",), style="vector"),
                                DOT,
                                Name("Phi", below=("j",), style="vector"),
                            )
                        ),
                        Name("I", style="tensor"),
                        MINUS,
                        Name("Phi", below=("i",), style="vector"),
                        Name("Phi", below=("j",), style="vector"),
                    ),
                    "{",
                    "}",
                ),
                OperatorToken("d"),
                Name("V"),
            ),
        ),
    ),
    anchor="c5",
)

EVERYTHING = row(
    NumberToken("-1"), NumberToken("2"), Name("∑", below=("i=1",), above=("N",)),
    Root(row(Name("xi"), PLUS, NumberToken("1.5e-05"))),
    Fenced(Quotient(Name("gamma"), Name("mu", below=("10", "2"))), "[", "]"), Power(Quotient(TWO, THREE), Name("n")),
    square(Call("cos", PHI)), Call("sin", row(TWO, PHI)), Name("max", style="word"), Name("Omega"), Name("lambda", 3),
    square(Name("x", below=("max",), above=("T",))), Name("<b>&\"$#_{\\"), Fenced(Name("a"), "|", "|"),
)  # fmt: skip

MASS = Equation(
    Name("M", style="tensor"),
    (
        Part(
            "+",
            Matrix(
                tuple(
                    tuple(
                        row(Quotient(M, NumberToken(str(i + j + 2))), Call("cos", PHI)) if abs(i - j) < 2 else None
                        for j in range(9)
                    )
                    for i in range(9)
                )
            ),
        ),
    ),
    anchor="mass",
)

SVG = """<?xml version="1.0"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
     viewBox="0 0 200 100" width="300" role="img">
  <title>old</title>
  <style>text { font: 13px system-ui, sans-serif; fill: #1c2733; } .value, .other { fill: #1f6f8b; }
    @media (prefers-color-scheme: dark) { text { fill: #e6edf3; } .value { fill: #5fb6d4; } }</style>
  <defs><clipPath id="clip"><rect width="200" height="100"/></clipPath><circle id="dot" r="3"/></defs>
  <g clip-path="url(#clip)"><rect class="value" x="10" y="10" width="60" height="60">
    <title>m, of (15)</title></rect></g>
  <use xlink:href="#dot" x="100" y="40"/><text x="100" y="80">c1 &lt; c2</text>
</svg>"""

CODE = """\
/* M (15): factors of the accelerations,
 * with a < b && c */
int free_beam_mass(const double *TISSERAND_RESTRICT q, const double *TISSERAND_RESTRICT k, double *TISSERAND_RESTRICT M)
{
    const double alpha1 = q[3]; // the first

    M[0] = mass;  /* mass */""".splitlines()

LINES = tuple(
    CodeLine(
        10 + k + (20 if k > 5 else 0), text, f"line-{10 + k}", (Hyperlink("(33) φ", "#phi-1"),) if k in (2, 6) else ()
    )
    for k, text in enumerate(CODE)
)


def table(wide: bool = False) -> TableBlock:
    head = (("row",), ("value of ", Math(row(M, square(Name("l"))))), ("counted",), ("why",))
    wider = tuple((f"column {k}",) for k in range(12)) if wide else ()
    rows = (
        (Cell(("c1",)), Cell((Math(Quotient(M, NumberToken("12"))),), "J", "entry"), Cell(("12",)), Cell((EVIL,))),
        (Cell(("phi",)), Cell(("0",), "the first moment vanishes: (17)", "zero"), Cell(("7",)), Cell(("none",))),
        (Cell(("alpha",)), Cell(("equal",), mark="good"), Cell(("1234",)), Cell(("after a correction",), mark="bad")),
    )
    filled = tuple(one + tuple(Cell((f"{k} and more",)) for k in range(len(wider))) for one in rows)
    return TableBlock("The integrals of a shape, with their values", head + wider, filled, "lrr", wide)


def page(n: int = 3) -> Page:
    """Every kind of block, and n shapes."""
    rows = (turning(n), *(deforming(i) for i in range(1, n + 1)))
    return Page(
        "The free beam in the mean frame",
        ("Equations of motion, with the reasons of their zeros and the code that computes them",),
        (
            Heading("Kinematics", "kinematics"),
            Paragraph(
                (
                    "A body that moves far and turns a lot has a frame, whose origin is at ",
                    Math(Name("c", style="vector")),
                    " and which turns by ",
                    Math(PHI),
                    ". The position of a material point is measured from there: ",
                    Math(
                        row(
                            Name("r", style="vector"),
                            EQUALS,
                            Name("X", style="vector"),
                            PLUS,
                            Name("∑", below=("i",)),
                            alpha(1),
                        )
                    ),
                    ", with the rate ",
                    Math(row(Name("omega", 1, style="vector"), CROSS, Name("r", style="vector"))),
                    ". See ",
                    Hyperlink("the rows", "#row-phi"),
                    ", ",
                    Hyperlink("the paper", "https://example.org/?a=1&b=2"),
                    " and ",
                    CodeSpan("mass[0] < 1"),
                    ". ",
                    Strong("Nothing is left out."),
                    " ",
                    EVIL,
                )
            ),
            EquationBlock((VECTOR,)),
            Heading("Shape integrals", "integrals", 3),
            EquationBlock((INTEGRALS, Equation(Name("e"), (Part("+", EVERYTHING, "all"),), "≈", anchor="everything"))),
            EquationBlock((MASS,)),
            table(),
            Heading("Equations of motion", "motion"),
            Paragraph(("The coefficients of the virtual displacements, each of which is zero.",)),
            EquationBlock(rows),
            Picture(SVG, "A square & a dot", "The pattern of the mass matrix"),
            Picture(SVG, "The same again", ""),
            Columns(
                (
                    (Heading("In the point frame", "point", 3), table()),
                    (Heading("In the mean frame", "mean", 3), EquationBlock((deforming(9),))),
                )
            ),
            table(wide=True),
            Heading("Code", "code"),
            Listing("c", "free_beam_mean.c", LINES),
            Details(
                "The specification",
                (Paragraph(("What was given:",)), Listing("toml", "", (CodeLine(1, 'name = "a#b" # <b>'),))),
            ),
        ),
    )
