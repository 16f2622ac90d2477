"""`tisserand sweep`: run a scene with many values of its parameters; write a table (CSV, NPZ) and a picture (SVG)."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

from derive.artifacts import BinaryFile, File, check_folder, write
from derive.cli.result_files import drawing, planned_files, print_result, study_files
from derive.cli.specifications import read_changed
from derive.errors import SpecError
from derive.progress_line import show_progress
from derive.spec.toml.read import read_with_counts, with_lines
from derive.study.sweep.cluster import dask_executor
from derive.study.sweep.finished import IDENTITY, finished_sweep
from derive.study.sweep.picture import sweep_svg
from derive.study.sweep.plan import Plan, RunOptions, first_values, make_plan
from derive.study.sweep.result import SweepResult
from derive.study.sweep.run import SweepFailed, run_plan
from derive.study.sweep.samples import parsed_samples
from derive.study.sweep.table import sample_table, sweep_data, sweep_npz, sweep_text
from derive.terminal import SampleProgress

NAME = "sweep"
SAMPLE_SIZE = 500
"""The approximate size of a sample in the store and the tables, in bytes."""


def run(options: argparse.Namespace) -> int:
    """Run all samples, write the files, and print the extremes.

    Errors in the specification, the samples and the files are reported before the first run.
    """
    samples = parsed_samples(options.set, options.samples, options.seed, options.list)
    spec, counts = read_with_counts(options.spec, first_values(samples))
    settings = RunOptions(options.duration, options.interval, options.tolerance, options.until)
    folder = options.out / spec.name
    try:
        planned = planned_files(NAME, spec.name, folder)
        changed = (lambda texts: read_changed(options.spec, [*texts.items()])) if counts else None
        plan = make_plan(spec, samples, options.output, settings, lambda text: show_progress(f"{text} ..."), changed)
    except SpecError as error:
        raise with_lines(error, options.spec) if error.source is None else error from None
    finally:
        show_progress()
    picture: Path = options.picture or folder / f"{NAME}.svg"
    check_folder(planned, folder, SAMPLE_SIZE * len(samples) + 1_000_000)
    check_folder([File(picture.name, "")], picture.parent, 1_000_000)
    store = folder / f"{NAME}.partial"
    nothing_left = options.resume and not store.exists()
    files: list[File | BinaryFile] = []
    if nothing_left and (finished := finished_sweep(folder, NAME, plan)):
        result, data = finished
    else:
        if nothing_left:
            text = f"{plan.name}: {folder} holds no sweep of these samples, so all of them are computed"
            print(text, file=sys.stderr)
        result = _run(plan, store, options)
        data = sweep_data(result, plan)
        files = _files(result, data, plan)
    with drawing(plan.name):
        drawn = sweep_svg(result)
        write(files, folder)
        if drawn:
            write([File(picture.name, drawn)], picture.parent)
    store.unlink(missing_ok=True)
    written = [*(str(folder / file.path) for file in files), *([str(picture)] if drawn else [])]
    missing = [] if drawn else [f"  no picture: {len(samples.varying)} values vary, and a picture shows one or two"]
    print_result("\n".join([sweep_text(data, samples), *missing]), data, written, options.json)
    return 0


def _run(plan: Plan, store: Path, options: argparse.Namespace) -> SweepResult:
    """Run the samples that are not in the store."""
    progress = SampleProgress(plan.name)
    with _executor(options.scheduler) as (executor, threads):
        try:
            return run_plan(plan, executor, threads or options.workers, None, store, options.resume, progress)
        except SweepFailed:  # nothing is left to go on with
            store.unlink()
            raise
        finally:
            show_progress()


@contextmanager
def _executor(scheduler: str | None) -> Iterator[tuple[Executor, int] | tuple[None, None]]:
    """The executor of a Dask scheduler with the number of its threads; None for processes of this machine."""
    if scheduler is None:
        yield None, None
    else:
        with dask_executor(scheduler) as given:
            yield given


def _files(result: SweepResult, data: dict[str, object], plan: Plan) -> list[File | BinaryFile]:
    """The tables, and the record with all settings."""
    tables: dict[str, str | bytes] = {"csv": sample_table(result).csv, "npz": sweep_npz(result)}
    return study_files(NAME, {**data, IDENTITY: dict(plan.identity)}, tables)
