"""The table of a beam that is not part of a scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from derive.spec.model.body import PlanarBeam
from derive.spec.model.plots import Plot
from derive.spec.model.simulation import Simulation
from derive.spec.tables.beam import BeamKeys
from derive.spec.tables.initial_values import BeamStartTable
from derive.spec.tables.shared import PlanarGravity, acceleration


class BeamTable(BeamKeys):
    """A uniform slender beam that moves freely in a plane."""

    gravity: PlanarGravity = None
    start: Annotated[BeamStartTable, Field(description="Initial values of a simulation of the beam alone.")] = (
        BeamStartTable()
    )

    def free_beam(self, name: str, simulation: Simulation | None, plots: tuple[Plot, ...]) -> PlanarBeam:
        """The model of the beam that the derivation takes, with gravity, simulation and plots."""
        gravity = self.gravity and (acceleration(self.gravity[0]), acceleration(self.gravity[1]))
        beam = self.planar_beam(name, gravity)
        return replace(beam, start=self.start.start(), simulation=simulation, plots=plots)
