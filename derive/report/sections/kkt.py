"""The KKT matrix of a mechanism: its pattern, its elimination order and its costs."""

from __future__ import annotations

from derive.ir.model import Kkt, Model
from derive.report.document.page import Block, CodeSpan, Details, Heading, Paragraph, Picture
from derive.report.document.tables import Content, table
from derive.visual.kkt_matrix import kkt_picture

COUNTED = (
    "mass_force",
    "constraints",
    "constraint_jacobian",
    "accel",
    "solve",
    "project_velocity",
    "residual",
    "jacobian",
)
"""Functions whose operations are listed."""

HINT = "The pointer shows the row and the column of an entry."


def kkt_blocks(model: Model, kkt: Kkt) -> tuple[Block, ...]:
    """The matrix in its elimination order, its structure and the operations of the functions that use it."""
    names = (*(row.name for row in model.equations), *(m.name for m in model.multipliers))
    text = (
        "Accelerations and multipliers come from [M, -Gᵀ; -G, 0] by a factorisation L D Lᵀ whose elimination order is "
        "fixed at generation: minimum degree, with each multiplier eliminated after its coordinates, so that no pivot "
        "vanishes while the constraints are independent. The picture shows the lower triangle in that order."
    )
    jacobian = model.pattern("constraint_jacobian", "G")
    rows: list[list[Content]] = [
        ["size", str(kkt.pattern.rows)],
        ["non-zeros of M", str(model.pattern("mass", "M").full_nnz)],
        ["non-zeros of G", str(len(jacobian.rowidx))],
        ["non-zeros of the KKT matrix, both triangles", str(kkt.pattern.full_nnz)],
        ["fill-in, one triangle", str(kkt.fill)],
    ]
    costs: list[list[Content]] = [[CodeSpan(name), str(model.kernel(name).operations)] for name in COUNTED]
    order = ", ".join(names[k] for k in kkt.order)
    return (
        Heading("The KKT matrix", "kkt"),
        Paragraph((text,)),
        Picture(
            kkt_picture(kkt, names),
            f"Pattern of the KKT matrix of {kkt.pattern.rows} rows in its elimination order",
            "",
            HINT,
        ),
        table("Structure", ("quantity", "count"), rows, "lr"),
        table("Operations", ("function", "operations"), costs, "lr"),
        Details("The elimination order", (Paragraph((order,)),)),
    )
