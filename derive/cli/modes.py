"""`tisserand modes`: natural frequencies, damping ratios and mode shapes of a model about a state; its state space."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from derive.artifacts import File, write
from derive.errors import SpecError
from derive.simulation.linear.eigenmodes import ComplexVector, Mode
from derive.simulation.linear.modes import Modes, modes
from derive.simulation.observables.csv_writer import Column, csv
from derive.spec.model.scene import Scene
from derive.spec.toml.read import read, with_lines
from derive.terminal import magnitude, show_progress, table
from derive.visual.mode_pages import modes_page, modes_picture

REAL = 1e-6
"""An imaginary part of a normalised shape below this is not printed."""


def run(options: argparse.Namespace) -> int:
    """Compute the modes, write their files, and print them."""
    spec = read(options.spec)
    show_progress(f"{spec.name}: deriving, compiling and linearising ...")
    try:
        result = modes(spec, at=options.at)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    finally:
        show_progress()
    files = write_modes(result, options.count, options.out)
    summary = {**modes_data(result), "files": files}
    print(json.dumps(summary, indent=2) if options.json else _text(result, options.count, files))
    return 0


def write_modes(result: Modes, count: int, folder: Path) -> list[str]:
    """Write the table, the state space and, of a scene, the picture and the animation; return the names of the files.

    count: the number of modes that are drawn.
    """
    stem = f"{result.spec.name}/{result.spec.name}.modes"
    files = [File(f"{stem}.csv", csv(f"The modes of {result.spec.name}.", _columns(result)))]
    if isinstance(result.spec, Scene) and any(mode.eigenvalue for mode in result.modes):
        files.append(File(f"{stem}.svg", modes_picture(result, count)))
        files.append(File(f"{stem}.html", modes_page(result, count)))
    write(files, folder)
    return [str(folder / file.path) for file in files]


def modes_data(result: Modes) -> dict[str, Any]:
    """The modes as plain data, in SI units; a shape has the real and the imaginary part of each element."""
    linear = result.linear
    return {
        "name": result.spec.name,
        "time": linear.t,
        "q": linear.q.tolist(),
        "v": linear.v.tolist(),
        "vdot": linear.vdot.tolist(),
        "coordinates": list(result.native.coordinates),
        "zero_eigenvalues": result.zero_eigenvalues,
        "modes": [
            {
                "frequency": mode.frequency,
                "damping_ratio": mode.damping_ratio,
                "eigenvalue": [mode.eigenvalue.real, mode.eigenvalue.imag],
                "shape": [mode.shape.real.tolist(), mode.shape.imag.tolist()],
            }
            for mode in result.modes
        ],
        "states": list(linear.states),
        "inputs": list(linear.inputs),
        "outputs": list(linear.outputs),
    }


def _columns(result: Modes) -> list[Column]:
    """A row for each mode: frequency, damping ratio, eigenvalue, and the elements of the shape."""
    modes = result.modes
    values = np.array([mode.eigenvalue for mode in modes], dtype=complex)
    shapes = np.array([mode.shape for mode in modes], dtype=complex).reshape(len(modes), result.native.nq)
    columns = [
        Column("mode", "", np.arange(1.0, len(modes) + 1)),
        Column("frequency", "Hz", result.frequencies),
        Column("damping_ratio", "", result.damping_ratios),
        Column("eigenvalue_real", "1/s", values.real),
        Column("eigenvalue_imag", "rad/s", values.imag),
    ]
    for name, elements in zip(result.native.coordinates, shapes.T, strict=True):
        columns += [Column(f"{name}_real", "", elements.real), Column(f"{name}_imag", "", elements.imag)]
    return columns


def _text(result: Modes, count: int, files: Sequence[str]) -> str:
    linear, shown = result.linear, result.modes[:count]
    lines = [f"{result.spec.name}: {len(result.modes)} modes about {_state(result)}"]
    rows = [["mode", "frequency, Hz", "damping ratio", "eigenvalue, 1/s"]]
    rows += [[str(i), *_mode(mode)] for i, mode in enumerate(shown, 1)]
    lines += table(rows)
    if result.zero_eigenvalues:
        lines.append(f"  {result.zero_eigenvalues} eigenvalues are zero: motions without stiffness")
    if growing := [str(i) for i, mode in enumerate(result.modes, 1) if _grows(mode)]:
        lines.append(f"  warning: the state is unstable; mode {', '.join(growing)} grows")
    if len(shown) < len(result.modes):
        lines.append(f"  ... the first {len(shown)} of {len(result.modes)} modes; --count N or --json prints more")
    if shown:
        lines += ["", "shapes, the largest element of each is 1 (m, rad):"]
        rows = [["", *(str(i + 1) for i in range(len(shown)))]]
        for j, name in enumerate(result.native.coordinates):
            rows.append([name, *_elements([mode.shape for mode in shown], j)])
        lines += table(rows)
    sizes = f"{len(linear.states)} states, {len(linear.inputs)} inputs, {len(linear.outputs)} outputs"
    lines += ["", f"state space: {sizes} (forces at markers, and displacements of markers, in the inertial frame)"]
    return "\n".join([*lines, *(f"wrote {file}" for file in files)])


def _state(result: Modes) -> str:
    """The state, and whether it is an equilibrium, in words."""
    if not isinstance(result.spec, Scene):
        return "the undeformed state at rest"
    at = f"the state at t = {result.linear.t:g} s"
    if not result.speed and result.acceleration <= 1e-6:
        return f"{at}, an equilibrium (accelerations up to {magnitude(result.acceleration)})"
    return (
        f"{at}, no equilibrium (generalised velocities up to {result.speed:.3g}, accelerations up to "
        f"{result.acceleration:.3g}); the coefficients are those of that instant"
    )


def _grows(mode: Mode) -> bool:
    """Whether a mode grows by more than rounding errors."""
    return mode.damping_ratio < -1e-9


def _mode(mode: Mode) -> list[str]:
    value, ratio = mode.eigenvalue, mode.damping_ratio
    real = f"{value.real:.6g}" if abs(ratio) > 1e-12 else "0"
    text = f"{real} ± {value.imag:.6g}i" if value.imag else real
    return [f"{mode.frequency:.6g}", f"{ratio:.4g}" if abs(ratio) > 1e-12 else "0", text]


def _elements(shapes: Sequence[ComplexVector], j: int) -> list[str]:
    """Element j of each shape: a number or, of a shape with phases, its size and its phase in degrees."""
    texts = []
    for shape in shapes:
        value = shape[j]
        if np.abs(shape.imag).max() < REAL:
            texts.append(
                f"{value.real:.4f}" if abs(value.real) >= 5e-5 else "0" if value.real == 0 else f"{value.real:.1e}"
            )
        else:
            texts.append(f"{abs(value):.4f}∠{np.degrees(np.angle(value)):.0f}°")
    return texts
