"""The spun-up bracket by CalculiX, with large displacements, in a number of equal steps."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

END = 0.05
"""The end of the spin-up, s."""

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Run:
    """The mean displacement (n, 3), m, of the set `right` in the frame of the table at the times t (n,), s."""

    t: Array
    displacement: Array


@dataclass(frozen=True)
class Row:
    """A model or a run of CalculiX: its error, its CPU seconds of integration, and those before."""

    name: str
    coordinates: int
    error: float
    seconds: float
    before: float


def angle(t: Array, speed: float) -> Array:
    """The angle of the table, rad: its speed grows from 0 to `speed` (rad/s) within END."""
    return speed * (t**2 / (2 * END) + END / (4 * np.pi**2) * (np.cos(2 * np.pi * t / END) - 1))


def bracket_run(mesh: str, steps: int, speed: float, folder: Path) -> None:
    """Run `ccx` in a folder that it makes, with the results in run.dat.

    mesh: the input up to its first step. Each node of the set `left` has the displacement of the table, by a table.
    """
    positions, sets = _positions(mesh), _sets(mesh)
    t = np.linspace(0, END, steps + 1)
    turned = angle(t, speed)
    amplitudes, held = [], []
    for node in sets["left"]:
        x, y, _ = positions[node]
        paths = (np.cos(turned) - 1) * x - np.sin(turned) * y, np.sin(turned) * x + (np.cos(turned) - 1) * y
        for axis, path in enumerate(paths, 1):
            rows = [f"{time:.9g}, {value:.12g}" for time, value in zip(t, path, strict=True)]
            amplitudes += [f"*AMPLITUDE, NAME=A{node}_{axis}", *rows]
            held += [f"*BOUNDARY, AMPLITUDE=A{node}_{axis}", f"{node}, {axis}, {axis}, 1."]
        held += ["*BOUNDARY", f"{node}, 3, 3, 0."]
    step = [f"*STEP, NLGEOM, INC={2 * steps}", "*DYNAMIC, DIRECT", f"{END / steps:.12g}, {END:g}"]
    lines = [mesh.rstrip(), *amplitudes, *step, *held, "*NODE PRINT, NSET=right", "U", "*END STEP", ""]
    folder.mkdir(parents=True)
    (folder / "run.inp").write_text("\n".join(lines), encoding="utf-8")
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    subprocess.run(["ccx", "run"], cwd=folder, env=environment, check=True, capture_output=True)


def result(mesh: str, speed: float, folder: Path) -> Run:
    """The motion of the set `right` in the frame of the table, of a run in a folder."""
    positions = _positions(mesh)
    times, places = [0.0], [[positions[node] for node in _sets(mesh)["right"]]]
    for line in (folder / "run.dat").read_text(encoding="utf-8").splitlines():
        words = line.split()
        if "time" in words:
            times.append(float(words[-1]))
            places.append([])
        elif len(words) == 4:
            places[-1].append(positions[int(words[0])] + np.array([float(word) for word in words[1:]]))
    t, mean = np.array(times), np.array([np.mean(place, axis=0) for place in places])
    return Run(t, turned_back(mean, angle(t, speed)) - mean[0])


def turned_back(x: Array, turned: Array) -> Array:
    """Points (n, 3) in the frame of a table that has turned about z by angles (n,)."""
    c, s = np.cos(turned), np.sin(turned)
    return np.stack([c * x[:, 0] + s * x[:, 1], c * x[:, 1] - s * x[:, 0], x[:, 2]], axis=1)


def _positions(mesh: str) -> dict[int, Array]:
    rows = (line.split(",") for line in _lines(mesh, "*NODE,"))
    return {int(row[0]): np.array([float(x) for x in row[1:]]) for row in rows}


def _sets(mesh: str) -> dict[str, list[int]]:
    return {
        name: [int(n) for line in _lines(mesh, f"*NSET, NSET={name}") for n in line.strip(",").split(",")]
        for name in ("left", "right")
    }


def _lines(mesh: str, keyword: str) -> list[str]:
    """The data lines of a keyword."""
    lines = mesh.splitlines()
    (first,) = [number for number, line in enumerate(lines) if line.startswith(keyword)]
    data = []
    for line in lines[first + 1 :]:
        if line.startswith("*"):
            break
        data.append(line)
    return data
