"""The choice of the floating frame decides how many entries of the mass matrix vanish.

The same free beam with two assumed modes is derived in the frame of its midpoint and in the mean frame, which follows
the average motion of the beam. The picture shows the pattern of both mass matrices. The numbers are the structural
non-zeros of the 25 entries: 15 in the point frame, 5 in the mean frame (Koppens, Sauren, Veldpaus & van Campen 1988).
"""

import sys
from pathlib import Path

import derive


def main(folder: str | None = None) -> tuple[int, int]:
    """Return the structural non-zeros in the point frame and in the mean frame."""
    counts = []
    patterns = []
    for frame in ({"kind": "point", "at": 0}, "mean"):
        equations = derive.derive(derive.planar_beam("beam", frame=frame)).expanded()
        pattern = derive.lower(equations).pattern("mass", "M")
        counts.append(pattern.full_nnz)
        patterns.append(pattern)
    print(f"non-zeros of the mass matrix: {counts[0]} in the point frame, {counts[1]} in the mean frame")
    if folder is not None:
        draw(patterns, Path(folder) / "mean_or_point_frame.svg")
    return counts[0], counts[1]


def draw(patterns: list, path: Path) -> None:
    """Draw the two patterns side by side."""
    import matplotlib.pyplot as plt
    import numpy as np

    figure, panels = plt.subplots(1, 2, figsize=(7, 3.5))
    for panel, pattern, title in zip(panels, patterns, ("point frame", "mean frame"), strict=True):
        matrix = np.zeros((pattern.rows, pattern.cols))
        for row, column in pattern.entries:
            matrix[row, column] = matrix[column, row] = 1
        panel.spy(matrix, markersize=14, color="C2")
        panel.set_title(title)
    figure.savefig(path)
    plt.close(figure)


if __name__ == "__main__":
    main(*sys.argv[1:])
