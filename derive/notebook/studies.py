"""The HTML of studies: their chart and their table; of a sweep its picture and the extremes of its outputs."""

from __future__ import annotations

import numpy as np

from derive.notebook.parts import Writers, folded, head, joined, lines, number, picture, table
from derive.percentages import percent
from derive.short_text import counted, listed
from derive.study.accuracy.chart import accuracy_svg
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.table import ON_PAGE, model_table
from derive.study.choice.choice_text import tried_table, verdict_lines
from derive.study.choice.search import Choice
from derive.study.frame_cost_chart import frame_cost_svg
from derive.study.frame_cost_table import frame_cost_notes, frame_cost_table
from derive.study.frame_study import FrameStudy
from derive.study.methods.method_study import MethodStudy
from derive.study.methods.methods_chart import methods_svg
from derive.study.methods.methods_table import tables
from derive.study.pivot_study import PivotStudy
from derive.study.pivot_table import LEGEND, entry_table, order_table, pivot_title
from derive.study.stability.chart import stability_svg
from derive.study.stability.ladder_stability import LadderStability
from derive.study.stability.table import gap_sentences, loss_table
from derive.study.sweep.picture import sweep_svg
from derive.study.sweep.result import SweepResult
from derive.study.table import StudyTable
from derive.study.verdict import verdict


def study_table(of: StudyTable) -> str:
    """The table of a study with all of its rows and its notes."""
    heads = [f"{c.heading}, {c.unit}" if c.unit else c.heading for c in of.columns]
    return table(heads, of.cells, of.left, most=max(1, len(of.cells))) + lines(f"{note}." for note in of.footnotes)


def sweep_html(result: SweepResult) -> str:
    """A sweep: its picture over one or two names, the extremes of each output, and failed samples."""
    failed = f", {counted(len(result.failures), 'failure')}" if result.failures else ""
    drawn = sweep_svg(result)
    rows = []
    for label, values in zip(result.labels, result.values.T, strict=True):
        least, largest = int(np.nanargmin(values)), int(np.nanargmax(values))
        rows.append(
            (label, number(values[least]), _sample(result, least), number(values[largest]), _sample(result, largest))
        )
    return joined(
        head(result.name, f"sweep of {counted(len(result.samples), 'sample')}{failed}"),
        picture(drawn, f"Sweep of {result.name}: {', '.join(result.labels)}") if drawn else "",
        table(("output", "least", "at", "largest", "at"), rows),
        lines(f"{counted(len(numbers), 'sample')}: {text}" for text, numbers in result.reasons()),
        lines(f"warning: {text}" for texts in result.warnings.values() for text in texts),
    )


def _sample(result: SweepResult, number_of: int) -> str:
    """The values of a sample that vary."""
    values = result.sample(number_of)
    return ", ".join(f"{name} = {values[name]:g}" for name in result.samples.varying)


def accuracy_html(chart: LadderChart) -> str:
    """A study of accuracy: error over cost for a ladder of models, and the table of these models."""
    return joined(
        head(chart.name, "accuracy against cost"),
        picture(accuracy_svg(chart), f"{chart.name}: error over CPU time and over operations"),
        folded("Models", study_table(model_table(chart).only(ON_PAGE))),
    )


def frames_html(study: FrameStudy) -> str:
    """A study of frames: the chart of its ratios, and its table."""
    frames = " over ".join(study.frames)
    return joined(
        head(study.name, f"cost of frames, {frames}"),
        picture(frame_cost_svg(study), f"{study.name}: cost of frames, {frames}"),
        folded("Costs", study_table(frame_cost_table(study)) + lines(f"{note}." for note in frame_cost_notes(study))),
    )


def pivots_html(study: PivotStudy) -> str:
    """A study of pivots: the verdict and the tables for each number of beams, and the meaning of their columns."""
    return joined(
        head(study.name, "pivots in two frames"),
        *(
            joined(
                lines([f"{pivot_title(study, row)}.", *verdict(*row.frames)]),
                folded("Entries", study_table(entry_table(row))),
                folded("Orders", study_table(order_table(row))),
            )
            for row in study.rows
        ),
        folded("Columns", lines(f"{line}." for line in LEGEND)),
    )


def methods_html(study: MethodStudy) -> str:
    """A study of methods: its chart and its tables."""
    return joined(
        head(study.name, "methods of integration and formulations"),
        picture(methods_svg(study), f"{study.name}: methods"),
        "".join(folded(of.title or "Table", study_table(of)) for of in tables(study)),
    )


def stability_html(of: LadderStability) -> str:
    """A study of stability: its chart, where each model loses its stability, and those without a steady motion."""
    return joined(
        head(of.name, "stability of a ladder of models"),
        picture(stability_svg(of), f"{of.name}: stability"),
        folded("Models", study_table(loss_table(of))),
        lines(gap_sentences(of)),
    )


def choice_html(choice: Choice) -> str:
    """A search for a model: the verdict, the loads on the beams, and the models that were tried."""
    return joined(
        head(
            choice.name,
            f"the cheapest model with an error of at most {percent(choice.error)} in {listed(choice.plots)}",
        ),
        lines(verdict_lines(choice)),
        lines(of.text for of in choice.screening),
        study_table(tried_table(choice)),
    )


WRITERS: Writers = {
    SweepResult: sweep_html,
    LadderChart: accuracy_html,
    MethodStudy: methods_html,
    FrameStudy: frames_html,
    PivotStudy: pivots_html,
    LadderStability: stability_html,
    Choice: choice_html,
}
