"""The bracket in CalculiX: what the program writes is imported, and the body has its frequencies to all digits."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import program

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.fem.calculix.read import read_calculix
from derive.reduction import body_properties
from derive.spec.model.body import NodalBody

pytestmark = pytest.mark.hosts


def run_bracket(folder: Path, bricks: tuple[int, int, int], changes: tuple[tuple[str, str], ...] = ()) -> Path:
    """Run CalculiX on the bracket of `scenes/make_bracket.py`, whose input is changed before."""
    path = folder / "bracket.inp"
    subprocess.run([sys.executable, ROOT / "scenes/make_bracket.py", path, *map(str, bricks)], check=True)
    text = path.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path.write_text(text)
    command = [program("ccx"), "bracket"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    return path


def test_the_body_has_the_frequencies_of_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An interface does not change those of the full matrices, which the command prints as well."""
    path = run_bracket(tmp_path, (6, 2, 1))
    monkeypatch.chdir(tmp_path)
    assert main(["import", "bracket.inp", "--modes", "12", "--out", "free.toml"]) == 0
    theirs = read_calculix(path).frequencies
    assert theirs is not None
    free = derive.read("free.toml")
    assert isinstance(free, NodalBody)
    own = body_properties(free).frequencies
    assert [f"{value:.6E}" for value in own] == [f"{value:.6E}" for value in theirs[6:18]]
    assert main(["import", "bracket.inp", "--interface", "left,right", "--modes", "12"]) == 0
    assert main(["build", "bracket.toml", "--out", "generated"]) == 0
    out = capsys.readouterr().out
    assert all(f"{value:.5g}" in out for value in theirs[6:12])
    assert out.count("the 8 of the program differ by") == 2


def test_supports_are_refused_with_the_nodes(tmp_path: Path) -> None:
    path = run_bracket(tmp_path, (1, 1, 1), (("*STEP", "*BOUNDARY\n1, 1, 3\n*STEP"),))
    with pytest.raises(derive.SpecError, match=r"bracket\.inp:68: \*BOUNDARY: the part is held at the nodes 1; "):
        read_calculix(path)


def test_nodes_tied_in_all_directions_move_with_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The middle of an edge that follows its ends alike in x, y and z keeps rigid motions and the form of the mass."""
    path = tmp_path / "bracket.inp"
    subprocess.run([sys.executable, ROOT / "scenes/make_bracket.py", path, "1", "1", "1"], check=True)
    edge = "\n".join(f"*EQUATION\n3\n2, {k}, -2, 1, {k}, 1, 3, {k}, 1" for k in (1, 2, 3))
    path = run_bracket(tmp_path, (1, 1, 1), (("*STEP", f"{edge}\n*STEP"),))
    monkeypatch.chdir(tmp_path)
    assert main(["import", "bracket.inp", "--modes", "8"]) == 0
    out = capsys.readouterr().out
    assert "1 node that follows others (*EQUATION in line 68) is left out" in out
    body, theirs = derive.read("bracket.toml"), read_calculix(path).frequencies
    assert isinstance(body, NodalBody) and theirs is not None
    assert np.allclose(body_properties(body).frequencies, theirs[6:14], rtol=1e-6)
    assert float(body.data.mass.sum()) == pytest.approx(2.3864)


def test_point_masses_are_in_the_matrices(tmp_path: Path) -> None:
    mass = "*ELEMENT, TYPE=MASS, ELSET=load\n900, 1\n*MASS, ELSET=load\n0.5\n*STEP"
    model = read_calculix(run_bracket(tmp_path, (1, 1, 1), (("*STEP", mass),)))
    assert float(model.mass[::3][:, ::3].sum()) == pytest.approx(2.3864 + 0.5)  # type: ignore[index]
    assert model.notes[0] == "1 line of elements of the type MASS: in the matrices, but not in pictures"
