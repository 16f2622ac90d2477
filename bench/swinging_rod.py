"""A flexible rod that swings about a pin, as a specification and as an independent reference: swinging_rod.csv.

    python bench/swinging_rod.py bench/swinging_rod.csv

The rod is inextensible, has no inertia of rotation of its sections, and swings up from below, where it is straight.
The reference knows neither beams nor floating frames: the angle of the tangent is a polynomial of the arc length,
theta(s, t) = sum a_k(t) P_k(s), and the place of a section is the integral of (cos theta, sin theta), exactly. Its two
columns, with different numbers of polynomials, state its own error.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp

from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

LENGTH, MASS, STIFFNESS, GRAVITY, SPEED, DURATION = 1.0, 0.1, 2.5, 9.81, 6.0, 0.5
DIAMETER = 0.004
"""The diameter, m, of a round section with this bending stiffness, from which the axial stiffness of cables follows."""
POINTS = ("left", "middle", "right")
ROWS = 501
REFERENCE = Path(__file__).parent / "swinging_rod.csv"
TEXT = f"""
name = "swinging_rod"
ground.markers = {{ pin = [0, 0] }}
scene.gravity = [0, -{GRAVITY}]

[bodies.rod]
mass = {MASS}
length = {LENGTH}
bending_stiffness = {STIFFNESS}
ansatz = [ANSATZ]
frame = "mean"
markers = {{ left = -1, middle = 0, right = 1 }}
start = {{ angle = -1.5707963267948966 }}

[joints.pin]
kind = "revolute"
between = ["ground.pin", "rod.left"]
start = {{ speed = {SPEED} }}

[outputs]
left = {{ kind = "position", marker = "rod.left" }}
middle = {{ kind = "position", marker = "rod.middle" }}
right = {{ kind = "position", marker = "rod.right" }}

[simulation]
duration = {DURATION}
output = {DURATION / (ROWS - 1)}
"""


def scene(shapes: int, order: int = 1) -> Scene:
    """The rod as one beam with the Legendre polynomials P2, P3, ... as so many shapes."""
    monomials = ", ".join(f'"{text}"' for text in ("1", "xi", *(f"xi^{n}" for n in range(2, shapes + 2))))
    text = TEXT.replace("ANSATZ", monomials)
    if order != 1:
        text = text.replace('frame = "mean"', f'frame = "mean"\norder = {order}')
    spec = parse(text)
    assert isinstance(spec, Scene)
    return spec


def times() -> np.ndarray:
    return np.linspace(0.0, DURATION, ROWS)


def deflection(left: np.ndarray, middle: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The deflection of the middle (n, 2) from the chord, over the length."""
    chord, arm = right - left, middle - left
    return (chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / np.hypot(*chord.T) / LENGTH


def error(values: np.ndarray) -> float:
    """The rms difference of deflections (ROWS,) from the reference, over its peak."""
    known = reference()[:, -1]
    return float(np.sqrt(np.mean((values - known) ** 2)) / np.abs(known).max())


def uncertainty() -> float:
    """The rms difference of the two references over the peak: the error of the first, more than that of the second."""
    _, few, many = reference().T
    return float(np.sqrt(np.mean((few - many) ** 2)) / np.abs(many).max())


def reference() -> np.ndarray:
    """The rows t, the deflection with fewer and with more polynomials."""
    with REFERENCE.open() as table:
        return np.array([[float(cell) for cell in row] for row in list(csv.reader(table))[1:]])


def exact_rod(polynomials: int, points: int = 32, tolerance: float = 1e-9) -> np.ndarray:
    """The deflection (ROWS,) of the rod with so many polynomials of the angle, by Gauss quadrature in s."""
    x, weights = legendre.leggauss(points)
    weights = weights * LENGTH / 2
    P = legendre.legvander(x, polynomials - 1)
    slopes = np.stack([legendre.legval(x, legendre.legder(unit)) for unit in np.eye(polynomials)], axis=1)
    K = STIFFNESS * (2 / LENGTH) ** 2 * (slopes.T * weights) @ slopes
    interpolate = np.linalg.inv(legendre.legvander(x, points - 1))

    def integral(ends: np.ndarray) -> np.ndarray:
        """Rows that integrate from the pin to an end what is given at the quadrature points."""
        integrals = [legendre.legval(ends, legendre.legint(unit, lbnd=-1)) for unit in np.eye(points)]
        return LENGTH / 2 * np.stack(integrals, axis=1) @ interpolate

    S, mass = integral(x), MASS / LENGTH * weights

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        angle, speed = P @ y[:polynomials], P @ y[polynomials:]
        c, s = np.cos(angle), np.sin(angle)
        J = S @ (-s[:, None] * P), S @ (c[:, None] * P)
        bias = S @ (-c * speed**2), S @ (-s * speed**2) + GRAVITY
        M = sum((j.T * mass) @ j for j in J)
        force = sum(j.T @ (mass * b) for j, b in zip(J, bias, strict=True)) + K @ y[:polynomials]
        return np.concatenate([y[polynomials:], -np.linalg.solve(M, force)])

    start = np.zeros(2 * polynomials)
    start[0], start[polynomials] = -np.pi / 2, SPEED
    solution = solve_ivp(rates, (0, DURATION), start, "DOP853", times(), rtol=tolerance, atol=1e-2 * tolerance)
    ends = integral(np.array([0.0, 1.0]))
    angles = P @ solution.y[:polynomials]
    middle, right = np.stack([ends @ np.cos(angles), ends @ np.sin(angles)], axis=-1)
    return deflection(np.zeros_like(middle), middle, right)


def main() -> None:
    """Write the reference to the file that is given."""
    columns = {n: exact_rod(n) for n in (8, 10)}
    with Path(sys.argv[1]).open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["t_s", *(f"deflection_over_L_{n}_polynomials" for n in columns)])
        table.writerows(
            [f"{t:.4g}", *(f"{v:.7e}" for v in row)] for t, *row in zip(times(), *columns.values(), strict=True)
        )
    print(f"error {uncertainty():.1e} of the peak")


if __name__ == "__main__":
    main()
