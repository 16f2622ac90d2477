"""The fields of finite-element bodies in a run: places and displacements of nodes over time, and their stresses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.errors import Problem, SpecError, quoted
from derive.reduction.body import prepare
from derive.reduction.modal_stresses import modal_stresses
from derive.simulation.observables.motion import Array
from derive.simulation.observables.spatial_player_data import BodyPath, path_of, turned
from derive.simulation.observables.spatial_scene_player import body_path
from derive.simulation.trajectory import Trajectory
from derive.solids.stresses import von_mises
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.specification import AnyScene
from derive.spec.parsing.faults import did_you_mean


@dataclass(frozen=True, eq=False)
class FieldInstant:
    """The fields of a body at a time t, s, along the axes of the inertial frame but for the stresses.

    places (nodes, 3), m: those of the nodes as they move and deform. displacements (nodes, 3), m: those by deformation.
    stresses (nodes, 6), Pa: xx, yy, zz, xy, yz, xz along the axes of the body, and von_mises (nodes,), Pa; None where
    the elements have no materials.
    """

    t: float
    places: Array
    displacements: Array
    stresses: Array | None = None
    von_mises: Array | None = None


def bodies_with_elements(spec: AnyScene | NodalBody) -> dict[str, NodalBody]:
    """The finite-element bodies of a scene, or a body alone, whose files have elements, by their names."""
    if isinstance(spec, NodalBody):
        every = [spec]
    else:
        every = [body.body for body in spec.bodies if isinstance(body, FlexibleBody)]
    return {body.name: body for body in every if body.data.mesh is not None and body.data.mesh.elements}


def field_bodies(spec: AnyScene | NodalBody, names: Sequence[str]) -> tuple[NodalBody, ...]:
    """The bodies with these names. Raises SpecError for names of others."""
    known = bodies_with_elements(spec)
    problems = []
    for name in names:
        if name not in known:
            of = f"bodies with elements are {', '.join(known)}" if known else "no body has elements in its file"
            hint = did_you_mean(name, known, of) if known else f"; {of}"
            problems.append(Problem(f"bodies.{name}", f"there is no body with elements called {quoted(name)}{hint}"))
    if problems:
        raise SpecError(tuple(problems))
    return tuple(known[name] for name in dict.fromkeys(names))


def instants(rows: int, most: int) -> NDArray[np.intp]:
    """The rows of a run whose fields are written: all, or `most` of them, evenly spaced with both ends."""
    return np.unique(np.linspace(0, rows - 1, min(rows, most)).round().astype(np.intp))


def field_instants(body: NodalBody, trajectory: Trajectory, rows: NDArray[np.intp]) -> Iterator[FieldInstant]:
    """Yield the fields of a body in some rows of a run. Displacements are those of first order in the amplitudes."""
    shapes = prepare(body).shapes
    if trajectory.body is not None:
        path = path_of(trajectory.q)
    else:
        path = body_path(body.name, len(shapes.phi), trajectory.motion)
    modal = modal_stresses(body) if body.data.has_stresses else None
    for row in rows:
        alpha = path.amplitudes[row]
        at = BodyPath(path.position[[row]], path.quaternion[[row]], alpha[None])
        places = turned(at, shapes.x + np.tensordot(alpha, shapes.phi, axes=1))[0]
        undeformed = turned(at, shapes.x)[0]
        stresses = None if modal is None else np.tensordot(alpha, modal, axes=1)
        largest = None if stresses is None else von_mises(stresses)
        yield FieldInstant(float(trajectory.t[row]), places, places - undeformed, stresses, largest)
