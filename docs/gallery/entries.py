"""The examples of the gallery by groups: which there are, and what their sources cannot say.

Titles, texts and numbers are those of the sources; whether an example draws or moves is seen when it runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Entry:
    """An example: a script, a scene or a C program.

    path: the source, below the repository. commands: those of `tisserand` for a scene, without its path. shown: other
    files whose text belongs to the example. needs: a package beside those of Tisserand, without which the source is
    shown, and not run. card: what the index shows, "picture", "drawing", "number" or "output"; None is the first of
    these that there is.
    """

    path: str
    commands: tuple[tuple[str, ...], ...] = (("simulate",),)
    shown: tuple[str, ...] = ()
    needs: str | None = None
    card: str | None = None

    @property
    def name(self) -> str:
        """The name of its page."""
        return Path(self.path).stem

    @property
    def kind(self) -> str:
        """The kind of its source: "py", "toml" or "c"."""
        return Path(self.path).suffix.removeprefix(".")

    def words(self, command: tuple[str, ...]) -> tuple[str, ...]:
        """The arguments of `tisserand`: a command with the path of the scene behind its name, two words of a study."""
        name = 2 if command[0] == "study" else 1
        return (*command[:name], self.path, *command[name:])

    def compilation(self) -> tuple[tuple[str, ...], ...]:
        """The commands that compile a C program, with the model of its name and templates/host, and that run it."""
        model = f"generated/{self.name}"
        include = (f"-I{model}", "-Itemplates/host", f"-DTISSERAND_HEADER='\"{self.name}.h\"'")
        sources = (self.path, "templates/host/fixed_step.c", f"{model}/{self.name}.c")
        return ("cc", "-std=c99", "-O2", *include, *sources, "-lm", "-o", self.name), (f"./{self.name}",)

    def commands_in_sh(self, draws: bool) -> tuple[tuple[str, ...], ...]:
        """The commands that run the example from a checkout; a script that draws takes a folder."""
        match self.kind:
            case "toml":
                return tuple((".venv/bin/tisserand", *self.words(command)) for command in self.commands)
            case "c":
                return self.compilation()
            case _:
                return ((".venv/bin/python", self.path, *(["FOLDER"] if draws else [])),)


@dataclass(frozen=True)
class Group:
    """Examples under one heading, with a sentence on what they have in common."""

    title: str
    text: str
    entries: tuple[Entry, ...]


_VALID = ("--set", "bodies.rod.order=2", "--set", "bodies.rod.pieces=2")
"""The model of the rod that its monitors do not doubt; its file has the one of first order, which is quick."""


def _scripts(*names: str) -> tuple[Entry, ...]:
    return tuple(Entry(f"examples/{name}.py") for name in names)


def _moving(*names: str) -> tuple[Entry, ...]:
    """Scripts whose card shows the motion."""
    return tuple(Entry(f"examples/{name}.py", card="drawing") for name in names)


def _stability(name: str, parameter: str, *more: str) -> Entry:
    """A scene whose study of stability runs over the values of a parameter, with few models."""
    few = ("--shapes", "2", "--pieces", "2")
    return Entry(f"examples/{name}.toml", (("study", "stability", "--parameter", parameter, *few, *more),))


GROUPS = (
    Group(
        "First steps",
        "A body, its equations and its code.",
        (
            Entry("examples/equations_of_motion.py", card="output"),
            *_moving("gravity_pendulum"),
            *_scripts("mean_or_point_frame", "damped_oscillator", "parameter_sweep"),
        ),
    ),
    Group(
        "Bodies",
        "Assumed modes, finite-element bodies, and their natural frequencies.",
        _scripts(
            "free_beam_frequencies",
            "cantilever_modes",
            "static_equilibrium",
            "block_frequencies",
            "symbolic_body",
        ),
    ),
    Group(
        "Mechanisms",
        "Joints, drives, forces and springs in the plane.",
        (
            Entry("scenes/crank_slider_3.toml", (("simulate",), ("report",)), card="drawing"),
            *_moving("four_bar_rigid", "slider_crank_rigid"),
            Entry("examples/andrews_squeezer.py", shown=("examples/andrews_squeezer.toml",), card="drawing"),
            *_moving("double_pendulum_energy"),
            *_scripts("pendulum_reaction", "motor_run_up", "joint_of_my_own", "force_of_my_own"),
            *(Entry(f"examples/{name}.toml", card="drawing") for name in ("chain_100", "chain_1000", "four_bars")),
        ),
    ),
    Group(
        "In space",
        "Rigid bodies, finite-element bodies and beams, whose rotations are quaternions.",
        (
            Entry("examples/spatial_crank_slider.toml", card="drawing"),
            Entry("examples/spatial_crank_slider_beam.toml", (("report",), ("simulate", *_VALID)), card="drawing"),
            Entry("examples/spatial_crank_slider_rigid.toml", card="drawing"),
            Entry("examples/bracket_crank.toml", card="drawing"),
            Entry("examples/rotating_blade.toml", (("modes",),)),
            Entry("examples/spun_up_blade.toml", card="drawing"),
            _stability("whirling_shaft", "spin=0:20:11", "--orders", "truncated"),
            *_scripts("screw_jack", "block_tumbling", "spinning_solid_beam"),
        ),
    ),
    Group(
        "Accuracy and methods",
        "What a model leaves out, what a frame costs, and how integrators fail.",
        (
            *_scripts("crank_slider_beams", "crank_slider_frames", "spin_softening", "spun_up_cantilever"),
            _stability(
                "rotating_cantilever", "speed=0:6:13", "--orders", "first", "--frames", "tangent", "--exact", "none"
            ),
            _stability("pinned_column", "P=0:30:13", "--orders", "first", "--exact", "9.8696044"),
            _stability("beck_column", "P=0:30:13", "--orders", "truncated", "--exact", "20.0509"),
            *_scripts("monomial_conditioning"),
            Entry("examples/dop853_or_ida.py", needs="sksundae"),
            *_scripts("runge_kutta_step_limit", "dense_and_sparse"),
        ),
    ),
    Group(
        "Control and identification",
        "Exact derivatives for optimal control and the estimation of parameters.",
        (
            *_scripts("optimal_slewing", "stiffness_from_motion"),
            Entry("examples/jax_identification.py", needs="jax"),
        ),
    ),
    Group(
        "From C",
        "The generated files need a C compiler and nothing else.",
        (*_scripts("call_c_from_c", "batch_of_states"), Entry("examples/double_pendulum.c")),
    ),
    Group(
        "Other programs",
        "Models in programs that do not know Tisserand.",
        (
            *_scripts("python_without_tisserand", "sid_round_trip"),
            Entry("examples/hosts/coupled_units.py", needs="fmpy"),
        ),
    ),
)
"""All examples, each once."""


PAGES = (
    ("crank_slider_3", "report", "Report: every equation, term and zero, and the line of C that computes it"),
    ("crank_slider_3", "motion", "Player: the crank-slider of the paper in the plane"),
    ("spatial_crank_slider", "motion", "Player: a slider-crank in space with a finite-element rod"),
)
"""Reports and players that the index shows beside the examples: the name of an entry, the file, and a title."""


def entries() -> tuple[Entry, ...]:
    """The examples of all groups in their order."""
    return tuple(entry for group in GROUPS for entry in group.entries)
