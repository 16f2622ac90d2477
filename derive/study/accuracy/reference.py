"""The compared plot of a ladder, the beams that it shows, and its reference: a file or the finest of several models."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from derive.enumerations import enumeration
from derive.errors import Problem, SpecError, quoted
from derive.mechanics.symbols import Family, amplitude, owned, quantity, vector
from derive.percentages import percent
from derive.runtime.compiler import QUICK_FLAGS
from derive.simulation.errors import SimulationError
from derive.simulation.observables.beams import fields_of, piece_names
from derive.simulation.observables.default_plots import output_columns
from derive.simulation.observables.plots import PlotCurve
from derive.spec.model.beam_pieces import piece_name
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.plots import ColumnCurves, Deflection, Plot, ReferenceCurve
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.parsing.faults import did_you_mean
from derive.study.accuracy.measurement import (
    Curves,
    ModelVariant,
    Preparation,
    Progress,
    curves_of,
    motion,
    opened,
    preparation,
)
from derive.study.accuracy.modelled_bodies import Flexible, flexible_members
from derive.study.accuracy.models import refinements
from derive.study.accuracy.piece_errors import error_over_difference

TOLERANCE = 1e-10
"""The tolerance of the runs that make a reference, so small that the error of the reference is that of the models."""


LEAST = 3
"""The least number of models that make a reference, unless two agree so well that a third one would change nothing."""
CLEARLY = 0.25
"""The part of the error that is good enough, within which two models are a reference."""

ALIKE = 1e-12
"""The error of a reference from models, relative to the peak, below which its models differ by rounding alone."""


@dataclass(frozen=True)
class Reference:
    """Plots with the curves that models are compared with; source: where they come from.

    They are one plot, or its curves if there are several. error: the root mean square error over the peak of the
    reference itself; None if it is not known. Nothing below it is claimed.
    """

    plots: tuple[Plot, ...]
    source: str
    error: float | None


def compared_plot(scene: AnyScene, name: str | None) -> Plot:
    """The plot of a scene that a ladder compares: the one with the name, or the first one. Raises SpecError."""
    if not scene.plots:
        text = 'a ladder compares a plot; add one, such as [plots.tip] with y = ["the name of a column"]'
        raise SpecError((Problem("plots", text),))
    if scene.simulation is not None and scene.simulation.until is not None:
        text = "models are compared over the same time, and this ends each run at its own; leave `until` out"
        raise SpecError((Problem("simulation.until", text),))
    known = {plot.name: plot for plot in scene.plots}
    if name is not None and name not in known:
        near = did_you_mean(name, list(known), f"the plots are {', '.join(known)}")
        raise SpecError((Problem("plots", f"there is no plot {quoted(name)}{near}"),))
    plot = scene.plots[0] if name is None else known[name]
    if problems := tuple(_against_frames(plot, scene)):
        raise SpecError(problems)
    return plot


def _against_frames(plot: Plot, scene: AnyScene) -> Iterator[Problem]:
    """A problem for each output of a plot that is measured against the floating frame of a beam, which models change.

    In space `deflection` is without a chord, and `twist` always; those of finite-element bodies keep their frame.
    """
    columns = plot.quantity.y if isinstance(plot.quantity, ColumnCurves) else ()
    beams = {body.name for body in scene.bodies if isinstance(body, SpatialBeam)}
    for output in scene.outputs if isinstance(scene, SpatialScene) else ():
        measured = output.kind == "twist" or (output.kind == "deflection" and output.values.get("chord") is None)
        body = next((body for body in _bodies([*output.values.values()], scene) if body in beams), None)
        if measured and body and not set(columns).isdisjoint(output_columns(output, in_space=True)):
            instead = {"twist": "plot the rotation of a marker"}.get(output.kind, "give it a chord, or plot a position")
            text = f"{output.name}, a {output.kind}, is measured against the floating frame of {body}"
            text += f", which each model has in its own way; {instead}, or choose another plot by --plot"
            yield Problem(f"plots.{plot.name}", text)


def reference(
    scene: AnyScene,
    plot: Plot,
    error: float | None,
    own: bool,
    progress: Progress,
    report: Progress = lambda _: None,
    ahead: Preparation | None = None,
    enough: float = 0.0,
    ladder: Collection[ModelVariant] = (),
) -> Reference:
    """The reference of a plot: its file, whose error may be given, or with `own` or without a file a finer model.

    progress: takes a line on each task; report: takes a line on each model. ahead: prepares the models of the scene
    with this plot alone. enough: the error with which a reference from models is fine enough. ladder: the models that
    run afterwards, so that those of the reference among them are compiled once.

    Raises SpecError, SimulationError, CompilerError.
    """
    if plot.reference is not None and not own:
        return Reference((replace(plot, cut=None, pieces=()),), plot.reference.file, error)
    models = preparation(replace(scene, plots=(plot,))) if ahead is None else ahead
    shared = {variant.model: variant for variant in ladder}
    variants = [shared.get(of, ModelVariant(of, monitored=False, flags=QUICK_FLAGS)) for of in refinements(scene)]
    return _own(models, variants, plot, enough, progress, report)


def _own(
    models: Preparation,
    variants: Sequence[ModelVariant],
    plot: Plot,
    enough: float,
    progress: Progress,
    report: Progress,
) -> Reference:
    """The reference from the finest of ever finer models; its error follows from its difference from the one before.

    Beyond `LEAST` models, finer ones are run only while that difference is larger than `enough`; the third model only
    if it is larger than `CLEARLY` of it.
    """
    bare = bare_plots(plot)
    finest, before, label = Curves(), Curves(), ""
    difference, pieces = None, list[int]()
    models.expect(variants[:LEAST])
    for n, variant in enumerate(variants, 1):
        if difference is not None and difference <= (enough if n > LEAST else CLEARLY * enough):
            break
        label = variant.model.label
        progress(f"reference: model {n} of {LEAST if n <= LEAST else len(variants)}: {label} ...")
        try:
            moved = motion(opened(models.result(variant)), TOLERANCE)
        except SimulationError as cause:
            raise SimulationError(f"the reference cannot be made of {label}: {cause}") from cause
        before, finest = finest, curves_of(bare, moved)
        pieces.append(variant.model.pieces)
        difference = rms_difference(finest, before) if before else None
        if before and difference is None:  # finer models would hardly tell more
            break
        change = "" if difference is None else f", {percent(difference)} from the one before"
        report(f"reference: {label}: {1e3 * moved.solution.cost.seconds:.3g} ms{change}")
    if difference is None:
        text = "it vanishes all the time, so that no error of it is known; choose another by --plot"
        raise SpecError((Problem(f"plots.{plot.name}", text),))
    error = error_over_difference(pieces[-1], pieces[-2]) * difference
    return Reference(reference_plots(bare, label, finest, report), f"own run, {label}", error)


def undeformed_note(plots: Sequence[str], error: float | None) -> tuple[str, ...]:
    """A line on plots whose curves all models of a reference share, if they do: any model is accurate then."""
    if error is None or error > ALIKE:
        return ()
    shared = "has the same curve" if len(plots) == 1 else "have the same curves"
    return (f"{enumeration(plots)} {shared} in all models of the reference: no deformation shows; see --plot",)


def bare_plots(plot: Plot) -> tuple[Plot, ...]:
    """A plot for each curve of a plot, without reference and without other numbers of pieces."""
    quantity, bare = plot.quantity, replace(plot, cut=None, pieces=(), reference=None)
    if not isinstance(quantity, ColumnCurves):
        return (bare,)
    return tuple(replace(bare, quantity=replace(quantity, y=(name,))) for name in quantity.y)


def reference_plots(bare: Sequence[Plot], label: str, curves: Curves, report: Progress) -> tuple[Plot, ...]:
    """Plots of one curve each with their curves as references, which the label describes.

    A curve that vanishes has no relative error, and is left out; report takes a line on it.
    """
    plots = []
    for plot, curve in zip(bare, curves, strict=True):
        if np.any(curve.y):
            plots.append(_with_curve(plot, label, curve))
        else:
            report(f"reference: {curve.label or plot.name} vanishes all the time; it is not compared")
    return tuple(plots)


def _with_curve(bare: Plot, label: str, curve: PlotCurve) -> Plot:
    rows = tuple(zip(map(float, curve.x), map(float, curve.y), strict=True))
    return replace(bare, reference=ReferenceCurve(label, "", "", rows))


def rms_difference(finer: Curves, coarser: Curves) -> float | None:
    """The largest root mean square difference of two curves over the peak of the finer.

    Curves that vanish in both are not compared; None where all vanish, or where one vanishes in the finer alone.
    """
    pairs = [(fine.y, coarse.y) for fine, coarse in zip(finer, coarser, strict=True) if np.any((fine.y, coarse.y))]
    peaks = [float(np.abs(fine).max()) for fine, _ in pairs]
    if not pairs or not all(peaks):
        return None
    differences = [float(np.sqrt(np.mean((fine - coarse) ** 2))) for fine, coarse in pairs]
    return max(difference / peak for difference, peak in zip(differences, peaks, strict=True))


def plotted_beams(plot: Plot, scene: AnyScene) -> tuple[str, ...]:
    """The names of the flexible bodies that a plot shows, in the order of the scene.

    Empty where it shows none of them alone, such as an energy or the reaction of a joint between rigid bodies.
    """
    shown = (
        {plot.quantity.marker.body} if isinstance(plot.quantity, Deflection) else _of_columns(plot.quantity.y, scene)
    )
    return tuple(body.name for body in flexible_members(scene) if body.name in shown)


def _of_columns(columns: tuple[str, ...], scene: AnyScene) -> set[str]:
    """The bodies to whose coordinates or outputs the columns belong."""
    members = flexible_members(scene)
    bodies = {column: {body.name} for body in members for column in _coordinates(body)}
    for output in scene.outputs:
        own = set(_bodies(list(output.values.values()), scene))
        bodies |= dict.fromkeys(output_columns(output, isinstance(scene, SpatialScene)), own)
    return {body for column in columns for body in bodies.get(column, ())}


def _coordinates(body: Flexible) -> Iterator[str]:
    """The names of the coordinates of a flexible body and of their rates; in space, of its positions and velocities."""
    pieces = piece_names(body) if isinstance(body, BeamBody) else _pieces(body)
    for order in (0, 1):
        if isinstance(body, BeamBody):
            symbols = [*vector(Family.TRANSLATION, 2, order), quantity(Family.ANGLE, derivative=order)]
            symbols += [amplitude(i + 1, order) for i in range(len(fields_of(body)))]
        else:
            symbols = [*vector(Family.TRANSLATION, 3, order)]
        yield from (owned(symbol, piece).identity.shown for piece in pieces for symbol in symbols)


def _pieces(body: SpatialBeam | FlexibleBody) -> tuple[str, ...]:
    """The names of the pieces of a flexible body in space."""
    if isinstance(body, FlexibleBody):
        return (body.name,)
    return tuple(piece_name(body.name, body.pieces, k) for k in range(body.pieces))


def _bodies(values: list[object], scene: AnyScene) -> Iterator[str]:
    """The bodies of the markers and joints among the values of an output."""
    joints = {joint.name: (joint.first, joint.second) for joint in scene.joints}
    for value in values:
        if isinstance(value, MarkerRef):
            yield value.body
        elif isinstance(value, (tuple, list)):
            yield from _bodies([*value], scene)
        elif isinstance(value, str) and value in joints:
            yield from (end.body for end in joints[value])
