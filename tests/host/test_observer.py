"""A function that follows the rows of the C integrators: what it sees, and how it ends an integration."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from pendulums import LEVEL, REST, adaptive, alpha, fixed, ida

from derive.runtime.integrators.c_integrator import Integration

RUNS: dict[str, Callable[..., Integration]] = {
    "adaptive": lambda **more: adaptive().run(LEVEL, REST, [0.0, 0.2, 0.4, 0.6], rtol=1e-11, **more),
    "rk4": lambda **more: fixed().run(LEVEL, REST, step=1e-2, steps=60, every=20, **more),
    "alpha": lambda **more: alpha().run(LEVEL, REST, step=1e-2, steps=60, every=20, **more),
    "ida": lambda **more: ida().run(LEVEL, REST, interval=0.2, rows=4, rtol=1e-6, **more),
}
methods = pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)


@methods
def test_it_sees_each_row_as_soon_as_it_is_there(run: Callable[..., Integration]) -> None:
    seen: list[tuple[float, NDArray[np.float64]]] = []
    found = run(observe=lambda t, row: seen.append((t, row)) is not None)
    np.testing.assert_allclose([t for t, _ in seen], found.t, rtol=1e-15)
    assert np.array_equal([row for _, row in seen], np.hstack([found.q, found.v, found.lam]))
    assert np.array_equal(run().q, found.q), "what is observed changes nothing"


@methods
@pytest.mark.parametrize("last", [0, 2, 3])
def test_it_ends_the_integration_after_a_row(run: Callable[..., Integration], last: int) -> None:
    found, whole = run(observe=lambda t, row: t > 0.2 * last - 0.1), run()
    assert np.array_equal(found.t, whole.t[: last + 1])
    assert np.array_equal(found.q, whole.q[: last + 1]) and np.array_equal(found.lam, whole.lam[: last + 1])
    assert (found.counts["steps"] < whole.counts["steps"]) == (last < 3)


@methods
def test_its_exceptions_end_the_integration(run: Callable[..., Integration]) -> None:
    rows: list[float] = []

    def interrupted(t: float, row: NDArray[np.float64]) -> bool:
        rows.append(t)
        if len(rows) == 2:
            raise KeyboardInterrupt
        return False

    with pytest.raises(KeyboardInterrupt):
        run(observe=interrupted)
    assert len(rows) == 2


def test_many_states_have_none() -> None:
    with pytest.raises(ValueError, match="many states have no observer"):
        fixed().run([LEVEL], [REST], step=1e-2, steps=1, observe=lambda t, row: False)
