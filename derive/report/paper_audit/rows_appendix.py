"""The lines of the appendix, in the order of their names."""

from __future__ import annotations

from functools import partial

from derive.report.paper_audit import derived_space as derived
from derive.report.paper_audit.model import AuditRow, AuditSection, Derived, tests

FILE = "test_appendix.py"
NOTATION = "The text has lost the arrows over the vectors; nothing else."
NODES = "Compared with what the reduction of a body of nodes gives, exactly."
SYMMETRIC = "The derivation holds the symmetric part here, the other one is {}."

INTEGRALS = (
    ("c1", "First moment of X", "c_1 = int_Omega rho X dOmega", ""),
    ("c2", "First moments of the fields", "c_2 = int_Omega rho Phi dOmega", ""),
    ("C3", "Inertia of the undeformed body", "C_3 = int_Omega rho {(X . X) I - X X} dOmega", ""),
    ("C4", "Fields and X", "C_4 = int_Omega rho {(Phi . X) I - Phi X} dOmega", SYMMETRIC.format("$c_6$")),
    ("C5", "Fields and fields", "C_5 = int_Omega rho {(Phi . Phi^T) I - Phi Phi^T} dOmega", SYMMETRIC.format("$c_7$")),
    ("c6", "Moment of the fields about O", "c_6 = int_Omega rho {X >< Phi} dOmega", ""),
    ("c7", "Moment of fields about fields", "c_7 = int_Omega rho {Phi >< Phi^T} dOmega", ""),
    ("c8", "Mass of the fields", "c_8 = int_Omega rho {Phi . Phi^T} dOmega", ""),
)


def _series(*names: str) -> Derived:
    return lambda: tuple(map(derived.series, names))


def _rows() -> tuple[AuditRow, ...]:
    return tuple(
        AuditRow(
            number,
            title,
            (shown,),
            derived=partial(derived.integral, number),
            note=" ".join(part for part in (NOTATION, NODES, more) if part),
            tests=tests(FILE, f"test_{number}"),
        )
        for number, title, shown, more in INTEGRALS
    )


COMPOSED = (
    AuditRow(
        "J",
        "Inertia of the deformed body",
        ("J = C_3 + alpha^T (C_4 + C_4^c) + alpha^T C_5 alpha",),
        derived=_series("J", "S_i"),
        misread=(
            ("C_4^c", "C_5"),
            ("alpha^T C_5 alpha", "alpha^T C_8 alpha"),
        ),
        correction="What the text shows as $C_5$ and $C_8$ is the conjugate of $C_4$, and $C_5$.",
        note="As derived with the symmetric parts of $C_4$ and of $D_2$, which is $S$. It is also the sum over the "
        "nodes in their deformed places.",
        tests=tests(FILE, "test_J"),
    ),
    AuditRow(
        "d1",
        "First moment of X + u",
        ("d_1 = c_1 + alpha^T c_2",),
        derived=_series("d1"),
        note=NOTATION,
        tests=tests(FILE, "test_d1"),
    ),
    AuditRow(
        "D2",
        "Fields and X + u",
        ("D_2 = C_4 + C_5 alpha",),
        derived=_series("S_i", "d3_i"),
        note="As derived in two parts: the symmetric one, $S$, and $d_3$: $D_2 . v = S . v - 1/2 d_3 >< v$.",
        tests=tests(FILE, "test_D2"),
    ),
    AuditRow(
        "d3",
        "Moment of the fields about X + u",
        ("d_3 = c_6 - c_7 alpha",),
        derived=_series("d3_i"),
        note=f"{NOTATION} $c_7$ is odd in its two indices.",
        tests=tests(FILE, "test_d3"),
    ),
)

SECTIONS = (AuditSection("Appendix", "appendix", (*_rows(), *COMPOSED)),)
