"""Mass matrices as NumPy arrays and as SciPy sparse matrices.

The compiled functions return the structural non-zeros only; a pattern turns them into a dense or a sparse matrix. The
crank-slider with a rod of three beams has 16 coordinates. Its KKT matrix is assembled here from M and G and solved by
SciPy. The number is the largest difference to the accelerations of the generated LDL^T, relative to the largest one.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

import derive

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"


def main(folder: str | None = None) -> float:
    """Return the largest relative difference of the accelerations."""
    scene = derive.read(SCENE)
    native = derive.load_scene(derive.model_files(derive.lower(derive.derive(scene)), scene))
    k = native.setup()
    random = np.random.default_rng(2)
    q = 0.1 * random.standard_normal(native.nq)
    v = random.standard_normal(native.nv)
    values, h = native.mass_force(0.0, q, v, k)
    mass = native.mass_pattern.sparse(values)
    jacobian = native.constraint_pattern.sparse(native.constraint_jacobian(0.0, q, k))
    assert np.array_equal(mass.toarray(), native.mass_pattern.dense(values))
    kkt = scipy.sparse.block_array([[mass, -jacobian.T], [-jacobian, None]], format="csc")
    right = np.concatenate([-h, -native.constraint_bias(0.0, q, v, k)])
    solution = scipy.sparse.linalg.spsolve(kkt, right)[: native.nv]
    vdot = native.accel(0.0, q, v, k)
    print(f"{mass.nnz} non-zeros in M, {kkt.nnz} in the KKT matrix of {kkt.shape[0]} rows")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(figsize=(5, 5))
        axes.spy(kkt, markersize=5, color="C2")
        axes.set(xlabel="column: accelerations, multipliers", ylabel="row: equations of motion, constraints")
        figure.savefig(Path(folder) / "dense_and_sparse.svg")
        plt.close(figure)
    return float(np.abs(solution - vdot).max() / np.abs(vdot).max())


if __name__ == "__main__":
    main(*sys.argv[1:])
