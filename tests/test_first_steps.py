"""`tisserand new` writes specifications that every command takes; `tisserand run` makes a page and opens it."""

from __future__ import annotations

import json
import sys
import tomllib
from pathlib import Path

import jsonschema
import pytest

from conftest import ROOT
from derive.artifacts import MARK
from derive.cli.arguments.first_steps import KINDS
from derive.cli.main import main
from derive.cli.new import SCHEMA

SYMBOLIC = ROOT / "scenes/body_symbolic.toml"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder, on a machine without a display."""
    monkeypatch.chdir(tmp_path)
    for name in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


@pytest.fixture
def opened(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file in which a browser notes the addresses that it opens."""
    browser = here / "browser.py"
    browser.write_text(f"#!{sys.executable}\nimport sys\nopen({str(here / 'opened')!r}, 'a').write(sys.argv[1])\n")
    browser.chmod(0o700)
    monkeypatch.setenv("BROWSER", f"{browser} %s")
    monkeypatch.setattr("webbrowser._tryorder", None)  # which it keeps after the first look at BROWSER
    return here / "opened"


def test_each_kind_has_one_template() -> None:
    assert {path.stem for path in (ROOT / "templates/new").iterdir()} == KINDS.keys()


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_specification_follows_the_schema_beside_it(
    kind: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", "arm", "--kind", kind]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "next: tisserand run arm.toml --open"
    text = (here / "arm.toml").read_text()
    data = tomllib.loads(text)
    assert data["name"] == "arm" and "new_" not in text
    assert text.startswith(f"#:schema {SCHEMA}\n") and MARK not in text  # so that no command ever overwrites it
    assert (here / SCHEMA).read_bytes() == (ROOT / "scenes/schema.json").read_bytes()
    validator = jsonschema.Draft202012Validator(json.loads((here / SCHEMA).read_text()))
    assert validator.is_valid(data) and not validator.is_valid({**data, "lenght": 1})


def test_what_is_there_is_left_alone(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "arm.toml").write_text("mine")
    assert main(["new", "arm"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        "arm.toml: this file exists and is left alone; choose another name or another --out"
    ]
    assert (here / "arm.toml").read_text() == "mine" and not (here / SCHEMA).exists()
    (here / SCHEMA).write_text("{}")
    assert main(["new", "leg"]) == 2
    assert (here / SCHEMA).read_text() == "{}" and not (here / "leg.toml").exists()
    (here / SCHEMA).write_text(f'{{"$comment": "{MARK}, an older version"}}')
    assert main(["new", "leg"]) == 0 and "patternProperties" in (here / SCHEMA).read_text()


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("two words", 'try "two_words"'),
        ("", 'write one such as "beam_1"'),
        ("double", 'it is a word of C; try "double_0"'),
        ("models/arm.toml", "tisserand new arm --out models"),
        ("../arm", 'try "arm"'),
    ],
)
def test_a_bad_name_is_one_clear_line(name: str, advice: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", name]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith(advice)
    assert [*here.iterdir()] == []


def test_run_simulates_and_opens_the_page(here: Path, opened: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "arm", "--kind", "beam"]) == 0
    assert main(["run", "arm.toml", "--set", "EI=50", "--open", "--json"]) == 0
    output = capsys.readouterr()
    summary = json.loads(output.out[output.out.index("{") :])
    page = here / summary["page"]
    assert summary["warnings"] == [] and summary["set"][0]["new"] == "50" and output.err == ""
    assert opened.read_text() == page.as_uri()
    assert summary["page"] in summary["files"] and "<svg" in page.read_text()


def test_run_without_a_display_names_the_page(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("webbrowser.open", lambda address: pytest.fail(f"{address} in a terminal"))
    assert main(["run", str(SYMBOLIC), "--out", "pages", "--open"]) == 0
    output = capsys.readouterr()
    page = Path("pages/body_symbolic/body_symbolic.report.html")
    assert output.err == f"no browser here; open {page} yourself\n"
    assert output.out.endswith(f"wrote {page}\n") and page.exists()


def test_values_that_no_page_shows_are_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Without a simulation a page has the equations, which no duration changes."""
    assert main(["run", str(SYMBOLIC), "--duration", "1", "--output", "0.1"]) == 2
    assert "all numbers of this body are parameters" in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_every_command_takes_a_new_specification(
    kind: str, here: Path, opened: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", "arm", "--kind", kind]) == 0
    spec = "arm.toml"
    studies = [["study", "accuracy", spec, "--runs", "1"], ["choose", spec]] if kind == "mechanism" else []
    commands = [
        ["build", spec],
        ["check", spec],
        ["run", spec, "--open"],
        ["report", spec],
        ["modes", spec, *(["--at", "0"] if kind == "mechanism" else [])],  # a drive moves the crank
        *studies,
    ]
    for command in commands:
        capsys.readouterr()
        assert main(command) == 0, capsys.readouterr().err
        output = capsys.readouterr()
        assert "warning" not in output.out, command
    assert opened.read_text().endswith("/results/arm/arm.html")
