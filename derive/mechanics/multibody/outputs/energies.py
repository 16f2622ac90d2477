"""Energies of a mechanism, and the powers that change them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.outputs.output_type import NamedElements, OutputComponent, OutputComponents, OutputType
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.symbols import Family, identity
from derive.spec.model.keys import Key


class Energies(OutputType):
    """The kinetic energy, the strain energy including springs, the potential energy of gravity, and their sum."""

    doc = "kinetic, strain (with springs), gravitational and total energy"
    labels = ("kinetic", "strain", "gravity", "total")
    counts_inertia = True
    keys: tuple[Key, ...] = ()

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return four energies, summed over all bodies, including those whose motion is prescribed."""
        kinetic, strain, weight = (sp.Add(*(i.energies[k] for i in scene.instances.values())) for k in range(3))
        strain += sp.Add(*(force.potential for force in scene.generalised))
        return OutputComponents(
            (
                OutputComponent("kinetic", "J", kinetic),
                OutputComponent("strain", "J", strain),
                OutputComponent("gravity", "J", weight),
                OutputComponent("total", "J", kinetic + strain + weight),
            )
        )

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the descriptions of the energies."""
        strain = "strain energy, with that of springs"
        return "kinetic energy", strain, "potential of gravity", "kinetic energy and potentials"


class Powers(OutputType):
    """The powers of loads and drives, and the dissipation: together the time derivative of the total energy."""

    doc = "power of loads and drives, and dissipation: their sum is the time derivative of the total energy"
    labels = ("loads", "drives", "dissipated")
    counts_inertia = True
    keys: tuple[Key, ...] = ()

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return three powers; that of springs is the power of their dampers, since they store the rest."""
        loads = [scene.power(f) for f in scene.forces if f.type.section != "springs"]
        drives = [scene.drive_force(d) * scene.drive_rate(d) for d in scene.scene.drives]
        dissipated = sp.Add(*(force.dissipation for force in scene.generalised))
        dissipated += sp.Add(*map(material_damping, scene.instances.values()))
        return OutputComponents(
            (
                OutputComponent("loads", "W", sp.Add(*loads)),
                OutputComponent("drives", "W", sp.Add(*drives)),
                OutputComponent("dissipated", "W", dissipated),
            )
        )

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the descriptions of the powers."""
        dissipated = "power of dampers and of material damping"
        return "power of forces and torques at markers", "power of the drives", dissipated


def material_damping(instance: InstanceEquations) -> sp.Expr:
    """The power of the material damping of an instance, - alphadot . B alphadot."""
    rates = {row.name: row.v for row in instance.rows}
    damping = (term for term in instance.terms if any(map(_is_damping, term.expr.free_symbols)))
    return -sp.Add(*(term.expr * rates[term.row] for term in damping))


def _is_damping(symbol: sp.Symbol) -> bool:
    return identity(symbol).family in (Family.DAMPING, Family.DAMPING_FORCE)
