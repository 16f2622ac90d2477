"""`imported_body`: the file of nodes and the specification of a part of a finite-element program, after checks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from derive.errors import Problem, SpecError, quoted
from derive.fem.mechanisms import hinge, loose_parts
from derive.fem.model import Array, FiniteElementModel
from derive.fem.node_archive import archive_bytes, node_arrays
from derive.fem.plausibility import unit_notes
from derive.fem.written_body import SI, BodyTable, FileUnits, body_text, scene_text
from derive.progress_line import show_progress
from derive.reduction.body import ZERO_STIFFNESS, prepare
from derive.reduction.checks import indefinite
from derive.reduction.component_modes import static_mode_count
from derive.short_text import counted
from derive.spec.construction.bodies import nodal_body
from derive.spec.files.node_files import MAX_BYTES
from derive.spec.model.body import ComponentModes, NodalBody
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.model.node_markers import InterfaceMarker
from derive.spec.parsing.faults import did_you_mean, names_text
from derive.spec.parsing.names import free_name

VIBRATION_MODES = 6
"""The modes of vibration that a body has if no number of modes is given."""

COMPARED = 8
"""The number of elastic modes of the free body that are looked at."""

RIGID = 1e-3
"""The program's frequencies of rigid motion are below this part of its first elastic frequency."""

AGREEMENT = 1e-5
"""The largest relative difference to frequencies of the program without a warning."""


@dataclass(frozen=True)
class BodyOptions:
    """The body that is made of a part.

    interface: the sets of nodes to which joints attach. modes: their number, or the error that chooses them; None for
    VIBRATION_MODES besides the static ones. component_modes: their kind, if not the usual one. scene: whether a scene
    is written that holds the body at the first set of the interface. second_order: whether displacements are of second
    order in the amplitudes.
    """

    interface: tuple[str, ...] = ()
    modes: int | ModeSelection | None = None
    component_modes: ComponentModes | None = None
    units: FileUnits = SI
    scene: bool = False
    second_order: bool = False


@dataclass(frozen=True)
class ImportedBody:
    """The specification as TOML, the content of its file of nodes, and lines on the part."""

    name: str
    doc: str
    text: str
    archive: bytes
    notes: tuple[str, ...]


def imported_body(model: FiniteElementModel, options: BodyOptions, source: str, nodes_file: str) -> ImportedBody:
    """The specification of a part, whose arrays are in the file of nodes with the name `nodes_file` beside it, by
    default that of the body.

    `source` is the file that errors and comments name. Raises SpecError with the faults of the part and of the options.
    """
    interface = _interface(model, options, source)
    markers = tuple(InterfaceMarker(name, tuple(model.node_sets[name].tolist())) for name in interface)
    kind = options.component_modes or ("craig_bampton" if interface else "free")
    static = static_mode_count(kind, markers) if interface else 0
    modes = options.modes
    if modes is None and model.modal_stiffness is None:
        modes = static + VIBRATION_MODES
    arrays = node_arrays(model)
    if faults := (*_faults_of_matrices(model), *_too_large(sum(array.nbytes for array in arrays.values()))):
        raise SpecError(faults, source)
    name = free_name(model.name, ())
    try:
        body = nodal_body(
            name, arrays, units=options.units.table(), modes=modes, component_modes=options.component_modes,
            interface=interface or None, order=2 if options.second_order else None,
        )  # fmt: skip
        show_progress("computing modes ...")
        own = modes if isinstance(modes, int) and not interface else 0  # a body without an interface has these modes
        count = max(COMPARED, own)
        frequencies = _elastic_frequencies(body, model, min(count, 3 * len(model.positions) - 6))
        if interface or isinstance(modes, ModeSelection):
            prepare(body)
    except SpecError as error:
        raise SpecError(error.problems, source) from None
    finally:
        show_progress()
    table = BodyTable(
        name, source, nodes_file or f"{name}.npz", body, interface, options.component_modes, options.units, _size(model)
    )
    text = scene_text(table) if options.scene else body_text(table)
    notes = (*_notes(model, body, frequencies), *model.notes)
    return ImportedBody(name, _doc(body), text, archive_bytes(arrays), notes)


def _too_large(size: int) -> Iterator[Problem]:
    """The fault of arrays of so many bytes that a file of nodes would not be read."""
    if size > MAX_BYTES:
        text = f"mesh and matrices take {size / 1e6:.4g} MB, and a file of nodes is read up to {MAX_BYTES / 1e6:.4g} MB"
        yield Problem("", f"{text}; make the mesh coarser")


def _faults_of_matrices(model: FiniteElementModel) -> Iterator[Problem]:
    """Faults of the matrices in which nodes have their numbers in the program."""
    size = 3 * len(model.positions)
    for name, matrix in (("stiffness", model.stiffness), ("mass", model.mass)):
        if matrix is None and name == "stiffness" and model.modal_stiffness is not None:
            continue  # its modes have a stiffness
        if matrix is None:
            yield Problem("", f"the {name} matrix is missing, which the program has to write")
        elif matrix.shape != (size, size):
            text = f"the {name} matrix has the shape {matrix.shape}, and {len(model.positions)} nodes have {size}"
            yield Problem("", f"{text} displacements")
            return
    if model.stiffness is None or model.mass is None:
        return
    if fault := loose_parts(model.stiffness, model.node_numbers):
        yield fault
    along_x = csr_array(model.mass[::3][:, ::3])
    if reason := indefinite(along_x, lambda node: model.node_numbers[node]):
        yield Problem("", reason)


def _interface(model: FiniteElementModel, options: BodyOptions, source: str) -> tuple[str, ...]:
    """The sets of the interface as the model spells them; capital and small letters may differ."""
    spelled = {name.lower(): name for name in model.node_sets}
    problems = []
    for name in options.interface:
        if name.lower() not in spelled:
            known = f"the sets are {names_text(spelled.values())}" if spelled else "there are none"
            hint = did_you_mean(name, spelled.values(), known)
            problems.append(Problem("--interface", f"there is no set of nodes {quoted(name)}{hint}"))
        elif len(model.node_sets[spelled[name.lower()]]) == 2:
            text = f"the set {name} has two nodes, which do not determine a rotation; name a set of three or more"
            problems.append(Problem("--interface", f"{text}, not on a line, or of a single node"))
    if options.interface and model.stiffness is None:
        text = "the file has modes of its own and no stiffness, from which those of an interface are computed"
        problems.append(Problem("--interface", text))
    if options.scene and not options.interface:
        problems.append(Problem("--scene", "a scene holds the body at a set of nodes: name it with --interface"))
    if problems:
        raise SpecError(tuple(problems), source)
    return tuple(spelled[name.lower()] for name in options.interface)


def _elastic_frequencies(body: NodalBody, model: FiniteElementModel, count: int) -> Array:
    """The first elastic frequencies of the free body, Hz. Raises SpecError if it has motions without strain."""
    if model.stiffness is not None:
        body = replace(body, component_modes="free", interface=(), interface_markers=(), modes=max(count, 0))
    shapes = prepare(body).shapes
    squares = np.diag(shapes.stiffness)[:COMPARED]
    loose = squares <= ZERO_STIFFNESS * squares.max(initial=0.0)
    if loose.any():
        raise SpecError((hinge(shapes.phi[:COMPARED][loose], body.data, model.node_numbers),))
    result: Array = np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)
    return result


def _size(model: FiniteElementModel) -> str:
    """The mesh in words."""
    elements = [f"{len(block.nodes)} {block.kind.value}" for block in model.elements]
    return ", ".join([counted(len(model.positions), "node"), *elements])


def _doc(body: NodalBody) -> str:
    interface = f" of the interface {', '.join(body.interface)}" if body.interface else ""
    modes = counted(len(prepare(body).shapes.phi), "mode")
    if isinstance(body.modes, ModeSelection):
        modes += f", whose error is {body.modes.error:g} or less up to {body.modes.up_to:g} Hz,"
    return f"a body in space of {counted(len(body.data.positions), 'node')} with {modes}{interface}"


def _notes(model: FiniteElementModel, body: NodalBody, frequencies: Array) -> Iterator[str]:
    """The size, the frequencies beside those of the program, and doubts about units."""
    text = f"{_size(model)}; mass {float(body.data.mass.sum()):.6g} kg"
    if (k := body.data.stiffness) is not None:
        size = (k.data.nbytes + k.indices.nbytes + k.indptr.nbytes) / 1e6
        text += f"; stiffness of {k.shape[0]} displacements with {k.nnz} entries, {size:.3g} MB in memory"
    yield text
    if model.node_sets:
        sizes = (f"{name} ({len(nodes)})" for name, nodes in model.node_sets.items())
        yield f"sets of nodes: {names_text(sizes)}"
    if len(frequencies):
        shown = ", ".join(f"{f:.7g}" for f in frequencies)
        yield f"first natural frequencies of the free body: {shown} Hz{_compared(model, frequencies, body)}"
        yield from unit_notes(body.data, float(frequencies[0]))


def _compared(model: FiniteElementModel, frequencies: Array, body: NodalBody) -> str:
    """How far the frequencies are from those of the program, if that computed those of the free body."""
    theirs = model.frequencies
    if theirs is None:
        return ""
    elastic = theirs[theirs > RIGID * frequencies[0]]
    count = min(len(elastic), len(frequencies))
    if not count:
        return ""
    gap = float(np.abs(elastic[:count] / frequencies[:count] - 1).max())
    if gap > AGREEMENT:
        listed = ", ".join(f"{f:.7g}" for f in elastic[:count])
        return (
            f"; warning: those of the program are {listed}, perhaps of a body that is held, or inexact for a free one"
        )
    return f"; the {count} of the program differ by {gap:.1e} or less of each"
