"""Zig compiles what `simulate` compiles, a model with its integrator in C, for Windows and macOS; nothing is run."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from conftest import ROOT
from derive.artifacts import File
from derive.runtime.compiler import RUN_FLAGS, compile_shared
from derive.runtime.integrators.adaptive import SOURCES
from derive.runtime.integrators.compilation import header_flags, write_sources

pytestmark = pytest.mark.hosts

BEGINNINGS = {"x86_64-windows-gnu": b"MZ", "aarch64-macos": b"\xcf\xfa\xed\xfe"}
"""The first bytes of a library: those of a PE file, and those of a Mach-O file of 64 bits."""


@pytest.mark.parametrize("target", BEGINNINGS)
def test_models_and_integrators_compile_for_other_systems(
    target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("ziglang", reason="Zig is missing: make test-hosts installs it")
    monkeypatch.setenv("CC", f"{sys.executable} -m ziglang cc -target {target}")
    monkeypatch.setattr("derive.runtime.compiler.OWN_SYMBOLS", ())  # as on these systems
    folder = ROOT / "generated/double_pendulum"
    files = [File(f"{folder.name}/{p.name}", p.read_text(encoding="utf-8")) for p in folder.iterdir()]
    name, sources = write_sources(files, SOURCES, tmp_path)
    flags = [*RUN_FLAGS, *header_flags(name, tmp_path), "-Wno-unused-command-line-argument", "-Werror"]
    library = compile_shared(sources, tmp_path / "model.so", flags)
    assert library.read_bytes().startswith(BEGINNINGS[target])
