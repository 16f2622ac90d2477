"""Workflow files for public services and templates of issues: they parse, and call existing targets of the Makefile."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from conftest import ROOT

WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
FORMS = sorted(path for path in (ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml") if path.stem != "config")
TARGETS = set(re.findall(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)[0].split())
OTHER = re.compile(r"sudo apt-get|\.ci/run$")
"""Lines of a workflow that call no target: what a system needs, and the script that calls several targets."""


def steps(path: Path) -> list[dict[str, Any]]:
    """The steps of all jobs of a workflow."""
    return [step for job in yaml.safe_load(path.read_text())["jobs"].values() for step in job["steps"]]


def test_there_are_some() -> None:
    assert {path.stem for path in WORKFLOWS} == {"release", "tests"} and len(FORMS) >= 2


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_call_targets_of_the_makefile_alone(path: Path) -> None:
    lines = [line for step in steps(path) for line in step.get("run", "").splitlines()]
    called = [line for line in lines if not OTHER.match(line)]
    assert called
    for line in called:
        assert (words := line.split())[0] == "make" and words[1] in TARGETS, line
    assert all(
        set(step) <= {"uses", "with", "run", "if"} and ("uses" in step) != ("run" in step) for step in steps(path)
    )


def test_all_systems_and_versions_of_python_are_tried() -> None:
    jobs = yaml.safe_load((ROOT / ".github/workflows/tests.yml").read_text())["jobs"]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    listed = {
        c.rpartition(" ")[2] for c in project["classifiers"] if c.startswith("Programming Language :: Python :: 3.")
    }
    matrix = jobs["test"]["strategy"]["matrix"]
    assert set(matrix["python"]) == listed and project["requires-python"] == f">={min(listed)}"
    assert {system.partition("-")[0] for system in matrix["system"]} == {"ubuntu", "macos", "windows"}


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_forms_of_issues_have_what_the_host_needs(path: Path) -> None:
    form = yaml.safe_load(path.read_text())
    assert form["name"] and form["description"]
    fields = [field for field in form["body"] if field["type"] != "markdown"]
    assert len({field["id"] for field in fields}) == len(fields) >= 3
    for field in fields:
        assert field["type"] in ("textarea", "input", "dropdown", "checkboxes") and field["attributes"]["label"]


def test_targets_of_the_makefile_have_rules() -> None:
    makefile = (ROOT / "Makefile").read_text()
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in TARGETS)
