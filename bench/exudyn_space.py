"""The slider-cranks in space inside Exudyn: one evaluation of mass matrix, forces and constraint Jacobian.

Its rigid bodies have quaternions, its flexible rod is ObjectFFRFreducedOrder with our shape integrals; all keep their
coordinates, as in any program that assembles a model at run time. Its functions are called from Python, which takes
some 0.2 microseconds a call. The rod has a spherical joint at either end there.
"""

from __future__ import annotations

import time
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import space_scenes as scenes

from derive.export.exudyn.floating_frame_arguments import floating_frame_arguments
from derive.spec.model.spatial_scene import SpatialScene

CALLS, ROUNDS = 200, 15
ROD = 0.3
"""The length of the rod, m, which lies along its e1."""
INERTIAS = {
    "crank": (0.12, (1e-5, 1e-4, 1e-4)),
    "rod": (0.07536, (5e-7, 5.653e-4, 5.656e-4)),
    "slider": (2, (1e-3,) * 3),
}
"""The masses and principal moments of the rigid bodies, as in the scene."""


def evaluation(scene: SpatialScene, flexible: bool, calls: int = CALLS, rounds: int = ROUNDS) -> float:
    """The least CPU time (ns) of an evaluation. Raises ImportError without Exudyn."""
    exu = import_module("exudyn")
    exu.config.printToConsole = False
    mbs = _system(exu, scene, flexible)
    mbs.Assemble()
    solver, settings = exu.MainSolverImplicitSecondOrder(), exu.SimulationSettings()
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    if not solver.InitializeSolver(mbs, settings):
        raise RuntimeError("Exudyn does not initialise its solver")
    times = []
    for _ in range(rounds):
        start = time.process_time()
        for _ in range(calls):
            solver.ComputeMassMatrix(mbs, 1.0)
            solver.ComputeODE2RHS(mbs)
            solver.ComputeJacobianAE(mbs, 1.0, 0.0, 1.0, False)
        times.append((time.process_time() - start) / calls)
    mass = np.array(solver.GetSystemMassMatrix())
    if not np.abs(mass).max() > 1.9:  # the slider
        raise ArithmeticError("Exudyn has another mass matrix")
    solver.FinalizeSolver(mbs, settings)
    return 1e9 * min(times)


def _system(exu: Any, scene: SpatialScene, flexible: bool) -> Any:
    items, mbs = import_module("exudyn.itemInterface"), exu.SystemContainer().AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    crank = _rigid(mbs, items, "crank", (0.0, 0.12, 0.1))
    slider = _rigid(mbs, items, "slider", (0.2, 0.0, 0.0))
    ends = _flexible(mbs, items, scene) if flexible else _rigid_ends(mbs, items)

    def marker(body: int, at: tuple[float, float, float]) -> int:
        return int(mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=list(at))))

    def joint(markers: list[int], axes: list[int]) -> None:
        mbs.AddObject(items.GenericJoint(markerNumbers=markers, constrainedAxes=axes))

    joint([marker(ground, (0.0, 0.12, 0.1)), marker(crank, (0.0, 0.0, 0.0))], [1, 1, 1, 0, 1, 1])
    joint([marker(ground, (0.0, 0.0, 0.0)), marker(slider, (0.0, 0.0, 0.0))], [0, 1, 1, 1, 1, 1])
    for body, at, end in ((crank, (0.08, 0.0, 0.0), ends[0]), (slider, (0.0, 0.0, 0.0), ends[1])):
        point = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=list(at)))
        mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[point, end]))
    return mbs


def _rigid(mbs: Any, items: Any, name: str, at: tuple[float, float, float]) -> int:
    mass, moments = INERTIAS[name]
    node = mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*at, 1, 0, 0, 0]))
    inertia = [*moments, 0, 0, 0]
    return int(mbs.AddObject(items.ObjectRigidBody(mass=mass, inertia=inertia, nodeNumber=node)))


def _rigid_ends(mbs: Any, items: Any) -> list[int]:
    rod = _rigid(mbs, items, "rod", (0.1, 0.1, 0.05))
    places = ([-ROD / 2, 0, 0], [ROD / 2, 0, 0])
    return [mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=rod, localPosition=at)) for at in places]


def _flexible(mbs: Any, items: Any, scene: SpatialScene) -> list[int]:
    (link,) = scenes.reduced_links(scene)
    body = replace(link.body, points=tuple(frame.point for frame in link.frames))
    frame = mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[0.1, 0.1, 0.05, 1, 0, 0, 0]))
    zero = [0.0] * body.modes
    state = {f"{kind}Coordinates{t}": zero for kind, t in (("reference", ""), ("initial", ""), ("initial", "_t"))}
    amplitudes = mbs.AddNode(items.NodeGenericODE2(numberOfODE2Coordinates=body.modes, **state))
    tables = floating_frame_arguments(body)
    number = mbs.AddObject(items.ObjectFFRFreducedOrder(nodeNumbers=[frame, amplitudes], **tables))
    return [
        mbs.AddMarker(
            items.MarkerSuperElementPosition(bodyNumber=number, meshNodeNumbers=[node], weightingFactors=[1.0])
        )
        for node in range(2)
    ]


def main() -> None:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        for flexible in (False, True):
            scene = scenes.slider_crank(flexible, Path(folder))
            print(f"{scene.name:24}{evaluation(scene, flexible):10.0f} ns")


if __name__ == "__main__":
    main()
