"""Parts of the C that a compilation leaves out: nothing else is missing, and callers that need them get an error."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from toolchain import C99, WARNINGS, run, tool

import derive
from derive.artifacts import File, write
from derive.backends.c.optional_parts import OptionalPart
from derive.cache import no_cache
from derive.generated_models import generated_explicit
from derive.runtime import loading
from derive.runtime.compiler import ESSENTIAL, FLAGS, RUN_FLAGS, CompilerError, compile_c
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.spec.toml.read import parse

NAME = "pushed_pendulum"
SCENE = """
name = "pushed_pendulum"
ground.markers = { o = [0, 0] }
[bodies.rod]
mass = 1
inertia = 0.1
markers = { left = [-1, 0], right = [1, 0] }
start = { position = [1, 0] }
[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]
[inputs.push]
value = "5"
[forces.push]
at = "rod.right"
components = [{ input = "push" }, 0]
[outputs.tip]
kind = "position"
marker = "rod.right"
[simulation]
duration = 0.001
output = 0.001
"""
"""The functions in the descriptor read the input behind the constants."""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("parts") / f"{NAME}.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def files(path: Path) -> tuple[File, ...]:
    return derive.model_files(derive.lower(derive.derive(scene := derive.read(path))), scene)


def functions(library: Path) -> set[str]:
    return set(re.findall(rf" T {NAME}_(\w+)", run(tool("nm"), library)))


def test_each_macro_leaves_out_its_functions_alone(files: tuple[File, ...], tmp_path: Path) -> None:
    write(files, tmp_path)
    source, library = tmp_path / NAME / f"{NAME}.c", tmp_path / "model.so"
    left = []
    for flags in ((), *((f"-D{part.value}",) for part in OptionalPart)):
        compile_c([source], library, [*C99, *WARNINGS, "-O0", "-shared", "-fPIC", *flags])
        left.append(functions(library))
    complete, no_batches, no_forms = left
    assert complete - no_batches == {name for name in complete if name.endswith("_batch")} != set()
    forms = {f"{kind}_{form}" for kind in ("residual", "jacobian") for form in ("ggl", "index1")}
    assert complete - no_forms == forms
    assert no_batches | no_forms <= complete


def test_the_other_functions_have_the_same_bits_and_what_is_missing_is_named(files: tuple[File, ...]) -> None:
    complete, without = derive.load_scene(files), derive.load_scene(files, RUN_FLAGS)
    k, q, v = complete.setup(), 0.1 * np.arange(1, complete.nq + 1), np.ones(complete.nv)
    assert np.array_equal(without.setup(), k)
    for name in ("force", "accel"):
        assert np.array_equal(getattr(without, name)(0.1, q, v, k), getattr(complete, name)(0.1, q, v, k))
    assert tuple(complete.dae) == ("index3", "ggl", "index1") and tuple(without.dae) == ("index3",)
    with pytest.raises(CompilerError, match=r"form ggl is not in this library, which has index3: .*_REDUCED_FORMS"):
        without.dae["ggl"]
    with pytest.raises(CompilerError, match=r"_mass_batch is not in this library.*WITHOUT_BATCHES"):
        without.mass_batch([q], k)


@pytest.mark.parametrize("integrator", ["adaptive", "dop853", "rk4"])
def test_a_simulation_compiles_what_it_needs(path: Path, integrator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    used: list[tuple[str, tuple[str, ...]]] = []
    compiled = loading.compile_shared

    def noted(sources: Sequence[Path], library: Path, flags: Sequence[str] = FLAGS, link: Sequence[str] = ()) -> Path:
        used.append((sources[0].name, tuple(flags)))
        return compiled(sources, library, flags, link)

    monkeypatch.setattr(loading, "compile_shared", noted)
    with no_cache():
        derive.simulate(derive.read(path), integrator=integrator)
    (flags,) = {flags for name, flags in used if name == f"{NAME}.c"}
    assert set(ESSENTIAL) <= set(flags)


def test_an_explicit_model_has_the_same_bits_and_names_what_it_does_not_have(
    path: Path, files: tuple[File, ...], tmp_path: Path
) -> None:
    """The model that studies run: no iteration matrices, loads, derivatives of outputs or batches, and no Python."""
    scene = derive.read(path)
    assert isinstance(scene, derive.Scene)
    model, own = generated_explicit(scene)
    assert [file.path for file in own] == [f"{NAME}/{NAME}.h", f"{NAME}/{NAME}.c"]
    write(own, tmp_path)
    compile_c([tmp_path / own[1].path], tmp_path / "model.so", [*C99, *WARNINGS, "-O0", "-shared", "-fPIC"])
    assert not any(name.endswith("_batch") for name in functions(tmp_path / "model.so"))
    native, complete = derive.load_scene(own, RUN_FLAGS), derive.load_scene(files)
    k, full = native.setup(), complete.setup()
    q, v = 0.1 * np.arange(1, native.nq + 1), np.ones(native.nv)
    pushed, fully = native.with_inputs(k, [3.0]), complete.with_inputs(full, [3.0])
    for name in ("force", "accel", "constraint_rates"):
        assert np.array_equal(getattr(native, name)(0.1, q, v, pushed), getattr(complete, name)(0.1, q, v, fully))
    vdot, lam = native.solve(0.1, q, v, pushed)
    out = native.evaluate_outputs(0.1, q, v, vdot, lam, pushed)
    assert np.array_equal(out, complete.evaluate_outputs(0.1, q, v, vdot, lam, fully))
    assert f"    return {NAME}_solve(" in own[1].text, "compiled once, with that of the multipliers"
    assert model.explicit and not derive.lower(derive.derive(scene)).explicit
    with pytest.raises(CompilerError, match="no jacobian in this library, whose model is for explicit integration"):
        native.jacobian(0.0, np.zeros(0), np.zeros(0), 1.0, k)
    for missing in (
        lambda: native.load("rod_right", q, [1.0, 0.0], k),
        lambda: native.outputs_jacobian(0.1, q, v, vdot, lam, k),
        lambda: native.dae["index3"],
    ):
        with pytest.raises(CompilerError, match=r"no .* in this library, whose model is for explicit integration"):
            missing()


def test_the_c_of_an_explicit_model_leaves_out_the_iteration_matrix_of_its_start() -> None:
    """Compiling it takes longer than interpreting it for one start."""
    start = """[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]
[scene]
lowering = "flat"
start = "equilibrium"
"""
    scene = parse(SCENE.partition("[joints.pin]")[0] + start)
    assert isinstance(scene, derive.Scene)
    model, files = generated_explicit(scene)
    assert model.explicit and model.has_iteration_matrix
    assert f"{NAME}_solve(" in files[1].text and f"{NAME}_jacobian" not in files[1].text
    native = derive.load_scene(files, RUN_FLAGS)
    k, zero = native.setup(), np.zeros(native.nq + native.nv + native.nlambda)
    with pytest.raises(CompilerError, match="no jacobian in this library"):
        native.jacobian(0.0, zero, zero, 1.0, k)
    assert with_iteration_matrix(native, model).jacobian(0.0, zero, zero, 1.0, k).any()
