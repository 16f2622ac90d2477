"""The buckling of a shaft under torque beside the theory of Greenhill."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre
from test_space_stability import CRITICAL, GROUND, RIGHT, compiled, rod

import derive
from derive.study.stability.eigenvalues import Eigenvalues


def twisted(count: int, stiffness: float = 1000.0) -> Callable[..., Eigenvalues]:
    """A shaft between a ball joint and a point on a line under opposite torques at its ends, and a thrust P (N).

    M, N (N m): the torques whose axes stay along the line, and that turn with the ends of the shaft.
    """
    torques = {
        f"{symbol}_{end}": {"on": f"rod.{end}", "torque": axis, "frame": frame}
        for symbol, frame in (("M", "inertial"), ("N", "body"))
        for end, sign in (("left", "-"), ("right", ""))
        for axis in [[f"{sign}{symbol}", 0, 0] if frame == "inertial" or end == "right" else [0, 0, f"{sign}{symbol}"]]
    }
    scene = derive.spatial_scene(
        "twisted",
        parameters={"M": {"default": 0}, "N": {"default": 0}, "P": {"default": 0}},
        ground=GROUND,
        bodies={
            "rod": rod(
                ansatz=[f"xi^{power}" for power in range(count + 2)], torsion={"ansatz": ["xi"], "stiffness": stiffness}
            )
        },
        joints={"left": {"kind": "spherical", "between": ["ground.left", "rod.left"]}, "right": RIGHT},
        torques=torques,
        forces={"thrust": {"at": "rod.right", "force": ["-P", 0, 0]}},
        start="steady",
    )
    return compiled(scene)


def ritz(count: int, torque: float, part: float, thrust: float) -> np.ndarray:
    """The squares of the frequencies of v + i w of a shaft under torque, by polynomials that vanish at its ends.

    part: of the torque, that stays along the line; the rest turns with the ends. In the moment M (t - part u') of a
    section the torque along the tangent t has the bending moment -i M u', which does work int u''* i M u' dx on the
    curvature; at the ends those that turn along have none, by int u'* i M u'' dx.
    """
    shapes = [Polynomial([0, 1, -1]) * Legendre.basis(k, [0, 1]).convert(kind=Polynomial) for k in range(count)]

    def integral(a: Polynomial, b: Polynomial) -> float:
        whole = (a * b).integ()
        return float(whole(1) - whole(0))

    d = [(f, f.deriv(), f.deriv(2)) for f in shapes]
    K = np.array(
        [
            [
                integral(a[2], b[2])
                - thrust * integral(a[1], b[1])
                - 1j * torque * (part * integral(a[2], b[1]) - (1 - part) * integral(a[1], b[2]))
                for b in d
            ]
            for a in d
        ]
    )
    M = np.array([[integral(a[0], b[0]) for b in d] for a in d])
    return np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)


@pytest.mark.long
def test_a_shaft_buckles_under_torque_as_that_of_greenhill() -> None:
    """Torques along the line, torques that turn with the ends, and half of each, against a Ritz solution of its own.

    The first two have the criterion (M/(2 EI))^2 + P/EI = (pi/l)^2, of which four shapes know 6.483 for 2 pi. Half of
    each is a conservative torque, which buckles earlier.
    """
    at = twisted(4)
    for torque, part, thrust in ((6.0, 1.0, 0.0), (6.0, 0.0, 0.0), (4.0, 0.5, 0.0), (4.0, 1.0, 5.0), (7.0, 1.0, 0.0)):
        own = at(M=part * torque, N=(1 - part) * torque, P=thrust)
        squares = ritz(4, torque, part, thrust)
        assert own.growing == 2 * (squares[0] < 0)
        if own.growing:
            assert own.growth == pytest.approx(np.sqrt(-squares[0]), rel=1e-4)
        else:
            assert own.frequencies[0] == pytest.approx(np.sqrt(squares[0]), rel=1e-4)
    for thrust in (0.0, 5.0, 9.0):  # the Ritz solution, and so the model, tends to the closed form
        exact = 2 * np.sqrt(CRITICAL - thrust)
        assert ritz(8, 0.999 * exact, 1.0, thrust)[0] > 0 > ritz(8, 1.001 * exact, 1.0, thrust)[0]
