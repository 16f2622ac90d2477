"""The page of a body: from its specification to its equations of motion, its code, and how to call it."""

from __future__ import annotations

from dataclasses import dataclass

from derive.emit.files import File
from derive.kernel.model import Model, Variable
from derive.mechanics.equations import Equations
from derive.mechanics.generic import GenericEquations
from derive.pipeline import Built
from derive.report.body_frame_section import body_frame_blocks
from derive.report.calling_section import calling_blocks, listing
from derive.report.code_section import code_blocks, targets
from derive.report.frame_section import frame_blocks, paper_numbers
from derive.report.frames_section import frames_blocks, variants
from derive.report.integrals_section import definition_anchor, integral_blocks, moment_blocks
from derive.report.kinematics_section import kinematics_blocks
from derive.report.manifest_section import manifest_blocks
from derive.report.matrix_picture import mass_matrix
from derive.report.names import known
from derive.report.notation import Notation, notation
from derive.report.operations_section import operation_blocks
from derive.report.page import Block, Code, Details, Heading, Page, Paragraph
from derive.report.places import array, definition_lines, places
from derive.report.source import sources
from derive.report.tables import Said, folded, table
from derive.report.terms import row_blocks
from derive.report.zeros_section import mass_blocks, vanished_blocks
from derive.spec.body import NodalBody, PlanarBeam, SymbolicBody
from derive.spec.scene import Scene

LONG = 60
"""Lines of a specification that are shown at once."""


@dataclass(frozen=True)
class Text:
    """The specification as it was written: the name of its file, and its lines."""

    name: str
    text: str


def model_page(built: Built, specification: Text) -> Page:
    """The report of a body. Raises TypeError for a scene, which has a page of its own."""
    spec, equations, model = built.spec, built.equations, built.model
    if isinstance(spec, Scene):
        raise TypeError("a scene has a page of its own")
    written = notation(equations)
    code = sources(f"{model.name}.c", _file(built.files, ".c"), model.name)
    terms = places(equations, model, code)
    moments = {array(name): definition_anchor(name) for name in moment_names(equations)}
    numbers = paper_numbers(spec) if isinstance(spec, PlanarBeam) else None
    matrix = mass_matrix(model, equations)
    blocks = (
        *_specification(specification),
        *_state(model, written),
        *kinematics_blocks(spec, equations, written),
        *(frame_blocks(spec) if isinstance(spec, PlanarBeam) else _frame(spec, built.notes)),
        *integral_blocks(equations, written),
        *moment_blocks(equations, written, definition_lines(code)),
        *_motion(equations),
        *row_blocks(equations, terms, written, numbers.motion if numbers else ""),
        *mass_blocks(equations, matrix, written),
        *vanished_blocks(equations, written),
        *_frames(built, written),
        *operation_blocks(equations, model),
        *code_blocks(code, targets(terms, moments)),
        *calling_blocks(model),
        *manifest_blocks(built.files),
    )
    return Page(model.name, model.doc, blocks)


def _frame(spec: NodalBody | SymbolicBody, notes: tuple[str, ...]) -> tuple[Block, ...]:
    return body_frame_blocks(spec, notes)


def _frames(built: Built, written: Notation) -> tuple[Block, ...]:
    if not isinstance(built.spec, PlanarBeam) or not isinstance(built.equations, Equations):
        return ()
    return frames_blocks(variants(built.spec, built.equations, built.model), written)


def moment_names(equations: Equations | GenericEquations) -> list[str]:
    """The names of the moments that have an equation on the page."""
    found = [d.symbol.name for d in equations.definitions if not d.zero and not d.section.endswith(("oo", "Q"))]
    found += [d.symbol.name for d in equations.definitions if d.symbol.name.startswith("Q_")]
    if isinstance(equations, GenericEquations):
        found += [c.name for c in equations.contractions] + [t.name for t in equations.totals]
    return found


def _file(files: tuple[File, ...], ending: str) -> str:
    return next(file.text for file in files if file.path.endswith(ending))


def _specification(given: Text) -> tuple[Block, ...]:
    shown = listing("toml", given.name, given.text.strip("\n"))
    count = len(shown.lines)
    block: Block = shown if count <= LONG else Details(f"{given.name}, {count} lines", (shown,))
    return (Heading("Specification", "specification"), block)


def _state(model: Model, written: Notation) -> tuple[Block, ...]:
    """Coordinates, rates and parameters."""
    head = ("", "in the code", "unit", "what it is")
    said = f"{_sum(model.coordinates)} coordinates q, {_sum(model.rates)} rates v"
    count = sum(p.size for p in model.parameters)
    told = f", and {count} parameter{'' if count == 1 else 's'}." if count else "; every number is folded into the code."
    found: list[Block] = [Heading("Coordinates and parameters", "coordinates"), Paragraph((said + told,))]
    rows = [_variable(v, written) for v in (*model.coordinates, *_rates(model))]
    found.append(folded(table("Coordinates and rates", head, rows), "Coordinates and rates"))
    if model.parameters:
        of_parameters = [[*_variable(p, written), _default(p)] for p in model.parameters]
        found.append(folded(table("Parameters", (*head, "default"), of_parameters), "Parameters"))
    if model.origin:
        found.append(Paragraph((model.origin,)))
    if model.choice:
        found.append(Paragraph((f"The functions are {model.choice}.",)))
    if model.constants:
        rows = [[Code(c.name), c.unit, c.doc, str(c.size)] for c in model.constants]
        found.append(Details(*_constants(rows)))
    return tuple(found)


def _constants(rows: list[list[Said]]) -> tuple[str, tuple[Block, ...]]:
    whole = table("", ("in the code", "unit", "what it is", "values"), rows, "lllr")
    return f"Constants k, made of the parameters by setup: {len(rows)}", (folded(whole, "Constants"),)


def _rates(model: Model) -> tuple[Variable, ...]:
    """Rates that are more than time derivatives of coordinates of the same name."""
    names = {f"{q.name}dot" for q in model.coordinates}
    return tuple(v for v in model.rates if v.name not in names)


def _variable(variable: Variable, written: Notation) -> list[Said]:
    import sympy as sp

    if variable.size > 1 and known(f"{variable.name}_i"):
        formula = written.formula(sp.Symbol(f"{variable.name}_i"))
    else:
        formula = written.formula(next((s for s in written.constants if s.name == variable.name), sp.Symbol(variable.name)))
    values = f" ({variable.size} values)" if variable.size > 1 else ""
    return [formula, Code(variable.name), variable.unit, variable.doc + values]


def _default(variable: Variable) -> str:
    return "" if variable.size > 1 else f"{variable.default:g}"


def _sum(variables: tuple[Variable, ...]) -> int:
    return sum(v.size for v in variables)


def _motion(equations: Equations | GenericEquations) -> tuple[Block, ...]:
    """What the rows are."""
    loops = " There is one row for each shape i." if isinstance(equations, GenericEquations) else ""
    said = (
        "The virtual work of the inertia on each virtual displacement, with the variation of the strain energy: the "
        "factor of every variation vanishes, M(q) v̇ + h(t, q, v) = 0. A term leads to the line of the generated C "
        f"that computes it, and a line leads back.{loops}"
    )
    return (Heading("Equations of motion", "motion"), Paragraph((said,)))
