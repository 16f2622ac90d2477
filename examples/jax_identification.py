"""System identification with JAX: mass and bending stiffness of a flexible link from its motion under a known torque.

The exported module has no branches on data, so that JAX compiles the integration of 300 Runge-Kutta steps, and
differentiates it with respect to the parameters: Gauss-Newton needs the derivatives of all residuals. The measurements
are those of a simulation with 0.5 kg and 20 N m^2, with noise of 0.01 mm. The numbers are the estimated parameters over
the true ones.
"""

import importlib.util
import sys
import tempfile
from pathlib import Path

import numpy as np

import derive

TRUE, GUESS, NOISE = (0.5, 20.0), (0.6, 15.0), 1e-5  # kg and N m^2; m
DURATION, ROWS, STEPS = 0.15, 30, 10  # s; measurements; steps from one to the next


def link(mass: float, stiffness: float) -> derive.Scene:
    """Return a flexible link on a hinge with a torque, whose mass (kg) and stiffness (N m^2) are parameters."""
    arm = {"mass": {"symbol": "m", "default": mass}, "bending_stiffness": {"symbol": "EI", "default": stiffness}}
    return derive.scene(
        "link",
        ground={"hub": [0, 0]},
        bodies={"arm": {**arm, "length": 1, "ansatz": ["1", "xi", "xi^2"], "markers": {"root": -1, "tip": 1}}},
        joints={"hinge": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
        inputs={"torque": {"unit": "N m", "value": 1}},
        torques={"motor": {"at": "arm.root", "value": {"input": "torque"}}},
        outputs={"tip": {"kind": "position", "marker": "arm.tip"}},
    )


def exported(scene: derive.Scene):
    """Return the module of `tisserand export --to jax`."""
    with tempfile.TemporaryDirectory() as folder:
        derive.write(derive.exported(scene, "jax"), folder)
        spec = importlib.util.spec_from_file_location("link", Path(folder) / "link-jax" / "link.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return module


def main(folder: str | None = None) -> list[float]:
    """Return the estimated mass and stiffness over the true ones."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    motion = derive.simulate(link(*TRUE), duration=DURATION, output=DURATION / ROWS, tolerance=1e-9)
    exact = np.array([motion["tip_1"], motion["tip_2"]]).T[1:]
    measured = exact + NOISE * np.random.default_rng(1).standard_normal(exact.shape)
    module = exported(link(*GUESS))
    u, h = jnp.array(module.U), DURATION / ROWS / STEPS

    def step(x, p):
        k1 = module.rhs(0.0, x, u, p)[0]
        k2 = module.rhs(0.0, x + h / 2 * k1, u, p)[0]
        k3 = module.rhs(0.0, x + h / 2 * k2, u, p)[0]
        k4 = module.rhs(0.0, x + h * k3, u, p)[0]
        return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)

    @jax.jit
    def tips(p):
        states = jax.lax.scan(lambda x, _: (step(x, p),) * 2, jnp.array(module.X), length=ROWS * STEPS)[1]
        return jax.vmap(lambda x: module.rhs(0.0, x, u, p)[1])(states[STEPS - 1 :: STEPS])

    def residuals(p):
        return (tips(p) - measured).ravel()

    p, jacobian = np.array(GUESS), jax.jit(jax.jacfwd(residuals))
    for _ in range(6):
        p = p - np.linalg.lstsq(jacobian(p), residuals(p), rcond=None)[0]
        print(f"m = {p[0]:.5f} kg, EI = {p[1]:.4f} N m^2: residual {np.linalg.norm(residuals(p)):.3g} m")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        for name, values in (("guess", np.array(GUESS)), ("estimate", p)):
            axes.plot(*np.array(tips(values)).T, label=f"{name}: {values[0]:.3g} kg, {values[1]:.3g} N m^2")
        axes.plot(*measured.T, "o", color="gray", markersize=3, label="measured")
        axes.set(xlabel="position of the tip x1, m", ylabel="x2, m")
        axes.legend()
        figure.savefig(Path(folder) / "jax_identification.svg")
        plt.close(figure)
    return [float(value) for value in p / np.array(TRUE)]


if __name__ == "__main__":
    main(*sys.argv[1:])
