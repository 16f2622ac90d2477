"""Random values of scenes in space as texts of TOML: numbers, parameters, rotations, functions of time and tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from random import Random

import numpy as np

SEQUENCES = ("xyz", "xzy", "yzx", "yxz", "zxy", "zyx", "xyx", "xzx", "yzy", "yxy", "zxz", "zyz")
ROWS = 5
"""The rows of a table of values."""


class RandomValues:
    """Random values, with the sections of what they refer to, from a seed."""

    def __init__(self, seed: int) -> None:
        self.seed, self.random = seed, Random(f"spatial scene {seed}")
        self.symbols = 0
        """The number of parameters in place of numbers."""
        self.sections: dict[str, str] = {}
        """The sections of parameters, tables and inputs of functions of time, by their headers."""
        self.curves: dict[str, list[tuple[float, float]]] = {}
        """The rows of tables by the names of their files."""

    def number(self, size: float = 1.0) -> float:
        """A number with two or three digits between -size and size."""
        return float(f"{self.random.uniform(-size, size):.3g}")

    def positive(self, low: float = 0.2, high: float = 2.0) -> float:
        return float(f"{self.random.uniform(low, high):.3g}")

    def signed(self) -> str:
        """A number behind another one in a sum."""
        value = self.number(2)
        return f"{'-' if value < 0 else '+'} {abs(value)}"

    def vector(self, size: float = 1.0) -> list[float]:
        return [self.number(size) for _ in range(3)]

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def quantity(self, value: float, probability: float = 0.15) -> str:
        """A number, or a parameter with this default."""
        if not self.chance(probability):
            return str(value)
        self.symbols += 1
        return f'{{ symbol = "p{self.symbols}", default = {value} }}'

    def quantities(self, values: list[float], probability: float = 0.05) -> str:
        """Numbers, of which some are parameters."""
        return f"[{', '.join(self.quantity(value, probability) for value in values)}]"

    def rotation(self) -> str:
        """A rotation in one of its forms."""
        form = self.random.choice(["quaternion", "axis", "axes", "angles"])
        if form == "quaternion":
            e = np.array([self.random.gauss(0, 1) for _ in range(4)])
            return str((e / np.linalg.norm(e)).tolist())
        if form == "axis":
            return f"{{ axis = {self.vector()}, angle = {self.number(3)} }}"
        if form == "axes":  # of small integers, so that they are orthogonal exactly
            first, second = self.random.choice(
                [([1, 2, 2], [2, 1, -2]), ([3, 4, 0], [-4, 3, 0]), ([0, 1, 0], [0, 0, -2])]
            )
            names = self.random.sample("xyz", 2)
            return f"{{ {names[0]} = {first}, {names[1]} = {second} }}"
        angles = [self.number(3) for _ in range(3)]
        return f'{{ angles = {angles}, sequence = "{self.random.choice(SEQUENCES)}" }}'

    # ---- functions of time

    def linear(self) -> str:
        """An argument that is linear in t."""
        return f"{self.positive()}*t {self.signed()}"

    def ends(self) -> tuple[float, float]:
        """Two times, the first one before the second."""
        first = self.positive(0.1, 0.9)
        return first, first + self.positive(0.2, 1)

    def curve(self) -> str:
        """The name of a table of values."""
        name = f"curve{len(self.curves) + 1}"
        x = np.cumsum([self.number(0.5), *(self.positive(0.3, 1) for _ in range(ROWS - 1))])
        self.curves[f"{name}.csv"] = [(round(float(at), 3), self.number(2)) for at in x]
        self.sections[f"tables.{name}"] = f'file = "{name}.csv"\nx = "at"\ny = "value"'
        return name

    def parameter(self) -> str:
        """The name of a parameter of functions."""
        self.sections["parameters.strength"] = "default = 1.3"
        return "strength"

    def term(self, forms: tuple[str, ...]) -> str:
        """A number times one of some forms of functions."""
        return f"{self.signed()}*{FORMS[self.random.choice(forms)](self)}"

    def function(self) -> str:
        """A number, a function of time, or an input, which is a number or a function itself."""
        if self.chance(0.3):
            return str(self.number(3))
        if self.chance(0.15):
            return self.input()
        return f'"{self.number(3)} {self.term(EVERY)} {self.term(EVERY) if self.chance(0.3) else ""}"'

    def motion(self) -> str:
        """A function whose first two derivatives exist, or an input."""
        if self.chance(0.15):
            return self.input()
        return f'"{self.number()} + {self.positive()}*t {self.term(SMOOTH)}"'

    def speed(self) -> str:
        """A number, a parameter, or a function whose integral has a closed form."""
        if self.chance(0.4):
            return self.quantity(self.number(3), 0.5)
        return f'"{self.positive()} {self.term(INTEGRABLE)}"'

    def input(self) -> str:
        """A reference to an input that follows a function."""
        name = f"u{sum(header.startswith('inputs') for header in self.sections) + 1}"
        self.sections[f"inputs.{name}"] = f'value = "{self.number()} {self.term(SMOOTH)}"'
        return f'{{ input = "{name}" }}'


def _piecewise(values: RandomValues) -> str:
    first, second = values.ends()
    return f"piecewise(t < {first}, t^2, t < {second}, {values.number()}*t, {values.number()})"


def _step(values: RandomValues) -> str:
    first, second = values.ends()
    return f"step({values.linear() if values.chance(0.5) else 't'}, {first}, {second})"


FORMS: Mapping[str, Callable[[RandomValues], str]] = {
    "sin": lambda of: f"sin({of.linear()})",
    "cos": lambda of: f"cos({of.linear()})",
    "sqrt": lambda of: f"sqrt(1 + ({of.linear()})^2)",
    "exp": lambda of: f"exp(-{of.positive()}*t)",
    "log": lambda of: f"log(2 + {of.positive()}*t)",
    "tanh": lambda of: f"tanh({of.linear()})",
    "abs": lambda of: f"abs({of.linear()})",
    "min": lambda of: f"min({of.linear()}, {of.number()}, t)",
    "max": lambda of: f"max({of.linear()}, {of.positive()}*t)",
    "atan2": lambda of: f"atan2({of.linear()}, 1 + t)",
    "step": _step,
    "piecewise": _piecewise,
    "table": lambda of: f"{of.curve()}({of.positive()}*t)",
    "parameter": lambda of: f"{of.parameter()}*t",
    "pi": lambda of: "sin(pi*t)",
    "power": lambda of: f"t^{of.random.randint(2, 4)}",
    "quotient": lambda of: f"(1 + t)/(2 + {of.positive()}*t)",
}
"""Texts of functions of time; at a random time all of them have their derivatives."""
EVERY = (*FORMS,)
SMOOTH = tuple(name for name in FORMS if name not in ("abs", "min", "max", "piecewise"))
INTEGRABLE = tuple(name for name in FORMS if name not in ("sqrt", "atan2", "quotient"))


def rows_text(rows: list[tuple[float, float]]) -> str:
    """The CSV file of a table of values."""
    assert all(a[0] < b[0] for a, b in pairwise(rows))
    return "at,value\n" + "".join(f"{x},{y}\n" for x, y in rows)
