"""Random scenes in space on which the estimates of the monitors are calibrated: those of the corpus with one beam.

The beams of the corpus are stiff and its runs short. Here each beam is made three times, from stiff to soft, with a
stiffness that its weight or what acts on it bends from little to too much; in half of the scenes one plane is much
stiffer than the other, so that lateral buckling comes into reach; and a run lasts some periods of the beam. The
stiffnesses are parameters: a model is derived once for all of them.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import derive
from derive.simulation.observables.motion import si_value
from derive.spec.model.quantity import Parameter
from derive.spec.model.spatial_beam import LateralDeflection, SpatialBeam
from derive.spec.model.spatial_scene import SpatialScene

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from corpus.draws import Draws
from corpus.generator import corpus_scene

SAGS = (4e-4, 3e-3, 2e-2)
"""The deflections of a beam between pins under its weight, over its length, from which its stiffnesses follow."""
MOST_BODIES = 2
"""The bodies of a scene, its beam among them: more take the derivation long."""
ROWS = 200
NAMES = ("EI_e2", "EI_e3", "GJ_e1")
"""The parameters of the stiffnesses."""


@dataclass(frozen=True)
class RandomScene:
    """A scene with one beam, the draws of its model, and its stiffnesses, N m^2: of bending twice, and of torsion."""

    seed: int
    scene: SpatialScene
    stiffnesses: tuple[tuple[float, float, float], ...]
    periods: float

    @property
    def beam(self) -> SpatialBeam:
        """The beam."""
        return next(body for body in self.scene.bodies if isinstance(body, SpatialBeam))

    def with_stiffness(self, number: int) -> SpatialScene:
        """The scene with the stiffnesses of a number, over some periods of the beam between pins."""
        assert self.scene.simulation is not None
        beam, (first, second, torsion) = self.beam, self.stiffnesses[number]
        along, across, twist = (
            Parameter(name, "N m^2", value) for name, value in zip(NAMES, (first, second, torsion), strict=True)
        )
        lateral = replace(beam.lateral or LateralDeflection(), bending_stiffness=across)
        own = replace(beam, bending_stiffness=along, lateral=lateral)
        if beam.torsion is not None:
            own = replace(own, torsion=replace(beam.torsion, stiffness=twist))
        frequency = np.pi**2 * np.sqrt(min(first, second) / (si_value(beam.mass) * si_value(beam.length) ** 3))
        duration = float(f"{self.periods * 2 * np.pi / frequency:.3g}")
        settings = replace(self.scene.simulation, duration=duration, output=duration / ROWS, until=None)
        bodies = tuple(own if body.name == beam.name else body for body in self.scene.bodies)
        return replace(self.scene, bodies=bodies, simulation=settings)


def random_scene(seed: int) -> RandomScene | None:
    """The scene of a seed, if it has one beam and few other bodies."""
    with tempfile.TemporaryDirectory() as folder:
        spec = derive.read(corpus_scene(seed).write(Path(folder) / "scene"))
    if not isinstance(spec, SpatialScene) or spec.simulation is None or len(spec.bodies) > MOST_BODIES:
        return None
    beams = [body for body in spec.bodies if isinstance(body, SpatialBeam)]
    if len(beams) != 1:
        return None
    (beam,) = beams
    start = replace(beam.start, amplitudes=None, amplitude_rates=None)  # which belong to shapes of the corpus
    plain = replace(beam, start=start, axial=None, pieces=1)
    bodies = tuple(plain if body is beam else body for body in spec.bodies)
    scene = replace(spec, bodies=bodies, outputs=(), plots=(), start=None, lowering="flat")
    draws = Draws(f"monitors {seed}")
    ratio = draws.scale(1, 60) if draws.chance(0.5) else 1.0
    order, factor, twist = draws.chance(0.5), draws.scale(0.5, 2), draws.between(0.5, 1)
    weight = si_value(beam.mass) * 9.81 * si_value(beam.length) ** 2 * 5 / 384
    pairs = []
    for sag in SAGS:
        weak = weight / (sag * factor)
        first, second = (weak, weak * ratio) if order else (weak * ratio, weak)
        pairs.append((first, second, weak * twist))
    return RandomScene(seed, scene, tuple(pairs), draws.between(1, 2.5))


def random_scenes(seeds: range) -> Iterator[RandomScene]:
    """The scenes of some seeds."""
    return (scene for seed in seeds if (scene := random_scene(seed)) is not None)
