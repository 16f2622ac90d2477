"""Single bodies built in Python: beams, and bodies in space made of nodes or with parameters."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from typing import Any, TypeVar

from derive.spec.as_tables import as_table, named
from derive.spec.construction.validated import validated_data
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import (
    DEFAULT_ANSATZ,
    DEFAULT_BENDING_STIFFNESS,
    DEFAULT_LENGTH,
    DEFAULT_MASS,
    AttachedMass,
    AxialDeformation,
    BeamDamping,
    Frame,
    Polynomial,
    ShapeFamily,
)
from derive.spec.model.body import BodyFrame, ComponentModes, Damping, Lowering, NodalBody, SymbolicBody, SymbolicFrame
from derive.spec.model.documentation import key_entries, with_entries
from derive.spec.model.instances import identifier
from derive.spec.model.keys import declared_keys
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.model.node_data import NodeData
from derive.spec.model.quantity import Parameter
from derive.spec.model.specification import Specification
from derive.spec.parsing.names import element_name_problem

Number = int | float | Fraction | str
Constant = Number | Mapping[str, object] | Parameter
Nodes = str | os.PathLike[str] | Mapping[str, Any] | NodeData
Table = Mapping[str, object]

Body = TypeVar("Body", PlanarBeam, NodalBody, SymbolicBody)
Function = TypeVar("Function", bound=Callable[..., Specification])


def documented_keys(of: type) -> Callable[[Function], Function]:
    """A decorator that adds to the arguments in the docstring of a function the keys that a type declares."""

    def documented(function: Function) -> Function:
        parameters = inspect.signature(function).parameters
        keys = (key for key in declared_keys(of) if key.name in parameters and key.description)
        function.__doc__ = with_entries(inspect.getdoc(function) or "", "Arguments", key_entries(keys))
        return function

    return documented


@documented_keys(PlanarBeam)
def planar_beam(
    name: str,
    *,
    ansatz: Sequence[str | Polynomial] | Mapping[str, object] | ShapeFamily = DEFAULT_ANSATZ,
    frame: str | Mapping[str, object] | Frame | None = None,
    mass: Constant = DEFAULT_MASS,
    length: Constant = DEFAULT_LENGTH,
    bending_stiffness: Constant = DEFAULT_BENDING_STIFFNESS,
    markers: Mapping[str, Number] | None = None,
    orthogonal: bool | None = None,
    ends: str | None = None,
    gravity: Sequence[Constant] | None = None,
    axial: Table | AxialDeformation | None = None,
    damping: Mapping[str, Constant] | BeamDamping | Damping | None = None,
    order: int = 1,
    terms: str | None = None,
    masses: Mapping[str, Table] | Sequence[AttachedMass] = (),
) -> PlanarBeam:
    """A uniform slender beam that moves in a plane.

    The beam of a body such as link[3] may have the name of the body; alone it is a model called link_3. Numbers may be
    texts, such as "1/3"; a float is the decimal that it is printed as. Polynomials are texts, such as "xi^2 - 1/3", or
    tuples of coefficients.

    Arguments:
        name: the name of the model, which is the prefix of its C.

    Raises:
        SpecError: with all faults of the arguments.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", frame="point", mass=2, length="3/2", markers={"tip": 1})
        >>> beam.length, beam.frame.kind
        (Fraction(3, 2), 'point')
        >>> stiff = derive.planar_beam("stiff", mass=1, length=1, bending_stiffness=100)
        >>> derive.modes(stiff).frequencies[3:].round(1)  # Hz, of its two shapes
        array([ 42.7, 145.9])
    """
    return _single(PlanarBeam, planar_beam, locals())


@documented_keys(NodalBody)
def nodal_body(
    name: str,
    nodes: Nodes,
    *,
    units: str | Mapping[str, str] | None = None,
    modes: int | ModeSelection | Mapping[str, float] | None = None,
    component_modes: ComponentModes | None = None,
    interface: Sequence[str] | None = None,
    frame: str | Mapping[str, object] | BodyFrame = "mean",
    orthonormal: bool | None = None,
    damping: Mapping[str, Number] | Damping | None = None,
    gravity: Sequence[Constant] | None = None,
    lowering: Lowering = "auto",
    markers: Mapping[str, int] | None = None,
    order: int | None = None,
    stress: bool = False,
) -> NodalBody:
    """A deformable body in space made of the nodes of a finite-element program.

    The nodes may also be a table of arrays or lists with the names that they have in a .npz file, or NodeData, which
    are in SI units.

    Arguments:
        name: the name of the model, which is the prefix of its C.

    Raises:
        SpecError: with all faults of the arguments and of the arrays.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI")
        >>> derive.modes(square).frequencies[-1:].round(3)  # 10 rad/s in Hz
        array([1.592])
    """
    given = locals()
    if units is None and isinstance(nodes, NodeData):
        given["units"] = "SI"
    if isinstance(nodes, Mapping):
        given["nodes"] = {key: _array(rows) for key, rows in nodes.items()}
    return _single(NodalBody, nodal_body, given)


@documented_keys(SymbolicBody)
def symbolic_body(
    name: str,
    modes: int,
    *,
    frame: SymbolicFrame = "mean",
    damping: bool = False,
    gravity: Sequence[Constant] | None = None,
    lowering: Lowering = "auto",
) -> SymbolicBody:
    """A deformable body in space whose mass, shape integrals and stiffness are run-time parameters.

    `parameters` gives the values of these with which the model represents a particular body.

    Arguments:
        name: the name of the model, which is the prefix of its C.

    Raises:
        SpecError: with all faults of the arguments.

    Examples:
        >>> import derive
        >>> model = derive.lower(derive.derive(derive.symbolic_body("any_body", modes=1)))
        >>> [parameter.name for parameter in model.parameters][:4]
        ['m', 'C3_11_', 'C3_12_', 'C3_13_']
    """
    return _single(SymbolicBody, symbolic_body, {**locals(), "integrals": "symbolic"})


def _array(rows: Any) -> Any:
    """Nested lists as an array; anything else, such as the name of a file or ragged rows, as it is."""
    if isinstance(rows, (list, tuple)):
        import numpy as np  # beams do without

        with suppress(ValueError):
            return np.array(rows)
    return rows


def _single(of: type[Body], function: Callable[..., Body], given: Mapping[str, Any]) -> Body:
    """The specification of a single body from the arguments of a function, of which None are not given by default."""
    parameters = inspect.signature(function).parameters
    keys: Table = {
        key: table
        for key, value in given.items()
        if key != "name" and not (value is None and key in parameters and parameters[key].default is None)
        if (table := named(key, value) if key == "masses" else as_table(value)) != {} or isinstance(value, Mapping)
    }
    name = given["name"]
    valid = isinstance(name, str) and not element_name_problem(name)
    result = validated_data({"name": identifier(name) if valid else name, of.section: keys})
    assert isinstance(result, of)
    return result
