"""`tisserand report`: every equation of a model shown, checked and counted, as one page."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from derive.artifacts import MARK, File, ForeignFile, replace_file, settle, write
from derive.cli.result_files import picture_names
from derive.cli.specifications import build_all, in_file_order
from derive.errors import TisserandError
from derive.progress_line import show_progress
from derive.report.document.page import Page
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import InitialState
from derive.simulation.linear.run_time_inputs import constants
from derive.simulation.scene_start import state_of
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

PAPER = "paper"
BESIDE = {".pdf": "--pdf", ".tex": "--tex", ".md": "--markdown"}
"""The options that write other formats beside the page, by their suffixes."""


def run(options: argparse.Namespace) -> int:
    """Make the page, then write it in every format requested."""
    if options.out and options.out.suffix in BESIDE:
        suffix = options.out.suffix
        page = options.out.with_suffix(".html")
        raise TisserandError(f"--out names the page, which is HTML; write --out {page} {BESIDE[suffix]}")
    show_progress("building ...")
    try:
        name, doc, page = _paper() if options.paper else _of_model(options.spec)
        target = options.out or report_file(name, Path("results"))
        written = _write(page, target, options)
    finally:
        show_progress()
    if options.json:
        print(json.dumps({"name": name, "title": page.title, "files": [str(path) for path in written]}, indent=2))
    else:
        print("\n".join([f"{page.title}: {doc}", *(f"  wrote {path}" for path in written)]))
    return 0


def report_file(name: str, folder: Path) -> Path:
    """The page of a model in the folder of all results."""
    return folder / name / f"{name}.report.html"


def model_report(path: Path, folder: Path) -> Path:
    """Write the page of a specification file into the folder of all results; its path."""
    show_progress("building ...")
    try:
        name, _, page = _of_model(path)
        target = report_file(name, folder)
        write([File(target.name, _html(page))], target.parent)
    finally:
        show_progress()
    return target


def _of_model(path: Path) -> tuple[str, str, Page]:
    """The page of a specification file; of a scene with the pictures that `simulate` and `study` have left."""
    from derive.report.model_page import model_page
    from derive.report.scene_page import ResultPicture, scene_page
    from derive.report.sections.files import SpecificationText
    from derive.simulation.observables.default_plots import default_plots
    from derive.simulation.run_record import recorded_warnings

    (built,) = build_all([path])
    name = built.model.name
    show_progress(f"{path}: making the page ...")
    text = SpecificationText(path.name, path.read_text(encoding="utf-8-sig"))
    if not isinstance(built.spec, (Scene, SpatialScene)):
        return name, built.model.doc, model_page(built, text)
    initial, drawing = _initial_state(built.spec, built.files)
    plots = in_file_order((*built.spec.plots, *default_plots(built.spec, built.model)), path)
    plotted = [*picture_names(plots).values()]
    return (
        name,
        built.model.doc,
        scene_page(
            built,
            text,
            [ResultPicture(path.stem, svg) for path, svg in _pictures(Path("results") / name, plotted)],
            initial,
            recorded_warnings(Path("results") / name / f"{name}.json", built.spec),
            drawing,
        ),
    )


def _pictures(folder: Path, plotted: Sequence[str]) -> Iterator[tuple[Path, str]]:
    """Our pictures in a folder: those of plots in their order, then those of studies by their names.

    Pictures that are no longer plain drawings are left out, with a message.
    """
    from xml.etree.ElementTree import ParseError

    from derive.report.writers.picture import standalone

    for root in (folder.parent, folder):
        settle(root)
    ranks = {name: rank for rank, name in enumerate(plotted)}
    for path in sorted(folder.glob("*.svg"), key=lambda path: (ranks.get(path.name, len(ranks)), path.name)):
        svg = path.read_text(encoding="utf-8")
        if MARK not in svg[:1000]:
            continue
        try:
            standalone(svg)
        except (ValueError, ParseError) as error:
            print(f"{path}: left out of the report: {error}", file=sys.stderr)
        else:
            yield path, svg


def _initial_state(scene: AnyScene, files: Sequence[File]) -> tuple[InitialState | str, str]:
    """The initial state of a scene, or why it cannot be computed, and the drawing of a scene in space, if it can.

    It needs a compiler, and values that go together.
    """
    from derive.runtime.compiler import UNOPTIMISED
    from derive.runtime.loading import load_scene

    try:
        native = load_scene(files, UNOPTIMISED)
        k = constants(scene, native, 0.0)
        state = state_of(scene, native, k)
    except TisserandError as error:
        return str(error), ""
    return state, _drawing(scene, native, k, state) if isinstance(scene, SpatialScene) else ""


def _drawing(scene: SpatialScene, native: NativeScene, k: Vector, state: InitialState) -> str:
    from derive.simulation.observables.motion import SceneMotion
    from derive.simulation.observables.spatial_scene_player import (
        PICTURE_TRIANGLES,
        body_paths,
        drawn_bodies,
        ground_points,
        ties,
    )
    from derive.visual.spatial_mechanism import spatial_picture

    drawn = drawn_bodies(scene, PICTURE_TRIANGLES)
    motion = SceneMotion(scene, native, k, np.zeros(1), state.q[None], state.v[None])
    return spatial_picture(scene.name, drawn, body_paths(drawn, motion), ground_points(scene), ties(scene))


def _paper() -> tuple[str, str, Page]:
    """The audit of the paper."""
    from derive.report.paper_audit import audit_page
    from derive.report.paper_audit.page import SUBTITLE

    return PAPER, SUBTITLE, audit_page()


def _write(page: Page, target: Path, options: argparse.Namespace) -> list[Path]:
    """Write the page; all texts are made before the first file is touched."""
    show_progress("writing ...")
    stem = target.name.removesuffix(".html")
    files = [File(target.name, _html(page))]
    if options.tex:
        from derive.report.writers.latex import latex

        files.append(File(f"{stem}.tex", latex(page)))
    if options.markdown:
        from derive.report.writers.markdown import markdown, picture_files

        pictures = f"{stem}.pictures"
        files.append(File(f"{stem}.md", markdown(page, pictures)))
        files += [File(f"{pictures}/{name}", f"<!-- {MARK} -->\n{text}") for name, text in picture_files(page)]
    made = _pdf(page) if options.pdf else None
    paper = target.parent / f"{stem}.pdf"
    if made is not None:
        _check_pdf(paper)
    write(files, target.parent)
    if made is not None:
        replace_file(paper, made.rstrip(b"\n") + b"\n" + SIGN)
    return [*(target.parent / file.path for file in files), *([paper] if made is not None else [])]


def _html(page: Page) -> str:
    from derive.report.writers.html import html

    return html(page)


def _pdf(page: Page) -> bytes:
    from derive.report.writers.typst import pdf

    return pdf(page)


def _check_pdf(target: Path) -> None:
    """Raise ForeignFile if the target exists and is not a PDF that carries our mark."""
    taken = target.exists() or target.is_symlink()
    if taken and not (target.is_file() and (data := target.read_bytes()).startswith(b"%PDF") and SIGN in data):
        raise ForeignFile(
            f"{target}: it was not generated by Tisserand and is left alone; move it or choose another --out"
        )


SIGN = f"% {MARK}\n".encode()
"""The last line of our PDFs: a comment with our mark."""
