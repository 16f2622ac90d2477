"""Springs and bushings in space: the types, the keys of their tables, and their loads at two markers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.mechanics.motion.vectors import dot, length_of
from derive.mechanics.multibody.space.forces import (
    ActionLoads,
    CountedRotation,
    ElementDefinitions,
    Frames,
    MarkerLoad,
    Values,
    none,
)
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, RelativeFunction, derived, row_variables
from derive.registry import Registry
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.spatial_forces import (
    SpatialSpring,
)


def _linear(spring: SpatialSpring, frames: Frames, values: Values, turns: CountedRotation | None) -> ActionLoads:
    """A tension along the line between the markers. Raises SpecError where a joint makes it a point."""
    name = ElementDefinitions(spring.name, f"spring {spring.name}")
    first, second = frames
    apart = name.vector("apart", second.position - first.position, "vector")
    if not any(apart):
        text = (
            f"a joint keeps {spring.first} and {spring.second} together, so that no line between them has a direction; "
            "name other markers, or write a rotational spring or a bushing"
        )
        raise SpecError((Problem(f"springs.{spring.name}.between", text),))
    length = name("length", length_of(apart), "length")
    extension = length - values["rest"]
    tension, dissipation = values["stiffness"] * extension, sp.S.Zero
    if values["damping"] != 0:
        rate = name("rate", dot(apart, second.velocity - first.velocity) / length, "time derivative of the length")
        tension += values["damping"] * rate
        dissipation = -values["damping"] * rate**2
    over_length = name("pull", tension / length, "tension over length")
    if isinstance(length, sp.Symbol):
        coincide = f"the ends of spring {spring.name} coincide"
        name.made[-1] = replace(name.made[-1], divisor=length, divisor_text=coincide)
    pull = over_length * apart
    loads = (MarkerLoad(spring.second, -pull, none()), MarkerLoad(spring.first, pull, none()))
    potential = values["stiffness"] * extension**2 / 2
    return ActionLoads(spring, loads, tuple(name.made), potential, dissipation)


_ACROSS = RelativeFunction("across", "", "1", "J", lambda of: of.along(1, 0))
_ALONG = RelativeFunction("along", "", "1", "J", lambda of: of.along(0, 0))
"""The components of x of the second marker along y and x of the first."""


def _rotational(spring: SpatialSpring, frames: Frames, values: Values, turns: CountedRotation | None) -> ActionLoads:
    """A torque for the rotation of x of the second marker about z of the first: from -pi to pi, or with all turns.

    The torques on both markers are those of a potential, also where their z axes are not parallel.
    """
    from derive.mechanics.time_functions import Atan2

    name = ElementDefinitions(spring.name, f"spring {spring.name}")
    if turns is not None and turns.rate is not None:
        return _about_axis(spring, frames, values, turns.angle, turns.rate)
    first, second = frames
    variables = row_variables().first.values(first) | row_variables().second.values(second)
    rows = derived(_ACROSS), derived(_ALONG)
    across = name("across", _ACROSS.g.xreplace(variables), "x of the second marker along y")
    along = name("along", _ALONG.g.xreplace(variables), "x of the second marker along x")
    turn = name("turn", Atan2(across, along) + (sp.S.Zero if turns is None else turns.angle), "rotation")
    extension = turn - values["rest"]
    torque, dissipation = values["stiffness"] * extension, sp.S.Zero
    square = name("square", across**2 + along**2, "square of x of the second marker in the plane")

    def of_turn(by_across: sp.Expr, by_along: sp.Expr) -> sp.Expr:
        """The derivative of the rotation from those of its two components."""
        return (along * by_across - across * by_along) / square

    if values["damping"] != 0:
        rate = name("rate", of_turn(*(of.rate.xreplace(variables) for of in rows)), "rate of the rotation")
        torque += values["damping"] * rate
        dissipation = -values["damping"] * rate**2
    torque = name("torque", torque, "torque")
    m1, m2 = (
        [-torque * of_turn(a.xreplace(variables), b.xreplace(variables)) for a, b in zip(*of, strict=True)]
        for of in ((rows[0].m1, rows[1].m1), (rows[0].m2, rows[1].m2))
    )
    loads = (
        MarkerLoad(spring.first, none(), name.vector("m1", sp.Matrix(m1), "torque on the first marker")),
        MarkerLoad(spring.second, none(), name.vector("m2", sp.Matrix(m2), "torque on the second marker")),
    )
    potential = values["stiffness"] * extension**2 / 2
    return ActionLoads(spring, loads, tuple(name.made), potential, dissipation)


def _about_axis(spring: SpatialSpring, frames: Frames, values: Values, angle: sp.Expr, rate: sp.Expr) -> ActionLoads:
    """A torque about the common z axis of two markers for a rotation that is known with its rate."""
    name = ElementDefinitions(spring.name, f"spring {spring.name}")
    extension = angle - values["rest"]
    torque = name("torque", values["stiffness"] * extension + values["damping"] * rate, "torque")
    vector = name.vector("inertial", frames[0].axes[:, 2] * torque, "torque on the first marker")
    loads = (MarkerLoad(spring.first, none(), vector), MarkerLoad(spring.second, none(), -vector))
    potential, dissipation = values["stiffness"] * extension**2 / 2, -values["damping"] * rate**2
    return ActionLoads(spring, loads, tuple(name.made), potential, dissipation)


def _axial(axis: str, i: int, j: int) -> RelativeFunction:
    """Half the difference of two entries of A1^T A2: for small rotations the rotation about the third axis."""
    return RelativeFunction(f"r{axis}", "", "rad", "N m", lambda of: (of.along(i, j) - of.along(j, i)) / 2)


BUSHING_ROWS = (
    *DISPLACEMENTS.values(),
    *(_axial(axis, i, j) for axis, i, j in (("x", 2, 1), ("y", 0, 2), ("z", 1, 0))),
)
"""The displacements along the axes of the first marker, and the rotations about them, up to third order in these."""


def _bushing(spring: SpatialSpring, frames: Frames, values: Values, turns: CountedRotation | None) -> ActionLoads:
    """Springs with dampers along and about the axes of the first marker; their forces are those of a potential."""
    name = ElementDefinitions(spring.name, f"spring {spring.name}")
    first, second = frames
    variables = row_variables().first.values(first) | row_variables().second.values(second)
    K, C = values["stiffness"], values.get("damping", sp.zeros(6, 6))
    moved, rate = ([sp.S.Zero] * 6 for _ in range(2))
    for number, row in enumerate(BUSHING_ROWS):
        if any(K[:, number]):
            moved[number] = name(f"moved_{row.label}", row.g.xreplace(variables), f"displacement {row.label}")
        if any(C[:, number]):
            of_rate = derived(row).rate.xreplace(variables)
            rate[number] = name(f"rate_{row.label}", of_rate, f"rate of displacement {row.label}")
    totals = [sp.zeros(3, 1) for _ in range(4)]
    for number, row in enumerate(BUSHING_ROWS):
        force = dot(K[number, :], moved) + dot(C[number, :], rate)
        if force == 0:
            continue
        force = name(f"force_{row.label}", force, f"force of displacement {row.label}")
        of = derived(row)
        factors = (of.f1, of.m1, of.f2, of.m2)
        totals = [total - f.xreplace(variables) * force for total, f in zip(totals, factors, strict=True)]
    labels = ("f1", "m1", "f2", "m2")
    f1, m1, f2, m2 = (name.vector(label, total, label) for label, total in zip(labels, totals, strict=True))
    loads = (MarkerLoad(spring.first, f1, m1), MarkerLoad(spring.second, f2, m2))
    potential, power = _quadratic(K, moved) / 2, _quadratic(C, rate)
    return ActionLoads(spring, loads, tuple(name.made), potential, -power)


def _quadratic(matrix: sp.Matrix, x: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(matrix[i, j] * x[i] * x[j] for i in range(len(x)) for j in range(len(x))))


@dataclass(frozen=True)
class SpatialSpringType:
    """A kind of spring in space: what distinguishes it, the keys of its table, and its loads.

    along_line: whether it acts, and is drawn, along the line between its markers.
    """

    doc: str
    keys: tuple[Key, ...]
    loads: Callable[[SpatialSpring, Frames, Values, CountedRotation | None], ActionLoads]
    along_line: bool = False


def _keys(force: str, length: str) -> tuple[Key, ...]:
    stiffness = Key(
        "stiffness", KeyType.NOT_NEGATIVE_QUANTITY, "N/m", "Stiffness, N/m or N m/rad.", required=True, example="1000"
    )
    damping = "Damping constant, N s/m or N m s/rad."
    rest = "Length, m, or angle, rad, at which the spring exerts no force."
    return (
        replace(stiffness, unit=f"{force}/{length}"),
        Key("damping", KeyType.NOT_NEGATIVE_QUANTITY, f"{force} s/{length}", damping, default=Fraction(0)),
        Key("rest", KeyType.QUANTITY, length, rest, default=Fraction(0)),
    )


_SIX = (
    "along and about x, y, z of the first marker, for small rotations: three numbers in {0} and three in {1}, or the "
    "six rows of a symmetric matrix."
)

SPATIAL_SPRINGS: Registry[SpatialSpringType] = Registry(
    "spring in space",
    {
        "linear": SpatialSpringType("along the line between the markers", _keys("N", "m"), _linear, along_line=True),
        "rotational": SpatialSpringType(
            "about z of the first marker, between the markers of a joint that counts turns with all of them, else from "
            "-pi to pi",
            _keys("N m", "rad"),
            _rotational,
        ),
    },
    doc="""The kinds of springs in space by their names, which are the values of `kind`, without bushings.

    `derive.SPATIAL_SPRINGS.register(name, member)` adds one of your own, a `derive.extensions.SpatialSpringType` with
    its keys and the function that gives its loads.

    Examples:
        >>> import derive
        >>> derive.SPATIAL_SPRINGS["linear"].doc
        'along the line between the markers'
    """,
)
SPATIAL_BUSHINGS = {
    "bushing": SpatialSpringType(
        "along and about three axes",
        (
            Key("stiffness", KeyType.BUSHING_MATRIX, "", f"Stiffnesses {_SIX.format('N/m', 'N m/rad')}", required=True),
            Key("damping", KeyType.BUSHING_MATRIX, "", f"Damping constants {_SIX.format('N s/m', 'N m s/rad')}"),
        ),
        _bushing,
    )
}
"""The kinds of bushings, whose keys have six numbers or a matrix each."""
_UNITS = {"stiffness": ("N/m", "N", "N m/rad"), "damping": ("N s/m", "N s", "N m s/rad")}
"""The units of the entries of these keys between displacements, of both kinds, and between rotations."""


def bushing_unit(key: str, i: int, j: int) -> str:
    """The unit of the entry in row i and column j of a matrix of a bushing; six numbers are its diagonal."""
    return _UNITS[key][sum(BUSHING_ROWS[number].unit == "rad" for number in (i, j))]


def spring_type(kind: str) -> SpatialSpringType:
    """The type of a spring or a bushing."""
    return SPATIAL_BUSHINGS[kind] if kind in SPATIAL_BUSHINGS else SPATIAL_SPRINGS[kind]
