"""The mechanisms that the numerics is tested on, with their guesses (q, v)."""

from __future__ import annotations

import numpy as np
from double import Array, Body, Condition, Double, Motion, Pin, Slide, Turn, steady

CRANK, ROD = 0.15, 0.3


def pendulum(length: float = 1.0) -> tuple[Double, Array, Array]:
    """A rod on a pin, hanging sideways at rest."""
    half = length / 2
    body = Body("bob", 2.0, 2.0 * length**2 / 12)
    model = Double((body,), (Pin("pin", None, (0, 0), "bob", (-half, 0)),), gravity=(0.0, -9.81))
    return model, np.array([half, 0.0, 0.0]), np.zeros(3)


def crank_slider(
    speed: float = 150.0, crank: float = CRANK, rod: float = ROD, angle: float = 0.0, extra: tuple[Condition, ...] = ()
) -> tuple[Double, Array, Array]:
    """A crank at constant speed drives a slider through a rigid rod, from the crank angle given."""
    bodies = (Body("crank", 0.1, 1e-3), Body("rod", 0.0667557, 5e-4), Body("slider", 0.0333778, 1e-6))
    conditions: tuple[Condition, ...] = (
        Pin("bearing", None, (0, 0), "crank", (-crank / 2, 0)),
        Pin("crank_pin", "crank", (crank / 2, 0), "rod", (-rod / 2, 0)),
        Pin("slider_pin", "rod", (rod / 2, 0), "slider", (0, 0)),
        Pin("guide", None, (0, 0), "slider", (0, 0), components=(1,)),
        Turn("guide_turn", None, "slider", steady(0.0)),
        *extra,
        Turn("motor", None, "crank", steady(speed, angle)),
    )
    tilt = np.arcsin(np.clip(-crank * np.sin(angle) / rod, -1, 1))
    pin = crank * np.array([np.cos(angle), np.sin(angle)])
    end = pin[0] + rod * np.cos(tilt)
    q = np.array([*pin / 2, angle, (pin[0] + end) / 2, pin[1] / 2, tilt, end, 0.0, 0.0])
    return Double(bodies, conditions), q, np.zeros(9)


def pushed_crank(at: float, speed: float, motion: Motion | None = None) -> tuple[Double, Array, Array]:
    """The crank mechanism, driven at the slider, whose coordinate is at + speed t, or a `motion`."""
    model, _, v = crank_slider()
    conditions = (*model.conditions[:-1], Slide("push", "slider", 0, motion or steady(speed, at)))
    bodies = tuple(Body(n, *model.diagonal[3 * i + 1 : 3 * i + 3]) for i, n in enumerate(model.bodies))
    angle = float(np.arccos(np.clip((CRANK**2 + at**2 - ROD**2) / (2 * CRANK * at), -1, 1)))
    return Double(bodies, conditions), crank_slider(angle=angle)[1], v


def four_bar(bars: int = 2) -> tuple[Double, Array, Array]:
    """A coupler of 1 m on `bars` parallel bars of 0.5 m: with three the last one says what the others say."""
    places = np.linspace(0, 1, bars)
    bodies = [Body("coupler", 1.0, 0.1)]
    conditions: list[Condition] = []
    for i, x in enumerate(places):
        name = "abcdef"[i]
        bodies.append(Body(name, 0.5, 0.01))
        conditions.append(Pin(f"foot_{name}", None, (float(x), 0.0), name, (-0.25, 0.0)))
        conditions.append(Pin(f"head_{name}", name, (0.25, 0.0), "coupler", (float(x) - 0.5, 0.0)))
    q = [0.5 + 0.5 * np.cos(1.0), 0.5 * np.sin(1.0), 0.0]
    for x in places:
        q += [x + 0.25 * np.cos(1.0), 0.25 * np.sin(1.0), 1.0]
    return Double(tuple(bodies), tuple(conditions), gravity=(0.0, -9.81)), np.array(q), np.zeros(len(q))
