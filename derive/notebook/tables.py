"""The tables of studies as data frames of pandas: those that commands write as CSV, or print."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from derive.simulation.conversions import pandas_module
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.table import run_table
from derive.study.choice.choice_text import tried_table
from derive.study.choice.search import Choice
from derive.study.methods.failures import failure_table, failures
from derive.study.methods.method_study import MethodStudy
from derive.study.stability.ladder_stability import LadderStability
from derive.study.stability.table import mode_table
from derive.study.sweep.result import SweepResult
from derive.study.sweep.table import sample_table
from derive.study.table import StudyTable

TABLES: dict[type, Callable[[Any], StudyTable]] = {
    SweepResult: sample_table,
    LadderChart: run_table,
    MethodStudy: lambda study: failure_table(failures(study)),
    LadderStability: mode_table,
    Choice: tried_table,
}
"""The table of a study by the type of its result."""


def data_frame(study: Any) -> Any:
    """The table of a study as a pandas.DataFrame. Raises PandasMissing."""
    table = TABLES[type(study)](study)
    return pandas_module().DataFrame(table.rows, columns=[column.name for column in table.columns])
