"""The gallery: each example is in it once, has a title and a number, and gets a page of what it prints and draws."""

from __future__ import annotations

import importlib
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.mechanics.bodies.section_fields import Direction
from derive.simulation.observables.motion import SceneMotion
from docs.gallery import entries, numbers, pages, recording, runs, sources, stroboscope, written
from docs.gallery.entries import Entry

SCRIPT = '''"""Twice a number.

A text with `code` and a star * in it. The number is twice %d.
"""

from pathlib import Path


def main(folder: str | None = None) -> float:
    """Return twice the number, m."""
    import matplotlib.pyplot as plt

    print("printed by the example")
    figure, axes = plt.subplots()
    axes.plot([0, 1])
    figure.savefig(Path(folder) / "twice.svg")
    return 2.0 * %d
'''


def test_every_example_is_in_the_gallery_once() -> None:
    there = [path for ending in ("py", "toml", "c") for path in (ROOT / "examples").rglob(f"*.{ending}")]
    paths = [path for entry in entries.entries() for path in (entry.path, *entry.shown)]
    listed = [path for path in paths if path.startswith("examples/")]
    assert sorted(listed) == sorted(path.relative_to(ROOT).as_posix() for path in there)
    names = [entry.name for entry in entries.entries()]
    assert len(set(names)) == len(names)
    assert {name for name, _, _ in entries.PAGES} <= set(names)


def test_every_example_has_a_title_a_text_and_the_meaning_of_its_number() -> None:
    described = {entry: sources.described(entry) for entry in entries.entries()}
    titles = [each.title for each in described.values()]
    assert len(set(titles)) == len(titles)
    for entry, each in described.items():
        assert 10 < len(each.title) < 120 and "\n" not in each.title, entry.path
        assert each.paragraphs, entry.path
        assert bool(each.number) == (entry.kind == "py"), entry.path


@pytest.mark.parametrize(
    "value, texts",
    [
        (1.0000000003, [("", "1.00000")]),
        (0.0, [("", "0")]),
        (-2.5e-14, [("", "\N{MINUS SIGN}2.5 · 10⁻¹⁴")]),
        ((15, 5), [("", "15, 5")]),
        ([(0.5, 2), 3], [("", "(0.500000, 2), 3")]),
        ({"mean": [144.0], "point": 7}, [("mean", "144.000"), ("point", "7")]),
    ],
)
def test_numbers_as_readers_see_them(value: object, texts: list[tuple[str, str]]) -> None:
    assert numbers.number_texts(value) == texts


def test_a_result_that_is_no_number_is_refused() -> None:
    with pytest.raises(TypeError, match="no number"):
        numbers.number_texts("many")


def test_the_title_of_a_comment_ends_at_its_colon_or_its_sentence(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text("#:schema s.json\n#\n# A column: it buckles\n# at 9.87 N. Twice.\n\nname = 1\n# no text\n")
    assert sources.described(Entry(str(file))) == sources.Description("A column", ("It buckles at 9.87 N. Twice.",))
    file.write_text("# A column of 1.5 m. It buckles.\n")
    assert sources.described(Entry(str(file))) == sources.Description("A column of 1.5 m", ("It buckles.",))
    file.write_text("name = 1\n")
    with pytest.raises(ValueError, match="no sentence that is a title"):
        sources.described(Entry(str(file)))


def test_an_example_is_run_again_when_it_changes_and_not_otherwise(tmp_path: Path) -> None:
    importlib.import_module("matplotlib.pyplot")  # once, not in each process
    script = tmp_path / "twice.py"
    script.write_text(SCRIPT % (3, 3))
    entry = Entry(str(script))
    (run,) = runs.results([entry], tmp_path / "runs")
    assert run.numbers == [("", "6.00000")] and run.output == "printed by the example\n"
    page = pages.example_page(run)
    assert page.startswith("# Twice a number\n\nA text with `code` and a star \\* in it.")
    assert "**6.00000**\n\nTwice the number, m." in page
    assert "![Twice a number](twice.svg)" in page and "printed by the example" in page and SCRIPT % (3, 3) in page
    files, complete = written.gallery_files([run])
    assert set(files) == {"index.md", "twice.md", "twice.py", "twice.svg"} and not complete
    assert b"prefers-color-scheme: dark" in files["twice.svg"] and b"<metadata>" not in files["twice.svg"]

    result = run.folder / "result.json"
    before = result.stat().st_mtime_ns
    runs.results([entry], tmp_path / "runs")
    assert result.stat().st_mtime_ns == before
    script.write_text(SCRIPT % (4, 4))
    (run,) = runs.results([entry], tmp_path / "runs")
    assert run.numbers == [("", "8.00000")]


def test_an_example_that_fails_is_named_with_its_error(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    script = tmp_path / "broken.py"
    fails = "import sys\n    print('told before', file=sys.stderr)\n    return 1 / 0"
    script.write_text(f'"""Broken."""\n\n\ndef main() -> float:\n    """Return nothing."""\n    {fails}\n')
    with pytest.raises(runs.ExamplesFail, match=r"(?s)broken\.py: told before.*ZeroDivisionError"):
        runs.results([Entry(str(script))], tmp_path / "runs")
    assert "failed" in capfd.readouterr().err


def test_an_example_without_its_package_is_shown_and_not_run(tmp_path: Path) -> None:
    script = tmp_path / "twice.py"
    script.write_text(SCRIPT % (3, 3))
    (run,) = runs.results([Entry(str(script), needs="no_such_package")], tmp_path / "runs")
    assert run.data is None and not (tmp_path / "runs").exists()
    page = pages.example_page(run)
    assert "needs the package `no_such_package`" in page and SCRIPT % (3, 3) in page


def test_a_motion_in_one_picture_shows_the_bodies_at_several_instants() -> None:
    markers = {"top": [-0.5, 0], "tip": [0.5, 0]}
    scene = derive.scene("fall", bodies={"rod": {"mass": 1, "inertia": 1, "markers": markers}})
    native = SimpleNamespace(bodies=["rod"], poses=lambda t, q, k: np.array([q]))
    t = np.linspace(0, 1, 101)
    q = np.stack([0 * t, -(t**2), np.pi / 2 * t], axis=1)  # it falls by 1 m and turns by 90 degrees
    motion = SceneMotion(scene, native, np.zeros(0), t, q, 0 * q)  # type: ignore[arg-type]
    lines = re.findall(r'opacity="(.*?)" d="M(.*?)L(.*?)L', stroboscope.stroboscope(motion))
    assert len(lines) == stroboscope.INSTANTS
    assert [float(opacity) for opacity, _, _ in lines] == sorted(float(opacity) for opacity, _, _ in lines)
    first, last = ([tuple(map(float, point.split())) for point in line[1:]] for line in (lines[0], lines[-1]))
    (x0, y0), (x1, y1) = first
    assert y0 == y1 and x1 > x0
    (x2, y2), (x3, y3) = last
    length = x1 - x0
    assert x2 == x3 == pytest.approx((x0 + x1) / 2, abs=0.1)
    assert (y2, y3) == pytest.approx((y0 + 1.5 * length, y0 + 0.5 * length), abs=0.2)


def test_files_of_examples_that_are_gone_go_as_well(tmp_path: Path) -> None:
    written.write({"a.md": b"1", "b.md": b"2"}, tmp_path)
    written.write({"a.md": b"1"}, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["a.md"]


def test_the_page_of_a_beam_in_space_shows_its_shapes_in_both_planes_and_in_torsion(tmp_path: Path) -> None:
    (entry,) = (entry for entry in entries.entries() if entry.name == "spatial_crank_slider_beam")
    shapes = recording._shapes(entry, tmp_path)
    (tmp_path / "report.html").touch()
    data = {"numbers": [], "pictures": [], "seconds": 1, "report": "report.html", "shapes": shapes}
    run = runs.Run(replace(entry, card="output"), tmp_path, data)
    kinds = [kind.value for kind in (Direction.ALONG_E2, Direction.ALONG_E3, Direction.TORSION)]
    assert f"![Shape functions of rod: {', '.join(kinds)}]({entry.name}.shapes_1.svg)" in pages.example_page(run)
    drawn = written.gallery_files([run])[0][f"{entry.name}.shapes_1.svg"].decode()
    assert all(kind in drawn for kind in kinds)
