"""Sweeps: the runs of `simulate` to the bit, however they are divided, and whatever happens to their workers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sweep_scenes import FLAG, SLIDER, kill_at_seven, kill_once, pendulum, slider

import derive
from conftest import ROOT
from derive.errors import SpecError
from derive.registry import UnknownNameError
from derive.simulation.observables.marker_positions import deflection
from derive.spec.model.plots import Deflection
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from derive.study.sweep import executors
from derive.study.sweep.executors import KILLS, ExecutorLost
from derive.study.sweep.outputs import OutputError, Statistic, SweepOutput, output
from derive.study.sweep.plan import RunOptions, check_outputs, make_plan
from derive.study.sweep.result import SweepResult
from derive.study.sweep.run import SweepFailed, sweep
from derive.study.sweep.samples import Samples, SamplesError, grid, listed, random_samples, uniform
from derive.study.sweep.store import SampleStore, StaleStore
from derive.study.sweep.worker import ModelCode
from explicit_motion import moved

OUTPUTS = ("peak", "rms:slider_s", "final:rod_phi", "peak:lambda_slider_pin_1", "final:motor")
GRID = grid({"EI": [8, 12, 20], "speed": [100, 150, 170]})


@pytest.fixture
def threads() -> Iterator[Executor]:
    """An executor without processes of its own."""
    with ThreadPoolExecutor(1) as executor:
        yield executor


def same(a: SweepResult, b: SweepResult) -> bool:
    return a.values.tobytes() == b.values.tobytes() and a.failures == b.failures


def simulated(values: dict[str, str], duration: float | None = None, until: str | None = None) -> tuple[float, ...]:
    """The outputs of a run by `simulate`, from its columns."""
    scene, _ = with_values(slider(), values)
    run = moved(scene, duration=duration, until=until)
    quantity = scene.plots[0].quantity
    assert isinstance(quantity, Deflection)
    square = run["slider_s"] ** 2
    steps = np.diff(run.t)
    rms = np.sqrt(np.sum(steps * (square[1:] + square[:-1]) / 2) / (run.t[-1] - run.t[0]))
    peak = np.abs(deflection(run.motion, quantity)).max()
    return peak, rms, run["rod_phi"][-1], np.abs(run["lambda_slider_pin_1"]).max(), run["motor"][-1]


def test_a_sample_is_the_run_of_simulate_to_the_bit(threads: Executor) -> None:
    """Parameters that change forces alone, and such that change the motion of a drive, the mass and the geometry."""
    samples = listed(
        {
            "EI": [12, 8, 12.5],
            "g": [-9.81, 0, 2],
            "speed": [150, 150, -140.25],
            "radius": [0.15, 0.15, 0.12],
            "m": [0.07, 0.07, 0.1],
            "F": [-2, -2, 1],
        }
    )
    result = sweep(slider(), samples, OUTPUTS, executor=threads)
    assert result.models == 1 and not result.failures and len(set(result.column("peak_deflection"))) == 3
    values = {name: repr(value) for name, value in result.sample(2).items()}
    expected = simulated(values)
    got = result.values[2]
    assert got[1] == pytest.approx(expected[1], rel=1e-14)  # the sum of the rms has an order of its own
    assert np.delete(got, 1).tolist() == [x for i, x in enumerate(expected) if i != 1], values


def test_a_function_of_time_is_replaced_by_numbers(threads: Executor) -> None:
    """This works also where a parameter is left out thereby, since no function uses it any more."""
    text = SLIDER.replace('speed = { symbol = "speed", default = 150 }', 'speed = "Omega*step(t, -1, 0)"')
    scene = parse(text.replace("[parameters]", '[parameters]\nOmega = { default = 3, unit = "rad/s" }'))
    speeds = [100, 150]
    result = sweep(scene, grid({"drives.motor.speed": speeds}), ["final:motor"], executor=threads, duration=0.002)
    np.testing.assert_allclose(result["final_motor"], 0.002 * np.array(speeds), rtol=1e-12)
    assert result.models == 1


def test_breaks_follow_the_parameters(threads: Executor) -> None:
    """A torque that begins at a time which is a parameter: the integrator stops there and starts anew."""
    samples = grid({"jump": [0.02, 0.07], "c": [50], "arm": [0.6]})
    result = sweep(pendulum(), samples, ["final:bob_phi", "peak:bob_phidot"], executor=threads)
    run = moved(with_values(pendulum(), {"jump": "0.07", "c": "50", "arm": "0.6"})[0])
    assert result.values[1].tolist() == [run["bob_phi"][-1], np.abs(run["bob_phidot"]).max()]


def test_the_time_can_be_changed_and_ended_by_a_condition(threads: Executor) -> None:
    samples = grid({"speed": [150, 160]})
    result = sweep(slider(), samples, ["final:t", "final:motor"], duration=0.02, until="motor > 1", executor=threads)
    assert result["final_motor"].tolist() == pytest.approx([1, 1], abs=1e-12)
    assert result["final_t"].tolist() == pytest.approx([1 / 150, 1 / 160], rel=1e-12)
    assert not result.notes
    slow = sweep(slider(), samples, ["final:t"], until="motor + 0*lambda_slider_pin_1 > 1", executor=threads)
    assert slow["final_t"].tolist() == result["final_t"].tolist()
    missed = sweep(slider(), samples, ["final:t"], until="motor > 9", executor=threads)
    assert missed["final_t"].tolist() == [0.01, 0.01]
    ((text, numbers),) = missed.remarks()
    assert "not met" in text and numbers == (0, 1)


@pytest.mark.parametrize(("workers", "chunk"), [(1, 9), (2, 1), (2, 4)])
def test_results_are_the_same_to_the_bit_for_any_chunks_and_workers(
    workers: int, chunk: int, threads: Executor
) -> None:
    one = sweep(slider(), GRID, OUTPUTS, executor=threads, chunk=2)
    assert same(one, sweep(slider(), GRID, OUTPUTS, workers=workers, chunk=chunk))


def test_threads_share_a_library(threads: Executor) -> None:
    with ThreadPoolExecutor(4) as four:
        several = sweep(slider(), GRID, OUTPUTS, executor=four, chunk=1)
    assert same(several, sweep(slider(), GRID, OUTPUTS, executor=threads))


def test_the_order_of_the_samples_does_not_matter(threads: Executor) -> None:
    order = np.random.default_rng(1).permutation(len(GRID))
    shuffled = Samples(GRID.names, GRID.values[order])
    one, other = (sweep(slider(), samples, OUTPUTS, executor=threads) for samples in (GRID, shuffled))
    assert one.values[order].tobytes() == other.values.tobytes()
    assert one["peak_deflection"].shape == (3, 3) and other["peak_deflection"].shape == (9,)


def test_a_killed_worker_loses_nothing(threads: Executor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = sweep(slider(), GRID, OUTPUTS, executor=threads)
    monkeypatch.setenv(FLAG, str(tmp_path / "killed"))
    monkeypatch.setattr(executors, "run_chunk", kill_once)
    assert same(sweep(slider(), GRID, OUTPUTS, workers=2, chunk=2), expected)
    assert (tmp_path / "killed").exists()


def test_a_sample_that_kills_its_workers_is_named_and_the_others_are_finished(
    threads: Executor, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = sweep(slider(), GRID, OUTPUTS, executor=threads)
    monkeypatch.setattr(executors, "run_chunk", kill_at_seven)
    result = sweep(slider(), GRID, OUTPUTS, workers=2, chunk=4)
    assert result.failures == {7: KILLS} and np.isnan(result.values[7]).all()
    assert np.delete(result.values, 7, 0).tobytes() == np.delete(expected.values, 7, 0).tobytes()


def test_an_executor_of_the_caller_that_breaks_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its chunks that are finished are kept, and the next run goes on from them."""
    monkeypatch.setattr(executors, "run_chunk", kill_at_seven)
    store = tmp_path / "store"
    with ProcessPoolExecutor(1) as executor, pytest.raises(ExecutorLost, match="resume"):
        sweep(slider(), GRID, OUTPUTS, executor=executor, chunk=1, store=store)
    monkeypatch.undo()
    result = sweep(slider(), GRID, OUTPUTS, workers=1, store=store, resume=True)
    assert result.resumed > 0 and same(result, sweep(slider(), GRID, OUTPUTS, workers=1))


def interrupted(store: Path, threads: Executor, after: int = 4) -> None:
    """Leave a store with so many finished samples."""

    def progress(finished: int, total: int) -> None:
        if finished >= after:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(slider(), GRID, OUTPUTS, executor=threads, chunk=1, store=store, progress=progress)


def test_an_interrupted_sweep_goes_on(tmp_path: Path, threads: Executor) -> None:
    store, expected = tmp_path / "store", sweep(slider(), GRID, OUTPUTS, executor=threads)
    interrupted(store, threads)
    with store.open("ab") as file:
        file.write(b'{"n": 8, "v": ["0x1.')  # the process was killed while it wrote
    with pytest.raises(StaleStore, match="4 finished samples; continue it with --resume"):
        sweep(slider(), GRID, OUTPUTS, executor=threads, store=store)
    result = sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
    assert result.resumed == 4 and same(result, expected)
    again = sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
    assert again.resumed == 9 and same(again, expected)


@pytest.mark.parametrize(
    "damage",
    [
        lambda line: b'{"n": 1}',
        lambda line: b"[]",
        lambda line: b"\xff\x00" + line,
        lambda line: line[: len(line) // 2],
        lambda line: line.replace(b"0x1.", b"0x1.1"),
    ],
    ids=["no values", "a list", "bytes", "half a line", "another number"],
)
def test_a_damaged_line_is_left_out_and_its_sample_computed_again(
    damage: Callable[[bytes], bytes], tmp_path: Path, threads: Executor
) -> None:
    store, expected = tmp_path / "store", sweep(slider(), GRID, OUTPUTS, executor=threads)
    interrupted(store, threads)
    head, first, second, *rest = store.read_bytes().splitlines()
    assert damage(second) != second
    store.write_bytes(b"".join(line + b"\n" for line in (head, first, damage(second), *rest)))
    result = sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
    assert (result.resumed, result.damaged) == (3, 1) and same(result, expected)


def test_two_sweeps_do_not_write_to_one_store(tmp_path: Path) -> None:
    store = SampleStore(tmp_path / "store", {}, resume=False)
    with pytest.raises(StaleStore, match="another sweep writes there"):
        SampleStore(tmp_path / "store", {}, resume=True)
    store.close()
    assert SampleStore(tmp_path / "store", {}, resume=True).finished == ()


@pytest.mark.parametrize("part", ["the specification", "the samples", "the outputs"])
def test_a_stale_store_is_refused(part: str, tmp_path: Path, threads: Executor) -> None:
    store = tmp_path / "store"
    interrupted(store, threads)
    before = store.read_bytes()
    scene, samples, outputs = slider(), GRID, OUTPUTS
    match part:
        case "the specification":
            scene, _ = with_values(scene, {"simulation.tolerance": "1e-7"})
        case "the samples":
            samples = grid({"EI": [8, 12, 20], "speed": [100, 150, 171]})
        case "the outputs":
            outputs = OUTPUTS[1:]
    with pytest.raises(StaleStore, match=f"{part} changed"):
        sweep(scene, samples, outputs, executor=threads, store=store, resume=True)
    assert store.read_bytes() == before
    store.write_text("something else\n")
    with pytest.raises(StaleStore, match="no store of a sweep"):
        sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)


def test_a_sample_that_cannot_be_run_has_no_values_but_a_reason(threads: Executor) -> None:
    """A crank that is too long cannot turn to an angle of 90 degrees."""
    samples = listed({"radius": [0.15, 0.31, 0.1]})
    scene, _ = with_values(slider(), {"drives.motor.offset": "1.5"})
    result = sweep(scene, samples, OUTPUTS, executor=threads)
    assert list(result.failures) == [1] and "no positions" in result.failures[1]
    assert repr(result).startswith("Sweep of slider: 3 samples of radius, 1 of them failed; outputs peak_deflection, ")
    assert np.isnan(result.values[1]).all() and np.isfinite(result.values[[0, 2]]).all()
    with pytest.raises(SweepFailed, match=r"none of the 1 samples can be run; that of radius = 0.31: no positions"):
        sweep(scene, listed({"radius": 0.31}), OUTPUTS, executor=threads)


def test_values_that_change_the_equations_make_a_model_each(threads: Executor) -> None:
    samples = grid({"drives.motor.offset": [0, 0.25], "EI": [8, 12]})
    result = sweep(slider(), samples, OUTPUTS[:2], executor=threads)
    assert result.models == 2 and result["rms_slider_s"].shape == (2, 2)
    for number in (3,):
        values = {name: repr(value) for name, value in result.sample(number).items()}
        assert result.values[number, 0] == simulated(values)[0]


def test_initial_values_need_no_further_model(threads: Executor) -> None:
    beam = derive.planar_beam("beam_of_its_own")
    samples = grid({"beam.start.spin": [1, 2.5], "EI": [8, 12]})
    outputs = ["final:beam_phi", "peak:beam_alpha1"]
    result = sweep(beam, samples, outputs, duration=0.5, interval=0.1, tolerance=1e-8, executor=threads)
    assert (result.models, result.initial_states) == (1, 2)
    for number in (1, 2):
        values = {name: repr(value) for name, value in result.sample(number).items()}
        run = moved(with_values(beam, values)[0], duration=0.5, output=0.1, tolerance=1e-8)
        assert result.values[number].tolist() == [run["beam_phi"][-1], np.abs(run["beam_alpha1"]).max()]


def test_an_output_is_a_column_of_all_models() -> None:
    one, other = (ModelCode("m", b"", b"", columns, ()) for columns in (("t", "rod_phi"), ("t", "rod_1_phi")))
    wanted = SweepOutput(Statistic.PEAK, "rod_phi", "rad")
    check_outputs([wanted], [one])
    with pytest.raises(SamplesError, match="rod_phi is no column of all models"):
        check_outputs([wanted], [one, other])
    with pytest.raises(SamplesError, match="peak_rod_phi is given twice"):
        check_outputs([wanted, wanted], [one])
    with pytest.raises(SamplesError, match="peak_rod_phi is given twice"):
        check_outputs([wanted, replace(wanted, deflection=slider().plots[0].quantity)], [one])


def test_without_a_name_an_output_is_of_the_first_plot_even_if_a_column_has_its_name() -> None:
    plot, units = slider().plots[0], {"t": "s", "deflection": "N"}
    assert plot.name == "deflection"
    assert output("peak", slider(), units).deflection == plot.quantity
    assert output("peak:deflection", slider(), units) == SweepOutput(Statistic.PEAK, "deflection", "N")
    with pytest.raises(UnknownNameError, match=r"known: t, deflection$"):
        output("peak:q", slider(), units)


def test_what_the_monitors_warn_of_in_the_sample_with_the_largest_output(threads: Executor) -> None:
    result = sweep(slider(), grid({"EI": [40, 12, 20], "speed": [150]}), ["peak"], executor=threads)
    run = moved(slider())
    assert result.warnings == {1: run.warnings} and "axial force" in run.warnings[0]


def test_a_sample_that_cannot_be_monitored_is_reported(threads: Executor, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object) -> None:
        raise np.linalg.LinAlgError("singular")

    monkeypatch.setattr("derive.study.sweep.worker.validity", failing)
    result = sweep(slider(), grid({"EI": [40, 12], "speed": [150]}), ["peak"], executor=threads)
    assert result.warnings == {1: ("its beams could not be monitored: singular",)} and not result.failures


def test_random_samples(threads: Executor) -> None:
    axes = {"EI": uniform(8, 20), "speed": 150.0}
    result, more = (
        sweep(slider(), random_samples(axes, count, seed=3), ["peak"], executor=threads) for count in (4, 6)
    )
    assert more.values[:4].tobytes() == result.values.tobytes() and result.initial_states == 1


@pytest.mark.parametrize(
    ("samples", "outputs", "error", "message"),
    [
        ({"EJ": [1, 2]}, ["peak"], SpecError, '"EJ" is no parameter and no key'),
        ({"EI": [12, -1, 3]}, ["peak"], SpecError, "bending_stiffness.default: a positive number is needed, not -1"),
        ({"EI": [1], "bodies.rod.bending_stiffness": [1]}, ["peak"], SamplesError, "are one parameter, EI"),
        ({"EI": [1]}, ["peek"], UnknownNameError, 'did you mean "peak"'),
        ({"EI": [1]}, ["peak:slider"], UnknownNameError, 'did you mean "slider_s"'),
        ({"bodies.rod.mass": [float("nan")]}, ["peak"], SamplesError, "not finite"),
    ],
)
def test_what_is_wrong_is_found_before_the_first_run(
    samples: dict[str, list[float]], outputs: list[str], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        make_plan(slider(), grid(samples), outputs, RunOptions())


def test_an_output_needs_a_name_where_there_is_no_plot() -> None:
    with pytest.raises(OutputError, match="has no plot; name a column, such as peak:"):
        make_plan(replace(slider(), plots=()), grid({"EI": [12]}), ["peak"], RunOptions())


def test_bodies_in_space_are_refused() -> None:
    body = derive.read(ROOT / "scenes/body_symbolic.toml")
    with pytest.raises(SpecError, match="a sweep runs scenes and single beams"):
        make_plan(body, grid({"m": [1]}), ["peak"], RunOptions())


def test_a_beam_in_space_is_swept_with_its_pieces(threads: Executor) -> None:
    """A rod of two pieces that swings about a hinge, as `simulate` has it."""
    rod = {"length": 1, "mass": 1, "bending_stiffness": 2, "rotary_inertia": 1e-3, "ansatz": ["1", "xi", "xi^2"]}
    body = {"rod": rod | {"pieces": 2, "markers": {"left": -1, "tip": 1}}}
    hinge = {"hinge": {"kind": "revolute", "between": ["ground.o", "rod.left"]}}
    tip = {"tip": {"kind": "position", "marker": "rod.tip"}}
    places = {"gravity": (0, -10, 0), "ground": {"o": (0, 0, 0)}}
    scene = derive.spatial_scene("swing", bodies=body, joints=hinge, outputs=tip, **places)
    samples = grid({"bodies.rod.bending_stiffness": [1, 3]})
    heights = sweep(scene, samples, "final:tip_2", duration=0.1, interval=0.1, executor=threads)["final:tip_2"]
    run = replace(scene, simulation=derive.Simulation(duration=0.1, output=0.1))
    own = moved(with_values(run, {"bodies.rod.bending_stiffness": "3"})[0])["tip_2"][-1]
    assert heights[1] == pytest.approx(own, rel=1e-6)
    assert abs(heights[0] - heights[1]) > 1e-3
