"""Parameter estimation with CasADi: the bending stiffness of a pendulum from the motion of its tip.

The measurements are those of a simulation with 12 N m^2 and noise of 0.1 mm. The external function of the pendulum,
integrated by Runge-Kutta steps, gives the motion for any stiffness, and its exact derivatives through all steps those
of the residuals, with which IPOPT minimises the sum of squares (Gauss-Newton), from a guess of 5 N m^2. The number is
the estimated stiffness over the true one.
"""

import sys
from pathlib import Path

import casadi as ca
import numpy as np

import derive

TRUE, GUESS, NOISE = 12.0, 5.0, 1e-4  # N m^2, N m^2, m
DURATION, ROWS, STEPS = 0.15, 50, 6  # s; measurements; steps from one to the next


def pendulum(stiffness: float) -> derive.Scene:
    """Return a flexible pendulum that begins to swing, with its bending stiffness (N m^2) as a parameter."""
    return derive.scene(
        "pendulum",
        ground={"pivot": [0, 0]},
        gravity=[0, -9.81],
        bodies={
            "rod": {
                "mass": 0.5,
                "length": 1,
                "bending_stiffness": {"symbol": "EI", "default": stiffness},
                "ansatz": ["1", "xi", "xi^2"],
                "markers": {"root": -1, "tip": 1},
            }
        },
        joints={"pivot": {"kind": "revolute", "between": ["ground.pivot", "rod.root"]}},
        outputs={"tip": {"kind": "position", "marker": "rod.tip"}},
    )


def measured() -> np.ndarray:
    """Return the measured positions of the tip (2, ROWS), m."""
    motion = derive.simulate(pendulum(TRUE), duration=DURATION, output=DURATION / ROWS, tolerance=1e-9)
    exact = np.array([motion["tip_1"], motion["tip_2"]])[:, 1:]
    return exact + NOISE * np.random.default_rng(1).standard_normal(exact.shape)


def tip_positions(scene: derive.Scene) -> ca.Function:
    """Return the positions of the tip (2, ROWS), m, as a function of the stiffness."""
    host = derive.host_model(scene, sensitivities=True)
    function = derive.casadi_function(host)  # (t, x, u, p) -> (xdot, y)
    x, p, h = ca.MX.sym("x", len(host.states)), ca.MX.sym("p"), DURATION / ROWS / STEPS

    def rate(state: ca.MX) -> ca.MX:
        return function(0, state, 0, p)[0]

    k1 = rate(x)
    k2 = rate(x + h / 2 * k1)
    k3 = rate(x + h / 2 * k2)
    k4 = rate(x + h * k3)
    step = ca.Function("step", [x, p], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
    states = step.mapaccum(ROWS * STEPS)([variable.start for variable in host.states], p)
    outputs = function.map(ROWS)(0, states[:, STEPS - 1 :: STEPS], 0, p)[1]
    return ca.Function("tip", [p], [outputs])


def main(folder: str | None = None) -> float:
    """Return the estimated stiffness over the true one."""
    tip = tip_positions(pendulum(GUESS))
    p, weight, multipliers = ca.MX.sym("p"), ca.MX.sym("weight"), ca.MX.sym("multipliers", 0)
    measurements = measured()
    residual = ca.vec(tip(p) - measurements) / NOISE
    gauss_newton = weight * ca.sumsqr(ca.jacobian(residual, p))
    hessian = ca.Function("hessian", [p, ca.MX(0, 1), weight, multipliers], [gauss_newton])
    quiet = {"print_time": False, "hess_lag": hessian, "ipopt": {"print_level": 0, "sb": "yes"}}
    solver = ca.nlpsol("estimate", "ipopt", {"x": p, "f": ca.sumsqr(residual) / 2}, quiet)
    estimate = float(solver(x0=GUESS, lbx=0.1)["x"])
    print(f"{estimate:.4f} N m^2 after {solver.stats()['iter_count']} iterations; true: {TRUE} N m^2")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        times = 1e3 * DURATION / ROWS * np.arange(1, ROWS + 1)
        for name, stiffness in (("guess", GUESS), ("estimate", estimate)):
            axes.plot(times, 1e3 * np.array(tip(stiffness))[1], label=f"{name}: {stiffness:.3g} N m^2")
        axes.plot(times, 1e3 * measurements[1], "o", color="gray", markersize=3, label="measured")
        axes.set(xlabel="time, ms", ylabel="height of the tip, mm")
        axes.legend()
        figure.savefig(Path(folder) / "stiffness_from_motion.svg")
        plt.close(figure)
    return estimate / TRUE


if __name__ == "__main__":
    main(*sys.argv[1:])
