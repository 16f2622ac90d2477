"""Evaluate the accelerations of many states in one call.

The generated `accel_batch` loops over states in a structure of arrays, which compilers turn into vector instructions.
Its results equal those of one call for each state bit for bit. The number is the largest difference: exactly zero.
"""

import time

import numpy as np

import derive


def main() -> float:
    """Return the largest difference between the batch and single calls."""
    beam = derive.planar_beam("batch", frame={"kind": "point", "at": 0})
    native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
    k = native.setup()
    random = np.random.default_rng(0)
    q, v = random.uniform(-0.3, 0.3, (2, 10_000, 5))
    start = time.perf_counter()
    batch = native.accel_batch(0.0, q, v, k)
    batch_seconds = time.perf_counter() - start
    single = np.array([native.accel(0.0, *state, k) for state in zip(q, v, strict=True)])
    single_seconds = time.perf_counter() - start - batch_seconds
    print(f"10 000 states: {1e3 * batch_seconds:.1f} ms in one call, {1e3 * single_seconds:.1f} ms in 10 000 calls")
    return float(np.abs(batch - single).max())


if __name__ == "__main__":
    main()
