"""Energies of a mechanism, and the powers that change them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.multibody.outputs.output_type import (
    Addend,
    NamedElements,
    OutputComponent,
    OutputComponents,
    Summands,
    SumOutput,
)
from derive.mechanics.symbols import Family, identity
from derive.spec.model.keys import Key

if TYPE_CHECKING:
    from derive.mechanics.multibody.instances import InstanceEquations
    from derive.mechanics.multibody.scene_mechanics import SceneMechanics


class Energies(SumOutput):
    """The kinetic energy, the strain energy including springs, the potential energy of gravity, and their sum.

    They are summed over all bodies, including those whose motion is prescribed.
    """

    doc = "kinetic, strain (with springs), gravitational and total energy"
    labels = ("kinetic", "strain", "gravity", "total")
    units = ("J", "J", "J", "J")
    counts_inertia = True
    keys: tuple[Key, ...] = ()

    def addends(self, mechanism: Summands) -> Iterator[tuple[Addend, Mapping[str, Any]]]:
        """Yield those of each body, and of each spring."""
        yield from ((BODY_ENERGY, {"body": name}) for name in mechanism.names)
        yield from ((STORED_ENERGY, {"force": force.element.name}) for force in mechanism.forces)

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the descriptions of the energies."""
        strain = "strain energy, with that of springs"
        return "kinetic energy", strain, "potential of gravity", "kinetic energy and potentials"


class Powers(SumOutput):
    """The powers of loads and drives, and the dissipation: together the time derivative of the total energy.

    The power of springs is that of their dampers, since they store the rest.
    """

    doc = "power of loads and drives, and dissipation: their sum is the time derivative of the total energy"
    labels = ("loads", "drives", "dissipated")
    units = ("W", "W", "W")
    counts_inertia = True
    keys: tuple[Key, ...] = ()

    def addends(self, mechanism: Summands) -> Iterator[tuple[Addend, Mapping[str, Any]]]:
        """Yield those of each force, of each drive, of the dampers, and of the damping of each body."""
        for force in mechanism.forces:
            if force.type.section != "springs":
                yield LOAD_POWER, {"force": force.element.name}
            yield DISSIPATED_POWER, {"force": force.element.name}
        drives = [j.drive for j in mechanism.joints] + [j.drive for j in mechanism.eliminated_joints]
        for drive in drives:
            if drive is not None:
                yield DRIVE_POWER, {"drive": drive.name, "rate": drive.motion[1]}
        yield from ((MATERIAL_DAMPING, {"body": name}) for name in mechanism.names)
        for number, damping in enumerate(mechanism.dampings):
            yield COMPONENT_DAMPING, {"components": damping.components, "number": number}

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the descriptions of the powers."""
        dissipated = "power of dampers and of material damping"
        return "power of forces and torques at markers", "power of the drives", dissipated


def _energies(kinetic: sp.Expr, strain: sp.Expr, weight: sp.Expr) -> OutputComponents:
    """The parts of the energies of a mechanism that an element of it has."""
    values = kinetic, strain, weight, kinetic + strain + weight
    of = zip(Energies.labels, Energies.units, values, strict=True)
    return OutputComponents(tuple(OutputComponent(*each) for each in of))


def _powers(loads: sp.Expr = 0, drives: sp.Expr = 0, dissipated: sp.Expr = 0) -> OutputComponents:
    """The parts of the powers of a mechanism that an element of it has."""
    of = zip(Powers.labels, Powers.units, map(sp.sympify, (loads, drives, dissipated)), strict=True)
    return OutputComponents(tuple(OutputComponent(*each) for each in of))


class _BodyEnergy(Addend):
    """The energies of a body."""

    doc = "energies of a body"
    labels = Energies.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the energies."""
        return _energies(*scene.instances[values["body"]].energies)


class _StoredEnergy(Addend):
    """The energy that a force stores."""

    doc = "energy that a force stores"
    labels = Energies.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the energies."""
        return _energies(sp.S.Zero, scene.virtual_work(values["force"]).potential, sp.S.Zero)


class _LoadPower(Addend):
    """The power of a force or a torque."""

    doc = "power of a load"
    labels = Powers.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the powers."""
        return _powers(loads=scene.power(next(f for f in scene.forces if f.element.name == values["force"])))


class _DissipatedPower(Addend):
    """The power of the damper of a spring."""

    doc = "power of a damper"
    labels = Powers.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the powers."""
        return _powers(dissipated=scene.virtual_work(values["force"]).dissipation)


class _DrivePower(Addend):
    """The power of a drive."""

    doc = "power of a drive"
    labels = Powers.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the powers; the value `rate` is that of the relative coordinate that it prescribes."""
        drive = next(drive for drive in scene.scene.drives if drive.name == values["drive"])
        return _powers(drives=scene.drive_force(drive) * values["rate"])


class _MaterialDamping(Addend):
    """The power of the material damping of a body in one component."""

    doc = "power of the material damping of a body"
    labels = Powers.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the powers."""
        return _powers(dissipated=material_damping(scene.instances[values["body"]]))


class _DampingOfComponents(Addend):
    """The power of the damping of a body in several components."""

    doc = "power of the damping between the components of a body"
    labels = Powers.labels

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return its parts of the powers, with the constants of the damping."""
        from derive.mechanics.multibody.component_damping import damping_force

        damping = scene.dampings[values["number"]]
        made = _powers(dissipated=damping_force(damping, scene.instances).dissipation)
        return replace(made, constants=damping.constants)


BODY_ENERGY = _BodyEnergy()
STORED_ENERGY = _StoredEnergy()
LOAD_POWER = _LoadPower()
DISSIPATED_POWER = _DissipatedPower()
DRIVE_POWER = _DrivePower()
MATERIAL_DAMPING = _MaterialDamping()
COMPONENT_DAMPING = _DampingOfComponents()


def material_damping(instance: InstanceEquations) -> sp.Expr:
    """The power of the material damping of an instance, - alphadot . B alphadot."""
    rates = {row.name: row.v for row in instance.rows}
    damping = (term for term in instance.terms if any(map(_is_damping, term.expr.free_symbols)))
    return -sp.Add(*(term.expr * rates[term.row] for term in damping))


def _is_damping(symbol: sp.Symbol) -> bool:
    return identity(symbol).family in (Family.DAMPING, Family.DAMPING_FORCE)
