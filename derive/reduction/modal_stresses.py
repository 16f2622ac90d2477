"""The stresses of the modes of a body by its elements, at all nodes and at markers."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from derive.reduction.arithmetic import Array
from derive.reduction.body import prepare
from derive.reduction.marker_motion import MarkerNodes, marker_motion
from derive.reduction.mesh_stiffening import integrated_mesh
from derive.solids.stresses import nodal_stresses
from derive.spec.model.body import NodalBody


def modal_stresses(body: NodalBody) -> Array:
    """The stresses (N, nodes, 6), Pa/m, of the modes of a body, for a unit amplitude: xx, yy, zz, xy, yz, xz.

    The body has elements with materials; the axes are those of the body. Raises SpecError.
    """
    return _modal_stresses(replace(body, name=""))


@lru_cache(4)
def _modal_stresses(body: NodalBody) -> Array:
    shapes, mesh = prepare(body).shapes, body.data.mesh
    assert mesh is not None, "a body with stresses has elements"
    return nodal_stresses(integrated_mesh(mesh, shapes), shapes.phi)


def marker_stresses(body: NodalBody, marker: MarkerNodes) -> Array:
    """The stresses (N, 6), Pa/m, at the node of a marker, or their mean over the nodes of a set. Raises SpecError."""
    motion = marker_motion(body, marker, prepare(body).shapes.x)
    return np.asarray(np.einsum("a,nac->nc", motion.weights, modal_stresses(body)[:, motion.nodes]))
