"""Models, integrals and libraries that the cache keeps, and when they are made anew."""

from __future__ import annotations

import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive import cache, generated_models, kept_objects
from derive.backends.model_files import fingerprint
from derive.generated_models import generated
from derive.mechanics.time_integrals import closed_form, kept
from derive.registry import Registry
from derive.runtime import loading
from test_cache import empty_cache, forbidden, swing


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return empty_cache(tmp_path, monkeypatch)


@pytest.mark.parametrize("source", ["free_beam_mean", "body_symbolic", "block", "swing"])
def test_kept_models_are_those_that_are_made(source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = derive.read(swing(tmp_path) if source == "swing" else ROOT / f"scenes/{source}.toml")
    made = generated(spec)
    monkeypatch.setattr(generated_models, "_made", forbidden)
    assert generated(spec) == made
    assert type(generated(spec)[1][1]) is type(made[1][1])
    with cache.no_cache(), pytest.raises(AssertionError, match="made anew"):
        generated(spec)


def test_models_are_made_anew_where_anything_else_is_different(monkeypatch: pytest.MonkeyPatch) -> None:
    beam = derive.planar_beam("kept")
    generated(beam)
    monkeypatch.setattr(generated_models, "_made", forbidden)
    generated(beam)
    with pytest.raises(AssertionError, match="made anew"):
        generated(replace(beam, name="other"))
    with monkeypatch.context() as patch:
        patch.setattr(kept_objects, "package_hash", lambda: "other sources")
        with pytest.raises(AssertionError, match="made anew"):
            generated(beam)
    with monkeypatch.context() as patch:
        patch.setattr(kept_objects, "version", lambda name: "another version")
        with pytest.raises(AssertionError, match="made anew"):
            generated(beam)
    for registry in generated_models.OPEN:
        registry.register("of my own", next(iter(registry.values())))
        try:
            with pytest.raises(AssertionError, match="made anew"):
                generated(beam)
        finally:
            registry.unregister("of my own")
    generated(beam)


def test_all_registries_that_change_models_are_known() -> None:
    """Integrators, interfaces and readers do not change them, nor do bodies in space, which are not open."""
    others = {"integrator", "interface", "file of a finite-element program"}
    modules = [module for name, module in [*sys.modules.items()] if name.startswith("derive.")]
    found = {id(value): value for module in modules for value in vars(module).values() if isinstance(value, Registry)}
    kinds = {registry.kind for registry in found.values()} - others
    assert kinds == {registry.kind for registry in generated_models.OPEN} and len(kinds) > 8


def test_the_integral_of_a_speed_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is found once; that of another speed, and of one of another package, is found anew."""
    speed = derive.time_function("t*sin(3*t)")
    expected = closed_form.time_integral(speed)
    kept.kept_integral.cache_clear()
    assert kept.kept_integral(speed) == expected
    assert len([*folder.iterdir()]) == 1
    monkeypatch.setattr(closed_form, "time_integral", forbidden)
    kept.kept_integral.cache_clear()
    assert kept.kept_integral(speed) == expected
    with pytest.raises(AssertionError, match="made anew"):
        kept.kept_integral(derive.time_function("t*sin(4*t)"))
    kept.kept_integral.cache_clear()
    with monkeypatch.context() as patch, pytest.raises(AssertionError, match="made anew"):
        patch.setattr(kept_objects, "package_hash", lambda: "other sources")
        kept.kept_integral(speed)


def test_kept_libraries_are_loaded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = generated(derive.planar_beam("kept"))[1]
    with cache.no_cache():
        derive.load(files, QUICK)
    count = len([*folder.iterdir()])
    native = derive.load(files, QUICK)
    assert len([*folder.iterdir()]) == count + 1
    derive.load(files, [*QUICK, "-march=native"])
    assert len([*folder.iterdir()]) == count + 1, "another machine may use the same folder"
    monkeypatch.setattr(loading, "compile_shared", forbidden)
    again, k = derive.load(files, QUICK), native.setup()
    q = np.linspace(0.1, 0.5, native.nq)
    assert np.array_equal(again.mass(q, again.setup()), native.mass(q, k))
    for flags in ([*QUICK, "-DOTHER"], [*QUICK, "-march=native"]):
        with pytest.raises(AssertionError, match="made anew"):
            derive.load(files, flags)
    changed = [replace(file, text=f"{file.text}\n") if file.path.endswith(".h") else file for file in files]
    with pytest.raises(AssertionError, match="made anew"):
        derive.load(changed, QUICK)
    monkeypatch.setattr(loading, "compiler_identity", lambda: "another compiler")
    with pytest.raises(AssertionError, match="made anew"):
        derive.load(files, QUICK)


def test_bodies_of_other_numbers_have_models_of_their_own() -> None:
    """This holds also where the numbers come from one file, as those that Python has replaced, or from none."""
    block = derive.read(ROOT / "scenes/block.toml")
    assert isinstance(block, derive.NodalBody)
    block = replace(block, modes=2)
    stiff = block.data.modal_stiffness
    assert stiff is not None
    soft = replace(block, data=replace(block.data, stiffness=None, modal_stiffness=1e-4 * stiff))
    heavy = replace(block, data=replace(block.data, mass=2 * block.data.mass))
    assert len({fingerprint(body) for body in (block, soft, heavy, replace(block, data=replace(block.data)))}) == 3
    pairs = [(body, generated(body)[1]) for body in (block, soft)]
    texts = [{file.path: file.text for file in files} for _, files in pairs]
    assert texts[0]["block/block.c"] != texts[1]["block/block.c"]
    for body, text in zip((block, soft), texts, strict=True):
        assert text == {file.path: file.text for file in derive.model_files(derive.lower(derive.derive(body)), body)}


@pytest.mark.parametrize(("terms", "makings"), [(3000, 1), (20_000, 2)])
def test_deep_sums_are_kept_and_far_deeper_ones_are_made_again(terms: int, makings: int) -> None:
    """An output of a finite-element body is a sum of hundreds of terms: a RecursionError ended the command."""
    made = []

    def nested() -> object:
        made.append(True)
        result: object = Fraction(1)
        for _ in range(terms):
            result = (result,)
        return result

    for _ in range(2):
        assert kept_objects.kept_object("deep", str(terms), nested)
    assert len(made) == makings
