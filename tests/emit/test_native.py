"""Calling compiled models: sizes are checked before C sees them, and compilers that fail say why."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toolchain import special, tool

import beams
import derive
import free_block
from conftest import QUICK
from derive.backends.c.source import ABI
from derive.roles import Role
from derive.runtime import compiler as compiler_module
from derive.runtime import loading
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import FLAGS, CompilerError

Q, V = beams.state(2)
Y = np.concatenate([Q, V])


def calls() -> dict[str, tuple[Callable[..., Any], tuple[Any, ...]]]:
    """Each function of a compiled model, with right arguments."""
    model = beams.native("point", 2)
    k = model.setup()
    state = (Q, V, k)
    return {
        "setup": (model.setup, (model.defaults,)),
        "mass": (model.mass, (Q, k)),
        "force": (model.force, (0.0, *state)),
        "mass_force": (model.mass_force, (0.0, *state)),
        "accel": (model.accel, (0.0, *state)),
        "energy": (model.energy, state),
        "momentum": (model.momentum, state),
        "rates": (model.rates, state),
        "residual": (model.residual, (0.0, Y, Y, k)),
        "jacobian": (model.jacobian, (0.0, Y, Y, 1.0, k)),
        "marker": (lambda *arguments: model.marker("right", *arguments), state),
    }


def test_wrong_lengths_are_refused() -> None:
    for function, right in calls().values():
        function(*right)
        for place, value in enumerate(right):
            if np.ndim(value) == 0:
                continue
            for wrong in (value[:-1], np.append(value, 0.0), value[None, :], 1.0):
                with pytest.raises(ValueError, match=f"a vector of {len(value)} is needed, not an array of shape"):
                    function(*right[:place], wrong, *right[place + 1 :])


def test_takes_lists_integers_and_strided_arrays() -> None:
    model = beams.native("point", 2)
    k = model.setup()
    strided = np.repeat(Q, 2)[::2]
    assert not strided.flags.c_contiguous
    expected = model.mass(Q, k)
    assert np.array_equal(model.mass(list(Q), list(k)), expected)
    assert np.array_equal(model.mass(strided, k), expected)
    assert np.array_equal(model.setup([1, 2, 3]), model.setup([1.0, 2.0, 3.0]))


def test_describes_the_model() -> None:
    made, model = beams.made("point", 2), beams.native("point", 2)
    assert (model.name, model.nq, model.nv, model.np) == ("beam_point_2", 5, 5, 3)
    assert model.nk == len(made.model.constants)
    assert model.parameters == ("m", "l", "EI")
    assert list(model.defaults) == [1.3, 0.7, 2.1]
    assert model.coordinates == ("c1", "c2", "phi", "alpha1", "alpha2")
    assert model.markers == ("left", "inside", "right")
    assert model.mass_pattern == made.model.pattern("mass", "M")
    assert model.jacobian_pattern == made.model.pattern("jacobian", "jac")
    for marker in model.markers:
        assert model.marker_pattern(marker) == made.model.pattern(f"marker_{marker}", "jacobian")


def test_a_model_may_have_no_markers() -> None:
    assert derive.load(special("no_markers").files, QUICK).markers == ()


def test_a_body_alone_is_a_scene_without_constraints_and_ports() -> None:
    """Functions that accept a scene accept a single body as well."""
    model = beams.native("point", 2)
    k = model.with_inputs(model.setup(), [])
    assert not model.is_scene and not model.dae
    assert model.bodies == model.multipliers == model.inputs == model.outputs == ()
    assert model.constraint_pattern.dense(model.constraint_jacobian(0.0, Q, k)).shape == (0, model.nv)
    assert model.constraints(0.0, Q, k).shape == model.constraint_rates(0.0, Q, V, k).shape == (0,)
    vdot, multipliers = model.solve(0.0, Q, V, k)
    assert vdot.tolist() == model.accel(0.0, Q, V, k).tolist() and multipliers.shape == (0,)
    assert model.project_velocity(0.0, Q, k, np.zeros(0)).tolist() == [0.0] * model.nv


def test_models_live_side_by_side() -> None:
    """All are called model.so in folders that are gone; none may be taken for another."""
    names = [derive.load(beams.made(frame, 2).files, QUICK) for frame in ("mean", "point", "mean")]
    assert [native.name for native in names] == ["beam_mean_2", "beam_point_2", "beam_mean_2"]


def test_an_unknown_marker_is_named() -> None:
    model = beams.native("point", 2)
    for call in (lambda: model.marker("nowhere", Q, V, model.setup()), lambda: model.marker_pattern("nowhere")):
        with pytest.raises(derive.UnknownNameError, match=r"nowhere.*left, inside, right"):
            call()


def test_positions_of_many_states_are_those_of_each() -> None:
    model = beams.native("point", 2)
    k, q = model.setup(), np.asarray(Q) + np.linspace(0, 1, 5)[:, None]
    expected = [model.marker("left", row, V, k)[0] for row in q]
    assert np.array_equal(model.marker_positions("left", q, [V] * 5, k), expected)
    assert np.array_equal(model.marker_positions("left", q[:, ::-1][:, ::-1], [V] * 5, k), expected), "other strides"
    assert np.array_equal(model.marker_positions("left", q[0][None], np.array(V)[None], k), expected[:1]), "stride 0"
    for wrong in (q[0], q[:, 1:]):
        with pytest.raises(ValueError, match="marker_left: rows of "):
            model.marker_positions("left", wrong, [V] * 5, k)


def test_roles_of_the_coordinates() -> None:
    assert beams.native("point", 2).roles == (*[Role.TRANSLATION] * 2, Role.ROTATION, *[Role.AMPLITUDE] * 2)


@pytest.mark.parametrize("lowering", ["flat", "loops"])
def test_roles_of_a_spatial_body_in_both_lowerings(lowering: str) -> None:
    expected = (*[Role.TRANSLATION] * 3, *[Role.QUATERNION] * 4, *[Role.AMPLITUDE] * 2)
    assert free_block.native("mean", lowering, 2).roles == expected


def test_parameters_by_name() -> None:
    model = beams.native("point", 2)
    m, length, _ = model.defaults
    assert model.parameters == ("m", "l", "EI")
    assert np.array_equal(model.setup(EI=30), model.setup([m, length, 30]))
    assert np.array_equal(model.setup({"EI": 30, "m": 2}), model.setup([2, length, 30]))
    assert np.array_equal(model.setup([2, 1.5, 1], EI=30), model.setup([2, 1.5, 30]))
    with pytest.raises(derive.ModelError, match=r"not positive; refused: l = nan, EI = -1$"):
        model.setup(m=3, l=float("nan"), EI=-1)  # and the mass is not refused
    with pytest.raises(derive.UnknownNameError, match=r"no parameter of .* \"ei\".*known: m, l, EI"):
        model.setup(ei=30)


def test_matrices_dense_and_sparse() -> None:
    """Patterns are symmetric or not; states are one or many; structural zeros are absent."""
    model = beams.native("point", 2)
    k = model.setup()
    values = model.mass(Q, k)
    dense = model.mass_pattern.dense(values)
    assert np.array_equal(dense, dense.T) and np.all(np.linalg.eigvalsh(dense) > 0)
    assert [dense[entry] for entry in model.mass_pattern.entries] == values.tolist()
    sparse = model.mass_pattern.sparse(values)
    assert np.array_equal(sparse.toarray(), dense) and sparse.nnz == model.mass_pattern.full_nnz
    assert np.array_equal(model.mass_pattern.dense(model.mass_batch([Q, Q], k)), [dense, dense])
    jacobian, pattern = model.marker("left", Q, V, k)[2], model.marker_pattern("left")
    assert np.allclose(pattern.dense(jacobian) @ V, model.marker("left", Q, V, k)[1])
    assert np.array_equal(pattern.sparse(jacobian).toarray(), pattern.dense(jacobian))
    with pytest.raises(ValueError, match=r"entries; the values have shape \(2,\)"):
        pattern.dense([1.0, 2.0])


def test_another_interface_number_is_refused() -> None:
    files = [
        replace(file, text=file.text.replace(f'    {ABI},\n    "beam_mean_2"', '    99,\n    "beam_mean_2"'))
        for file in beams.made("mean", 2).files
    ]
    with pytest.raises(CompilerError, match=f"beam_mean_2: its interface has number 99, this Tisserand knows {ABI}"):
        derive.load(files)


# Compilers


def load_with(compiler: str, monkeypatch: pytest.MonkeyPatch) -> Native:
    monkeypatch.setenv("CC", compiler)
    return derive.load(beams.made("mean", 2).files)


def test_a_compiler_that_is_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message says what is used instead, or what to install."""
    start = r"^CC=nonsense -O3: there is no command nonsense; set the environment variable CC to a C compiler, such as"
    with pytest.raises(CompilerError, match=rf"{start} gcc or clang, or unset it, and \S+cc is used$"):
        load_with("nonsense -O3", monkeypatch)
    monkeypatch.setattr(compiler_module.shutil, "which", lambda name: None)
    monkeypatch.setattr(compiler_module, "find_spec", lambda name: None)
    with pytest.raises(CompilerError, match=rf"{start} gcc or clang, or unset it and install gcc or clang$"):
        load_with("nonsense -O3", monkeypatch)


def test_a_compiler_that_cannot_be_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    broken.write_text("no program")
    broken.chmod(0o755)
    with pytest.raises(CompilerError, match=r"^the C compiler \S+broken cannot be run: Exec format error; set CC"):
        load_with(str(broken), monkeypatch)


def test_a_compiler_that_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message has the command, to try it by hand, and all output of the compiler."""
    with pytest.raises(CompilerError, match=r"(?s)^\S*gcc -Dconst=nonsense -std=c99.*beam_mean_2\.c.*error:"):
        load_with(f"{tool('gcc')} -Dconst=nonsense", monkeypatch)


def test_a_compiler_that_cannot_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(CompilerError, match="CC"):
        load_with("'gcc", monkeypatch)


def test_a_blank_compiler_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    assert load_with("  ", monkeypatch).name == "beam_mean_2"


def test_cc_is_honoured_with_its_options(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    log, wrapper = tmp_path / "log", tmp_path / "my cc"
    wrapper.write_text(f'#!/bin/sh\necho "$@" >> "{log}"\nexec "{tool("gcc")}" "$@"\n')
    wrapper.chmod(0o755)
    assert load_with(f"'{wrapper}' -DOPTION", monkeypatch).name == "beam_mean_2"
    shared = ["-shared", "-fPIC", *compiler_module.OWN_SYMBOLS, "-o "]
    assert log.read_text().splitlines()[-1].startswith(" ".join(["-DOPTION", *FLAGS, *shared]))


def test_an_empty_cc_is_no_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    assert load_with("", monkeypatch).name == "beam_mean_2"


def test_compilers_are_looked_for_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    present = {"clang", "gcc"}
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(compiler_module.shutil, "which", lambda name: f"/bin/{name}" if name in present else None)
    assert compiler_module.compiler() == ["/bin/gcc"]
    present.remove("gcc")
    assert compiler_module.compiler() == ["/bin/clang"]
    present.clear()
    monkeypatch.setattr(compiler_module, "find_spec", lambda name: name == "ziglang" or None)
    assert compiler_module.compiler() == [sys.executable, "-m", "ziglang", "cc"]
    monkeypatch.setattr(compiler_module, "find_spec", lambda name: None)
    with pytest.raises(CompilerError, match="no C compiler found: set CC, install gcc or clang, or `pip install"):
        compiler_module.compiler()


def test_nothing_is_left_behind(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(loading.tempfile, "tempdir", str(tmp_path))
    derive.load(beams.made("mean", 2).files)
    with pytest.raises(CompilerError):
        load_with("false", monkeypatch)
    assert list(tmp_path.iterdir()) == []


# Arguments that doubles cannot hold, and constants of other models


def test_imaginary_parts_and_masks_are_refused() -> None:
    """Conversion to doubles would drop them."""
    model = beams.native("point", 2)
    k = model.setup()
    for wrong, text in ((Q + 1j, "real numbers are needed"), (np.ma.masked_greater(Q, 0.0), "masked elements")):
        for call in (
            lambda q: model.accel(0.0, q, V, k),
            lambda q: model.accel_batch(0.0, [q], [V], k) if np.iscomplexobj(q) else model.mass_batch(q[None], k),
            lambda q: model.setup(q[:3]),
        ):
            with pytest.raises(ValueError, match=text):
                call(wrong)
    with pytest.raises(ValueError, match="beam_point_2_force: real numbers are needed"):
        model.force(np.complex128(1j), Q, V, k)
    with pytest.raises(ValueError, match="real numbers are needed"):
        model.setup(EI=np.complex128(2 + 1j))
    assert np.array_equal(model.mass(np.ma.masked_greater(Q, 9.0), k), model.mass(Q, k))  # nothing is masked


def test_constants_of_another_model_are_refused() -> None:
    """Constants of another model are refused even if they are as many. Arrays that no setup returned are accepted."""
    model = beams.native("point", 2)
    k = model.setup()
    other = derive.load(beams.build(beams.beam("point", 2, mass={**beams.MASS, "default": 5.0})).files, QUICK)
    foreign = other.setup()
    assert (other.name, len(foreign)) == (model.name, len(k))
    for wrong in (foreign, 2 * foreign, foreign.copy()):
        for call in (model.mass, model.mass_batch):
            with pytest.raises(ValueError, match="beam_point_2: the constants k come from the setup of another model"):
                call(Q if call is model.mass else [Q], wrong)
    assert np.array_equal(model.mass(Q, k), model.mass(Q, list(k)))
    assert np.array_equal(model.mass(Q, k.copy()), derive.load(beams.made("point", 2).files, QUICK).mass(Q, k))
