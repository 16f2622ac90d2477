"""Optimal control with CasADi: a flexible link turns by 90 degrees and comes to rest without vibration.

The external function of the link, with exact derivatives, is the right-hand side of a problem that IPOPT solves: the
torque of least square from rest to rest, by Hermite-Simpson collocation. The numbers are the speed of the tip (m/s)
and the deflection (m) that are left when `derive.simulate` applies a torque with its own integrator: first one that
turns a rigid link by 90 degrees, then the optimal one.
"""

import sys
from pathlib import Path

import casadi as ca
import numpy as np

import derive

DURATION, INTERVALS, ANGLE = 1.0, 100, np.pi / 2
TIMES = np.linspace(0, DURATION, INTERVALS + 1)
RIGID = ANGLE / DURATION**2 * (1 - 2 * TIMES / DURATION)  # N m, with m l^2/3 = 1/6 kg m^2
ARM = {
    **{"mass": 0.5, "length": 1},
    "bending_stiffness": 5,
    "ansatz": ["1", "xi", "xi^2"],
    "frame": {"kind": "tangent", "at": -1},
    "markers": {"root": -1, "tip": 1},
}
OPTIONS = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory"}}


def link() -> derive.Scene:
    """Return a flexible link on a hinge, in the frame of its root, where a torque acts."""
    return derive.scene(
        "link",
        ground={"hub": [0, 0]},
        bodies={"arm": ARM},
        joints={"hinge": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
        inputs={"torque": {"unit": "N m", "value": 0}},
        torques={"motor": {"at": "arm.root", "value": {"input": "torque"}}},
        outputs={"speed": {"kind": "velocity", "marker": "arm.tip"}},
    )


def simulated(scene: derive.Scene, torque: np.ndarray) -> derive.Trajectory:
    """Return the motion under a torque (N m) that is given at the nodes."""
    follow = {"torque": lambda t: float(np.interp(t, TIMES, torque))}
    return derive.simulate(scene, duration=DURATION, output=DURATION / INTERVALS, tolerance=1e-9, inputs=follow)


def optimal_torque(scene: derive.Scene, guess: derive.Trajectory) -> np.ndarray:
    """Return the optimal torque (N m) at the nodes; the states of another motion are the guess."""
    host = derive.host_model(scene, sensitivities=True)
    function = derive.casadi_function(host)  # (t, x, u, p) -> (xdot, y)
    names = [variable.name for variable in host.states]
    start = np.array([variable.start for variable in host.states])
    end = {"arm_phi": ANGLE, "arm_phidot": 0, "arm_alpha1": 0, "arm_alpha1dot": 0}  # joints give the other states
    h, nodes = DURATION / INTERVALS, INTERVALS + 1
    x, u = ca.MX.sym("x", len(names), nodes), ca.MX.sym("u", 1, nodes)
    f, _ = function.map(nodes)(0, x, u, 0)
    x0, x1, f0, f1 = x[:, :-1], x[:, 1:], f[:, :-1], f[:, 1:]
    fm, _ = function.map(INTERVALS)(0, (x0 + x1) / 2 + h / 8 * (f0 - f1), (u[:, :-1] + u[:, 1:]) / 2, 0)
    defects = x1 - x0 - h / 6 * (f0 + 4 * fm + f1)
    rest = [x[names.index(name), -1] - value for name, value in end.items()]
    conditions = ca.veccat(defects, x[:, 0] - start, *rest)
    problem = {"x": ca.veccat(x, u), "f": h * ca.sumsqr(u), "g": conditions}
    solver = ca.nlpsol("slewing", "ipopt", problem, OPTIONS)
    states = np.hstack([guess.solution.q, guess.solution.v])
    result = solver(x0=np.append(states.ravel(), RIGID), lbg=0, ubg=0)
    print(f"IPOPT: {solver.stats()['return_status']} for {problem['x'].numel()} unknowns")
    return np.array(result["x"]).ravel()[-nodes:]


def main(folder: str | None = None) -> list[tuple[float, float]]:
    """Return what is left of speed (m/s) and deflection (m) by the torque of a rigid link, and by the optimal one."""
    rigid = simulated(scene := link(), RIGID)
    optimal = simulated(scene, torque := optimal_torque(scene, rigid))
    left = [(abs(motion["speed_1"][-1]), abs(motion["arm_alpha1"][-1])) for motion in (rigid, optimal)]
    for (speed, deflection), name in zip(left, ("of a rigid link", "that is optimal"), strict=True):
        print(f"the torque {name} leaves {speed:.2g} m/s and {deflection:.2g} m")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(2, sharex=True)
        for name, values, motion in (("of a rigid link", RIGID, rigid), ("optimal", torque, optimal)):
            axes[0].plot(TIMES, values, label=name)
            axes[1].plot(motion["t"], 1e3 * motion["arm_alpha1"])
        axes[0].set(ylabel="torque, N m")
        axes[1].set(xlabel="time, s", ylabel="deflection, mm")
        axes[0].legend()
        figure.savefig(Path(folder) / "optimal_slewing.svg")
        plt.close(figure)
    return left


if __name__ == "__main__":
    main(*sys.argv[1:])
