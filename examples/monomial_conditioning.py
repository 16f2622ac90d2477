"""Monomials are a poor basis for many assumed modes.

In the point frame the shape functions are xi^2, xi^3, ..., and the elastic part c8 of the mass matrix is a part of a
Hilbert matrix, int xi^(i+j) dxi, whose condition number grows exponentially. In the mean frame Tisserand makes the
shape functions orthogonal, and c8 is diagonal. The numbers are the condition numbers for ten shape functions.
"""

import sys
from pathlib import Path

import numpy as np

import derive

SHAPES = 10


def condition_number(frame: object, shapes: int) -> float:
    """Return the condition number of the elastic part of the mass matrix at rest."""
    ansatz = [f"xi^{n}" for n in range(shapes + 2)]
    beam = derive.planar_beam("beam", ansatz=ansatz, frame=frame, mass=1, length=1, bending_stiffness=1)
    model = derive.lower(derive.derive(beam))
    q = [0.0] * (shapes + 3)
    setup = derive.interpret(model.kernel("setup"), {"p": []})
    values = derive.interpret(model.kernel("mass"), {"q": q, "k": setup["k"]})["M"]
    mass = np.zeros((len(q), len(q)))
    for (row, column), value in zip(model.pattern("mass", "M").entries, values, strict=True):
        mass[row, column] = mass[column, row] = value
    return float(np.linalg.cond(mass[3:, 3:]))


def main(folder: str | None = None) -> tuple[float, float]:
    """Return the condition numbers of c8 in the point frame and in the mean frame."""
    result = condition_number({"kind": "point", "at": 0}, SHAPES), condition_number("mean", SHAPES)
    print(
        f"condition number of c8 with {SHAPES} shape functions: {result[0]:.3g} monomials, {result[1]:.3g} orthogonal"
    )
    if folder is not None:
        import matplotlib.pyplot as plt

        counts = range(2, SHAPES + 1, 2)
        figure, axes = plt.subplots()
        axes.semilogy(counts, [condition_number({"kind": "point", "at": 0}, n) for n in counts], label="monomials")
        axes.semilogy(counts, [condition_number("mean", n) for n in counts], label="orthogonal shape functions")
        axes.set(xlabel="number of shape functions", ylabel="condition number of c8")
        axes.legend()
        figure.savefig(Path(folder) / "monomial_conditioning.svg")
        plt.close(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
