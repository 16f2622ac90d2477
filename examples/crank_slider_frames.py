"""The crank-slider of the paper in two floating frames.

The connecting rod of scenes/crank_slider_3.toml is one beam here, once in the mean frame and once in the frame of its
midpoint. Both models predict nearly the same deflection, but the mass matrix of the first has fewer non-zeros. The
numbers are, for each frame, the non-zeros and the largest deflection of the middle of the rod over its length.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import derive

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"


def with_rod(scene: derive.Scene, frame: derive.Frame) -> derive.Scene:
    """Return the scene with the rod as one beam in a frame."""
    crank, rod, slider = scene.bodies
    beam = replace(rod.beam, frame=frame, orthogonal=frame.kind == "mean")
    return replace(scene, bodies=(crank, replace(rod, beam=beam, pieces=1), slider), plots=())


def main(folder: str | None = None) -> dict[str, tuple[int, float]]:
    """Return the non-zeros of M and the largest deflection over the length by frame."""
    scene = derive.read(SCENE)
    result, curves = {}, {}
    for frame in (derive.Frame("mean"), derive.Frame("point", at=0)):
        trajectory = derive.simulate(with_rod(scene, frame))
        a1, a2 = trajectory["rod_alpha1"], trajectory["rod_alpha2"]
        if frame.kind == "mean":  # P2 and P3 at the left end, in the middle, and at the right end
            left, middle, right = a1 - a2, -a1 / 2, a1 + a2
        else:  # xi^2 and xi^3
            left, middle, right = a1 - a2, 0 * a1, a1 + a2
        chord = np.hypot(0.3, right - left)
        deflection = (middle - (left + right) / 2) * 0.3 / chord / 0.3
        nonzeros = trajectory.model.pattern("mass", "M").full_nnz
        curves[frame.kind] = trajectory["motor"], deflection
        result[frame.kind] = nonzeros, float(deflection.max())
        print(f"{frame.kind:>5} frame: {nonzeros:2} non-zeros, largest deflection {deflection.max():.7f} of the length")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        for name, (angle, curve) in curves.items():
            axes.plot(angle, curve, label=f"{name} frame", linestyle="--" if name == "point" else "-")
        axes.set(xlabel="crank angle, rad", ylabel="deflection of the middle, of the length")
        axes.legend()
        figure.savefig(Path(folder) / "crank_slider_frames.svg")
        plt.close(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
