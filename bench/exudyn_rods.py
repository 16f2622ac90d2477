"""The swinging rod by means of Exudyn: its floating-frame body with our shape integrals, cables and beams."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from itertools import pairwise
from typing import Any

import numpy as np
import swinging_rod as rod
from numpy.polynomial import legendre
from scipy.sparse import csr_array

from derive.export.exudyn.floating_frame_arguments import floating_frame_arguments
from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.reduction.integrals import antisymmetric, shape_integrals

STRETCHING = 16 * rod.STIFFNESS / rod.DIAMETER**2
"""N, of a round section."""
SHEARING = 0.35 * STRETCHING
"""N, of steel."""
Built = tuple[Any, int, Callable[[np.ndarray], np.ndarray]]
"""A system of Exudyn, a sensor, and the function from its values to the deflection over the length."""


def positions_to_deflection(rows: np.ndarray) -> np.ndarray:
    """The deflection over the length from the positions (n, 6) of rod.POINTS."""
    return rod.deflection(rows[:, :2], rows[:, 2:4], rows[:, 4:])


def modal_rod(shapes: int) -> ModalBody:
    """Shape integrals and stiffness of the rod in space with P2, P3, ... as shapes, by Gauss quadrature."""
    xi, weights = legendre.leggauss(shapes + 4)
    units = np.eye(shapes + 2)[2:]
    lateral = np.array([0.0, 1.0, 0.0])

    def phi(at: np.ndarray) -> np.ndarray:
        return np.array([legendre.legval(at, unit) for unit in units])[..., None] * lateral

    def positions(at: np.ndarray) -> np.ndarray:
        return at[:, None] * np.array([rod.LENGTH / 2, 0.0, 0.0])

    mass = csr_array(np.diag(rod.MASS / 2 * weights))
    i = shape_integrals(mass, positions(xi), phi(xi))
    bends = np.array([legendre.legval(xi, legendre.legder(unit, 2)) for unit in units])
    stiffness = rod.STIFFNESS * (2 / rod.LENGTH) ** 3 * (bends * weights) @ bends.T
    at = np.array([-1.0, 0.0, 1.0])
    points = zip(rod.POINTS, positions(at), phi(at).transpose(1, 0, 2), strict=True)
    tensors = i.S4 + antisymmetric(i.c6), i.S5 - antisymmetric(i.c7)
    return ModalBody(
        "rod", "", "", i.mass, i.c1, i.c2, i.C3, *tensors, i.c6, i.c7, i.c8, stiffness, 0.0 * stiffness,
        tuple(ModalPoint(name, "", x, values) for name, x, values in points),
    )  # fmt: skip


def floating_frame(exu: Any, shapes: int) -> Built:
    """The floating-frame body of Exudyn with these integrals, kept in the plane by constraints of its coordinates."""
    items, body = import_module("exudyn.itemInterface"), modal_rod(shapes)
    mbs = exu.SystemContainer().AddSystem()
    half, turn = rod.LENGTH / 2, np.sqrt(0.5)
    frame = mbs.AddNode(
        items.NodeRigidBodyEP(
            referenceCoordinates=[0, -half, 0, turn, 0, 0, -turn],
            initialVelocities=[rod.SPEED * half, 0, 0, rod.SPEED / 2 * turn, 0, 0, rod.SPEED / 2 * turn],
        )
    )
    zero = [0.0] * shapes
    amplitudes = mbs.AddNode(
        items.NodeGenericODE2(
            numberOfODE2Coordinates=shapes,
            referenceCoordinates=zero,
            initialCoordinates=zero,
            initialCoordinates_t=zero,
        )
    )
    number = mbs.AddObject(
        items.ObjectFFRFreducedOrder(nodeNumbers=[frame, amplitudes], **floating_frame_arguments(body))
    )
    ground = mbs.AddObject(items.ObjectGround())
    ends = [
        mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=ground)),
        mbs.AddMarker(items.MarkerSuperElementPosition(bodyNumber=number, meshNodeNumbers=[0], weightingFactors=[1.0])),
    ]
    mbs.AddObject(items.ObjectJointSpherical(markerNumbers=ends, constrainedAxes=[1, 1, 0]))
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for coordinate in (2, 4, 5):
        own = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=frame, coordinate=coordinate))
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, own]))
    weigh(mbs, number)
    sensor = mbs.AddSensor(
        items.SensorNode(
            nodeNumber=amplitudes,
            outputVariableType=exu.OutputVariableType.Coordinates,
            storeInternal=True,
            writeToFile=False,
        )
    )

    def deflection(alpha: np.ndarray) -> np.ndarray:
        return rod.deflection(*(point.position[:2] + alpha @ point.shapes[:, :2] for point in body.points))

    return mbs, sensor, deflection


def cables(exu: Any, elements: int) -> Built:
    """ANCF cable elements, which bend and stretch."""
    items, mbs = import_module("exudyn.itemInterface"), exu.SystemContainer().AddSystem()
    nodes = [
        mbs.AddNode(
            items.NodePoint2DSlope1(
                referenceCoordinates=[0, -s, 0, -1], initialVelocities=[rod.SPEED * s, 0, rod.SPEED, 0]
            )
        )
        for s in np.linspace(0.0, rod.LENGTH, elements + 1)
    ]
    for pair in pairwise(nodes):
        stiffness = {"bendingStiffness": rod.STIFFNESS, "axialStiffness": STRETCHING}
        given = {"length": rod.LENGTH / elements, "massPerLength": rod.MASS / rod.LENGTH, **stiffness}
        weigh(mbs, mbs.AddObject(items.ObjectANCFCable2D(nodeNumbers=list(pair), **given)))
    return pinned(exu, mbs, nodes)


def beams(exu: Any, elements: int) -> Built:
    """Geometrically exact beam elements with three nodes, which bend, stretch and shear."""
    items, mbs = import_module("exudyn.itemInterface"), exu.SystemContainer().AddSystem()
    nodes = [
        mbs.AddNode(
            items.NodeRigidBody2D(
                referenceCoordinates=[0, -s, -np.pi / 2], initialVelocities=[rod.SPEED * s, 0, rod.SPEED]
            )
        )
        for s in np.linspace(0.0, rod.LENGTH, 2 * elements + 1)
    ]
    line = rod.MASS / rod.LENGTH
    for n in range(elements):
        stiffness = {"bendingStiffness": rod.STIFFNESS, "axialStiffness": STRETCHING, "shearStiffness": SHEARING}
        inertia = {"massPerLength": line, "crossSectionInertia": line * rod.DIAMETER**2 / 16}
        given = {"length": rod.LENGTH / elements, **inertia, **stiffness}
        left, middle, right = nodes[2 * n : 2 * n + 3]
        beam = items.ObjectBeamGeometricallyExact2D(nodeNumbers=[left, middle, right], **given)
        weigh(mbs, mbs.AddObject(beam))
    return pinned(exu, mbs, nodes)


def pinned(exu: Any, mbs: Any, nodes: Sequence[int]) -> Built:
    """The first node is pinned; the sensor has the positions of the first node, the middle one and the last."""
    items = import_module("exudyn.itemInterface")
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for coordinate in (0, 1):
        own = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, own]))
    kind = {"outputVariableType": exu.OutputVariableType.Position, "storeInternal": True, "writeToFile": False}
    parts = [mbs.AddSensor(items.SensorNode(nodeNumber=nodes[i], **kind)) for i in (0, len(nodes) // 2, -1)]

    def together(mbs: Any, t: float, sensors: Sequence[int], factors: Any, configuration: Any) -> list[float]:
        return [x for sensor in sensors for x in mbs.GetSensorValues(sensor, configuration)[:2]]

    sensor = items.SensorUserFunction(
        sensorNumbers=parts, sensorUserFunction=together, storeInternal=True, writeToFile=False
    )
    return mbs, mbs.AddSensor(sensor), positions_to_deflection


def weigh(mbs: Any, body: int) -> None:
    """The weight of a body."""
    items = import_module("exudyn.itemInterface")
    marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, -rod.GRAVITY, 0]))
