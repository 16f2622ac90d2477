"""`make release` refuses what must not be published; CI runs it as a whole."""

from __future__ import annotations

import importlib.util
import re
import tarfile
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

from conftest import ROOT
from derive.version import VERSION

CHANGES = (ROOT / "CHANGELOG.md").read_text()
KINDS = ("Added", "Changed", "Deprecated", "Removed", "Fixed", "Security")


@pytest.fixture(scope="module")
def release() -> ModuleType:
    spec = importlib.util.spec_from_file_location("release", ROOT / "tools/release.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_list_of_changes_has_the_form_of_keep_a_changelog(release: ModuleType) -> None:
    release.check_version(VERSION, [f"v{VERSION}"], CHANGES)
    first, *versions = re.findall(r"^## (.*)$", CHANGES, re.MULTILINE)
    assert first == "[Unreleased]"
    dated = [re.fullmatch(r"\[(\d+)\.(\d+)\.(\d+)\] - (\d{4}-\d\d-\d\d)", line) for line in versions]
    numbers = [tuple(map(int, match.groups()[:3])) for match in dated if match]
    assert len(numbers) == len(versions) and numbers == sorted(numbers, reverse=True)
    assert set(re.findall(r"^### (.*)$", CHANGES, re.MULTILINE)) <= set(KINDS)


@pytest.mark.parametrize(
    ("version", "tags", "why"),
    [
        (VERSION, ["v0.0.9"], "has the tag v0.0.9"),
        (VERSION, [f"v{VERSION}", "v0.0.9"], "has the tag"),
        ("99.0.0", [], r"no section `## \[99.0.0\]"),
    ],
)
def test_versions_that_do_not_match_are_refused(release: ModuleType, version: str, tags: list[str], why: str) -> None:
    with pytest.raises(release.ReleaseError, match=why):
        release.check_version(version, tags, CHANGES)


def distributions(release: ModuleType, folder: Path, extra: str = "", lacking: str = "") -> tuple[Path, Path]:
    """A wheel and a source distribution with empty files under the tracked names, with or without one of them."""
    tracked = release.git("ls-files").splitlines()
    wheel, sdist = folder / "a.whl", folder / "a.tar.gz"
    package = {name for name in tracked if name.startswith("derive/")}
    package |= {f"derive/{name}" for name in tracked if name.startswith("templates/")}
    info = f"tisserand-{VERSION}.dist-info"
    records = ("RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE", "licenses/templates/LICENSE")
    with zipfile.ZipFile(wheel, "w") as archive:
        for name in sorted((package | {f"{info}/{name}" for name in records} | {extra}) - {lacking, ""}):
            archive.writestr(name, "")
        text = (
            f"Name: tisserand\nVersion: {VERSION}\nLicense-Expression: BSD-3-Clause\nSummary: s\nRequires-Python: >=3\n"
        )
        archive.writestr(f"{info}/METADATA", text + "Classifier: c\n\n")
    with tarfile.open(sdist, "w:gz") as tar:
        for name in ({name for name in tracked if not name.startswith((".ci/", ".github/"))}) | {"PKG-INFO"}:
            tar.addfile(tarfile.TarInfo(f"a/{name}"))
    return wheel, sdist


@pytest.mark.parametrize(
    ("extra", "lacking", "why"),
    [
        ("tests/test_cli.py", "", "has besides tests/test_cli.py"),
        ("", "derive/py.typed", "lacks derive/py.typed"),
        ("", "derive/templates/new/beam.toml", "lacks derive/templates/new/beam.toml"),
        ("", f"tisserand-{VERSION}.dist-info/licenses/LICENSE", "lacks .*LICENSE"),
    ],
)
def test_contents_that_differ_are_refused(
    release: ModuleType, extra: str, lacking: str, why: str, tmp_path: Path
) -> None:
    release.check_contents(*distributions(release, tmp_path), VERSION)
    with pytest.raises(release.ReleaseError, match=why):
        release.check_contents(*distributions(release, tmp_path, extra, lacking), VERSION)


def test_the_quick_start_is_that_of_the_readme(release: ModuleType) -> None:
    commands, code = release.quick_start((ROOT / "README.md").read_text())
    assert [command[0] for command in commands] == ["new", "run"]
    assert not any("scenes" in word for command in commands for word in command) and "import derive" in code
