"""`--to rust`: the crate compiles, has the motion of a simulation, and calls the C with the numbers of Python."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import pytest
from host_models import EVERYWHERE, PUSHED, STEERED, prepared, scene
from programs import program, run

import derive
from derive.errors import SpecError
from derive.export.rust import rust_files

NAMED = PUSHED.replace("push]", "move]").replace('input = "push"', 'input = "move"').replace("pushed", "named")
NAMED = NAMED.replace("[outputs.tip]", "[outputs.self]").replace('kind = "position"', 'kind = "rotation"')
"""The pushed rod with an input and an output whose names are words of Rust."""

MODELS = {
    "pushed": lambda: prepared(PUSHED),
    "steered": lambda: prepared(STEERED),
    "named": lambda: prepared(NAMED),
    "block": lambda: scene("block"),
    **{name: partial(prepared, text) for name, text in EVERYWHERE.items()},
}


def cargo(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """The output of `cargo test`; the crate `cc` is compiled once."""
    target = tmp_path_factory.getbasetemp() / "cargo"
    flags = ("test", "--manifest-path", folder / "Cargo.toml", "--", "--nocapture")
    return run(program("cargo"), *flags, CARGO_TARGET_DIR=str(target), RUSTFLAGS="-D warnings")


@pytest.mark.hosts
@pytest.mark.parametrize("name", MODELS)
def test_the_motion_is_that_of_a_simulation(
    name: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    model = MODELS[name]()
    derive.write(rust_files(model), tmp_path)
    said = cargo(tmp_path, tmp_path_factory)
    assert f"{name}: largest difference from Tisserand:" in said and "1 passed" in said
    native = derive.load(model.files)
    k = native.setup()
    k = native.with_inputs(k, model.constant_inputs) if model.inputs else k
    vdot = native.accel(0.0, *([x.start for x in part] for part in (model.coordinates, model.velocities)), k)
    (line,) = (line.removeprefix("vdot ") for line in said.splitlines() if line.startswith("vdot "))
    assert json.loads(line) == vdot.tolist()


WRONG = {
    "length": ("let mut vdot = [0.0; NV]", "let mut vdot = [0.0; NV + 1]", "mismatched types"),
    "ignored": ("&mut vdot).unwrap();", "&mut vdot);", "must be used"),
}


@pytest.mark.hosts
@pytest.mark.parametrize("fault", WRONG)
def test_the_compiler_refuses(fault: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    derive.write(rust_files(prepared(PUSHED)), tmp_path)
    test = tmp_path / "tests/motion.rs"
    old, new, message = WRONG[fault]
    assert old in test.read_text()
    test.write_text(test.read_text().replace(old, new))
    with pytest.raises(AssertionError, match=message):
        cargo(tmp_path, tmp_path_factory)


def test_the_crate_needs_no_standard_library() -> None:
    """The compiler then refuses what the library would need of it."""
    (library,) = (file.text for file in rust_files(prepared(PUSHED)) if file.path == "src/lib.rs")
    assert "\n#![no_std]\n" in library


@pytest.mark.long
def test_words_of_rust_are_no_names() -> None:
    texts = {file.path: file.text for file in rust_files(prepared(NAMED))}
    assert (
        "pub const r#move: usize = 0;" in texts["src/lib.rs"] and "pub const self_: usize = 0;" in texts["src/lib.rs"]
    )
    for name, what in {"crate": "word", "std": "crate", "test": "crate"}.items():
        with pytest.raises(SpecError, match=f"{name} is a {what} of Rust"):
            rust_files(prepared(PUSHED.replace("pushed", name)))
