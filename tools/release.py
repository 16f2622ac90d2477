"""Builds the wheel and the source distribution, and tries both as a user meets them; uploads nothing.

`make release` runs this. The version is that of derive/version.py; the commit has the tag `v` and the version, or none,
and this then is a rehearsal. Both distributions hold what git tracks and nothing else. Each is installed into an empty
virtual environment, in which the commands and the Python of the README's quick start run in an empty folder.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from email import message_from_string
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DIST = ROOT / "dist"
LEFT_OUT = (".ci/", ".github/")
"""The folders of the repository that the source distribution leaves out."""
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)


class ReleaseError(Exception):
    """A distribution that must not be published; the text says why."""


def main() -> int:
    """Check the version, build, check the contents, and try both distributions."""
    try:
        version = checked_version()
        wheel, sdist = build(version)
        check_contents(wheel, sdist, version)
        for distribution in (wheel, sdist):
            try_out(distribution, version)
    except ReleaseError as error:
        print(f"no release: {error}", file=sys.stderr)
        return 1
    print(f"ready: {wheel.relative_to(ROOT)}, {sdist.relative_to(ROOT)}")
    return 0


def checked_version() -> str:
    """The version of the package, which the tag of this commit and CHANGELOG.md must have."""
    found = re.search(r'^VERSION = "(.+)"$', (ROOT / "derive/version.py").read_text(), re.MULTILINE)
    if found is None:
        raise ReleaseError("derive/version.py has no line VERSION = ...")
    version = found[1]
    tags = git("tag", "--points-at", "HEAD", "--list", "v*").split()
    check_version(version, tags, (ROOT / "CHANGELOG.md").read_text())
    print(f"version {version}" + ("" if tags else f": a rehearsal, since this commit has no tag v{version}"))
    return version


def check_version(version: str, tags: list[str], changelog: str) -> None:
    """Raise ReleaseError if a tag has another version, or the list of changes has no dated section for this one."""
    if tags and tags != [f"v{version}"]:
        raise ReleaseError(f"derive/version.py has version {version}, and this commit has the tag {', '.join(tags)}")
    if not re.search(rf"^## \[{re.escape(version)}\] - \d{{4}}-\d\d-\d\d$", changelog, re.MULTILINE):
        raise ReleaseError(f"CHANGELOG.md has no section `## [{version}] - YYYY-MM-DD`")


def build(version: str) -> tuple[Path, Path]:
    """Build both distributions into dist/, check their metadata, and return the wheel and the source distribution."""
    shutil.rmtree(DIST, ignore_errors=True)
    run([sys.executable, "-m", "build", "--outdir", str(DIST), str(ROOT)], ROOT)
    wheel, sdist = DIST / f"tisserand-{version}-py3-none-any.whl", DIST / f"tisserand-{version}.tar.gz"
    built = sorted(DIST.iterdir())
    if built != sorted([wheel, sdist]):
        raise ReleaseError(f"dist/ holds {', '.join(path.name for path in built)}")
    run([sys.executable, "-m", "twine", "check", "--strict", str(wheel), str(sdist)], ROOT)
    return wheel, sdist


def check_contents(wheel: Path, sdist: Path, version: str) -> None:
    """Raise ReleaseError if a distribution lacks a file that git tracks, or has another one."""
    tracked = git("ls-files", "-z").strip("\0").split("\0")
    package = {name for name in tracked if name.startswith("derive/")}
    package |= {f"derive/{name}" for name in tracked if name.startswith("templates/")}
    info = f"tisserand-{version}.dist-info"
    records = {f"{info}/{name}" for name in ("METADATA", "RECORD", "WHEEL", "entry_points.txt")}
    licences = {f"{info}/licenses/{name}" for name in ("LICENSE", "templates/LICENSE")}
    with zipfile.ZipFile(wheel) as archive:
        compare_names(wheel.name, set(archive.namelist()), package | records | licences)
        check_metadata(archive.read(f"{info}/METADATA").decode(), version)
    with tarfile.open(sdist) as archive:
        names = {member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()}
    compare_names(sdist.name, names, {name for name in tracked if not name.startswith(LEFT_OUT)} | {"PKG-INFO"})


def compare_names(distribution: str, present: set[str], expected: set[str]) -> None:
    """Raise ReleaseError with the first names that are missing or too many."""
    differences = {"lacks": sorted(expected - present), "has besides": sorted(present - expected)}
    texts = [f"{word} {', '.join(names[:5])}" for word, names in differences.items() if names]
    if texts:
        raise ReleaseError(f"{distribution} {'; '.join(texts)}")


def check_metadata(text: str, version: str) -> None:
    """Raise ReleaseError if the metadata of the wheel does not state what an index shows."""
    metadata = message_from_string(text)
    expected = {"Name": "tisserand", "Version": version, "License-Expression": "BSD-3-Clause"}
    wrong = [f"{key}: {metadata[key]}" for key, value in expected.items() if metadata[key] != value]
    wrong += [f"{key} is missing" for key in ("Summary", "Requires-Python", "Classifier") if not metadata[key]]
    if wrong:
        raise ReleaseError(f"metadata of the wheel: {'; '.join(wrong)}")


def try_out(distribution: Path, version: str) -> None:
    """Install a distribution into an empty environment and run the README's quick start there in an empty folder."""
    print(f"trying {distribution.name} in an empty environment ...", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        environment, folder = Path(temporary) / "env", Path(temporary) / "work"
        folder.mkdir()
        run([sys.executable, "-m", "venv", str(environment)], folder)
        programs = environment / ("Scripts" if os.name == "nt" else "bin")
        python = str(programs / "python")
        options = [
            "--quiet",
            "--no-compile",
            "--disable-pip-version-check",
            "--constraint",
            str(ROOT / "constraints.txt"),
        ]
        run([python, "-m", "pip", "install", *options, str(distribution)], folder)
        where = Path(run([python, "-c", "import derive; print(derive.__file__)"], folder).strip())
        if environment.resolve() not in where.resolve().parents:
            raise ReleaseError(f"the environment of {distribution.name} imports {where}")
        tisserand = str(programs / "tisserand")
        if run([tisserand, "--version"], folder).split() != ["tisserand", version]:
            raise ReleaseError(f"{distribution.name}: tisserand --version does not print {version}")
        commands, code = quick_start((ROOT / "README.md").read_text())
        for command in commands:
            print(f"  tisserand {' '.join(command)}", flush=True)
            run([tisserand, *command], folder)
        run([python, "-c", code], folder)


def quick_start(readme: str) -> tuple[list[list[str]], str]:
    """The commands of the README's block that begins with `tisserand new`, which need no repository, and its Python."""
    blocks = BLOCK.findall(readme)
    start = [text for language, text in blocks if language == "sh" and ".venv/bin/tisserand new " in text]
    code = [text for language, text in blocks if language == "python"]
    if len(start) != 1 or not code:
        raise ReleaseError("README.md needs one block of commands with `tisserand new`, and a block of Python")
    lines = [line.split("  #")[0].split() for line in start[0].splitlines()]
    return [words[1:] for words in lines if words and words[0] == ".venv/bin/tisserand"], code[0]


def run(command: list[str], folder: Path) -> str:
    """The output of a command in a folder, which sees no other installation. Raises ReleaseError with its output."""
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ReleaseError(f"{' '.join(command)} failed in {folder}:\n{done.stdout}{done.stderr}")
    return done.stdout


def git(*arguments: str) -> str:
    """The output of a command of git in the repository."""
    return run(["git", *arguments], ROOT)


if __name__ == "__main__":
    sys.exit(main())
