"""The loads of a scene in reports: forces, torques, springs, and what is distributed over beams and nodes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from derive.report.document.page import Block, Content, folded, table
from derive.report.sections.body_values import SUPERSCRIPTS
from derive.report.sections.instance_rows import merged_rows
from derive.spec.model.beam_parts import Polynomial
from derive.spec.model.beam_pieces import whole_beam
from derive.spec.model.forces import SceneForce
from derive.spec.model.planar_bodies import BeamBody, DistributedLoad
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_beam_parts import SpatialDistributedLoad
from derive.spec.model.spatial_bodies import FlexibleBody, NodalLoad
from derive.spec.model.spatial_forces import SpatialAction, SpatialJointLoad
from derive.spec.model.specification import AnyScene
from derive.spec.parsing.time_text import function_text

ONCE = "1"
"""The factor of a load that does not change."""


def load_blocks(spec: AnyScene) -> tuple[Block, ...]:
    """The table of the loads of a scene; none without loads."""
    rows = [[f.name, _load(f, "force"), _where(f, "")] for f in spec.forces]
    rows += [[t.name, _load(t, "torque"), _where(t, ", against ")] for t in spec.torques]
    rows += [[s.name, _load(s, "spring"), _where(s, " to ")] for s in spec.springs]
    rows += [[load.name, "distributed load", text] for load, text in _distributed(spec)]
    flexible = (body for body in spec.bodies if isinstance(body, FlexibleBody))
    rows += [[load.name, "nodal forces", _nodes(body, load)] for body in flexible for load in body.loads]
    cells: list[list[Content]] = [[load, name, marker] for name, load, marker in merged_rows(rows)]
    return (folded(table("Loads", ("load", "name", "marker"), cells), "Loads"),) if cells else ()


def _where(load: SceneForce | SpatialAction, between: str) -> str:
    """The markers at which a load acts, or its joint."""
    if isinstance(load, SpatialJointLoad):
        return f"joint {load.joint}"
    return between.join(map(str, load.markers))


def _load(load: SceneForce | SpatialAction, noun: str) -> str:
    return noun if load.kind == noun else f"{load.kind} {noun}"


def _distributed(spec: AnyScene) -> Iterator[tuple[DistributedLoad | SpatialDistributedLoad, str]]:
    """The loads of beams, which act on all pieces of a beam, with their texts."""
    for body in spec.bodies:
        if isinstance(body, SpatialBeam) and body.piece_of and body.piece_of.number:
            continue
        if isinstance(body, BeamBody | SpatialBeam):
            name = whole_beam(body).name if isinstance(body, SpatialBeam) else body.name
            for load in body.loads:
                yield load, _per_length(name, load)


def _per_length(beam: str, load: DistributedLoad | SpatialDistributedLoad) -> str:
    """Where a load acts, its components, and its factor."""
    parts = [f"{_components(load.force)} N/m"] if any(load.force) else []
    if isinstance(load, SpatialDistributedLoad) and any(load.torque):
        parts.append(f"{_components(load.torque)} N m/m")
    factor = function_text(load.time) if load.time.kind != "input" else f"the input {load.time.name}"
    times = "" if factor == ONCE else f", times {factor}"
    return f"{beam}, {' and '.join(parts)} in the {load.frame} frame{times}"


def _components(polynomials: Sequence[Polynomial]) -> str:
    return f"[{', '.join(map(_polynomial, polynomials))}]"


def _polynomial(coefficients: Polynomial) -> str:
    """A polynomial as text in a line: 10 ξ² - 10."""
    text = ""
    for power, c in reversed([*enumerate(coefficients)]):
        if c == 0:
            continue
        unknown = "ξ" * (power > 0) + str(power).translate(SUPERSCRIPTS) * (power > 1)
        factor = "" if abs(c) == 1 and power else f"{abs(c)}" if c.denominator == 1 else f"{float(abs(c)):g}"
        sign = (" - " if c < 0 else " + ") if text else "-" * (c < 0)
        text += sign + " ".join(filter(None, (factor, unknown)))
    return text or "0"


def _nodes(body: FlexibleBody, load: NodalLoad) -> str:
    """The nodes on which a load acts, and the sum of its forces without their factor."""
    count = len(load.nodes)
    where = f"node {load.nodes[0]}" if count == 1 else f"{count} nodes"
    total = ", ".join(f"{float(sum((force[k] for force in load.forces), Fraction(0))):g}" for k in range(3))
    return f"{where} of {body.name}, in sum [{total}] N in the {load.frame} frame"
