"""`tisserand modes`: natural frequencies, damping ratios and mode shapes of a model about a state; its state space."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence

import numpy as np

from derive.artifacts import BinaryFile, File, check_folder, write
from derive.cli.result_files import drawing
from derive.cli.specifications import read_changed
from derive.errors import SpecError
from derive.notes.conditioning import condition_warnings
from derive.progress_line import show_progress
from derive.simulation.linear.eigenmodes import ComplexVector, Mode
from derive.simulation.linear.mode_files import mode_files, modes_data
from derive.simulation.linear.modes import Modes, modes
from derive.simulation.linear.whirl import whirls
from derive.spec.model.body import SymbolicBody
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import warnings, with_lines
from derive.terminal import SimulationProgress, magnitude, table, wrapped
from derive.visual.mode_pages import is_drawn, modes_page, modes_picture

NEGLIGIBLE = 1e-6
"""Imaginary parts of a normalised shape below this are not printed."""
ROUNDING = 1e-9
"""Damping ratios and elements of a normalised shape below this are printed as 0."""
EXPECTED_SIZE = 2_000_000
"""The approximate size of all files, in bytes."""


def run(options: argparse.Namespace) -> int:
    """Compute the modes, write their files, and print them."""
    spec, changes = read_changed(options.spec, options.set)
    check_folder(_planned_files(spec.name), options.out, EXPECTED_SIZE)
    show_progress(f"{spec.name}: deriving, compiling and linearising ...")
    progress = SimulationProgress(spec.name, options.at) if options.at else None
    try:
        result = modes(spec, at=options.at, progress=progress)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    finally:
        show_progress()
    with drawing(spec.name):
        files = _files(result, options.count)
        write(files, options.out)
    names = [str(options.out / file.path) for file in files]
    doubts = [*warnings(options.spec, [change.key for change in changes]), *condition_warnings(spec)]
    if isinstance(spec, SymbolicBody):
        doubts.append(
            f"{options.spec}: all numbers of the body are parameters; these are the modes with their defaults"
        )
    if options.json:
        more = {"set": list(map(str, changes)), "warnings": doubts, "files": names}
        print(json.dumps({**modes_data(result), **more}, indent=2))
    else:
        lines = [f"{result.spec.name}: {change}" for change in changes] + [f"warning: {doubt}" for doubt in doubts]
        print("\n".join([*lines, *_text(result, options.count), *(f"wrote {name}" for name in names)]))
    return 0


def _planned_files(name: str) -> list[File]:
    """The files of the command, still without their texts."""
    record = f"{name}/{name}.modes.json"
    data = [File(f"{name}/{name}.modes.{kind}", "", record=record) for kind in ("csv", "npz")]
    return [*data, File(record, ""), *(File(f"{name}/{name}.modes.{kind}", "") for kind in ("svg", "html"))]


def _files(result: Modes, count: int) -> list[File | BinaryFile]:
    """All files; a picture and an animation of the first `count` modes if there is something to draw."""
    stem = f"{result.spec.name}/{result.spec.name}.modes"
    files = list(mode_files(result))
    if is_drawn(result, count):
        files.append(File(f"{stem}.svg", modes_picture(result, count)))
        files.append(File(f"{stem}.html", modes_page(result, count)))
    return files


def _text(result: Modes, count: int) -> list[str]:
    shown = result.first(count)
    lines = [f"{result.spec.name}: {len(result.modes)} modes about {_state(result)}"]
    if result.equilibrium is not None and result.functions_of_time:
        text = f"functions of time have their values at t = 0 there: {', '.join(result.functions_of_time)}"
        lines += wrapped([f"{text}; --at T linearises about the motion at another time"], "  ")
    lines += wrapped(result.notes, "  ")
    if shown:
        rows = [["mode", "frequency, Hz", "damping ratio", "eigenvalue, 1/s"]]
        rows += [[str(i), *_mode(mode)] for i, mode in enumerate(shown, 1)]
        circling = (whirls(result) or ())[: len(shown)]
        if any(whirl is not None for whirl in circling):
            rows[0].append("whirl, Hz")
            for row, whirl in zip(rows[1:], circling, strict=True):
                row.append("" if whirl is None else f"{'forward' if whirl > 0 else 'backward'} {abs(whirl):.6g}")
        lines += table(rows)
    else:
        lines.append("  no coordinate is independent, since constraints and drives determine the motion")
    if result.zero_eigenvalues:
        several = result.zero_eigenvalues > 1
        text = "eigenvalues are zero: motions" if several else "eigenvalue is zero: a motion"
        lines.append(f"  {result.zero_eigenvalues} {text} without stiffness")
    if growing := [str(i) for i, mode in enumerate(result.modes, 1) if _grows(mode)]:
        passing = bool(result.speed) and result.steady is None
        state = "the coefficients of this instant let" if passing else "warning: the state is unstable;"
        several = len(growing) > 1
        verb = "grow" if several or passing else "grows"
        lines.append(f"  {state} mode{'s' if several else ''} {', '.join(growing)} {verb}")
    if len(shown) < len(result.modes):
        lines.append(f"  ... the first {len(shown)} of {len(result.modes)} modes; --count N or --json prints more")
    return [*lines, *(_shapes(result, shown) if shown else []), "", *wrapped(_state_space(result), "  ")]


def _shapes(result: Modes, shown: Sequence[Mode]) -> list[str]:
    """The table of the shapes, with a row for each coordinate."""
    rows = [["", *(str(i + 1) for i in range(len(shown)))]]
    for j, name in enumerate(result.native.coordinates):
        rows.append([name, *_elements([mode.shape for mode in shown], j)])
    return ["", "shapes, the largest element of each is 1 (m, rad):", *table(rows)]


def _state(result: Modes) -> str:
    """The state in words: the equilibrium with its stability, or the size of its velocities and accelerations."""
    if not isinstance(result.spec, (Scene, SpatialScene)):
        return "the undeformed state at rest"
    if (balance := result.equilibrium) is not None:
        loads = f"; out-of-balance force {magnitude(balance.residual)} of loads up to {balance.load:.3g}"
        return f"the static equilibrium, {balance.stability.value}{loads if balance.load else ''}"
    if result.steady is not None:
        axes = ", in axes that rotate with it" if result.steady.spin else ""
        return f"the {result.steady}{axes}"
    at = f"the state at t = {result.linear.t:g} s"
    if not result.speed and not result.acceleration:
        return f"{at}, at rest"
    return (
        f"{at}, with generalised velocities up to {result.speed:.3g} and accelerations up to "
        f"{result.acceleration:.3g}; the coefficients are those of that instant"
    )


def _state_space(result: Modes) -> Iterator[str]:
    """The sizes of the state space and its inputs and outputs, in words."""
    linear, native = result.linear, result.native
    rotating = result.steady is not None and bool(result.steady.spin)
    frame = "axes that rotate with the scene" if rotating else "the inertial frame"
    yield f"state space: {len(linear.states)} states, {len(linear.inputs)} inputs, {len(linear.outputs)} outputs"
    if native.inputs:
        values = zip(native.inputs, result.k[native.nk - len(native.inputs) :], strict=True)
        yield f"inputs, with their values in this state: {', '.join(f'{name} = {value:.6g}' for name, value in values)}"
    elif linear.inputs:
        yield f"inputs: forces at the markers, in {frame}"
    elif linear.outputs:
        yield "inputs: none, as the scene has outputs of its own; declare forces on which they depend in [inputs]"
    if native.outputs:
        yield f"outputs: {', '.join(native.outputs)}"
    elif linear.outputs:
        yield f"outputs: positions of the markers, in {frame}"


def _grows(mode: Mode) -> bool:
    """Whether a mode grows by more than rounding errors."""
    return mode.damping_ratio < -ROUNDING


def _mode(mode: Mode) -> list[str]:
    value, ratio = mode.eigenvalue, mode.damping_ratio
    real = f"{value.real:.6g}" if abs(ratio) > ROUNDING else "0"
    text = f"{real} ± {value.imag:.6g}i" if value.imag else real
    return [f"{mode.frequency:.6g}", f"{ratio:.4g}" if abs(ratio) > ROUNDING else "0", text]


def _elements(shapes: Sequence[ComplexVector], j: int) -> list[str]:
    """Element j of each shape: a number or, of a shape with phases, its size and its phase in degrees."""
    texts = []
    for shape in shapes:
        if abs(shape[j]) < ROUNDING or np.abs(shape.imag).max() < NEGLIGIBLE:
            texts.append(_number(shape[j].real))
        else:
            phase = round(float(np.degrees(np.angle(shape[j]))))
            texts.append(f"{_number(abs(shape[j]))}∠{180 if phase == -180 else phase}°")
    return texts


def _number(value: float) -> str:
    if abs(value) < ROUNDING:
        return "0"
    return f"{value:.4f}" if abs(value) >= 5e-3 else f"{value:.1e}"
