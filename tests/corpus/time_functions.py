"""Random functions of time: bounded, and smooth where a drive follows them."""

from __future__ import annotations

from typing import Any

from corpus.draft import Draft
from corpus.draws import rounded
from derive.spec.parsing.time_expression import FUNCTIONS, WHOLE

SMOOTH = {
    "sin": "sin({w}*t)",
    "cos": "1 - cos({w}*t)",
    "sqrt": "sqrt(1 + ({w}*t)^2) - 1",
    "exp": "1 - exp(-{w}*t)",
    "log": "log(1 + {w}*t)",
    "tanh": "tanh({w}*t)",
    "atan2": "atan2({w}*t, 2)",
    "step": "step({w}*t, {a}, {b})",
    "piecewise": "piecewise(t < {c}, t^3/{c}^2, t < 2*{c}, 3*t - 2*{c}, 3*t - 2*{c})*{w}/3",
}
"""Functions that vanish at t = 0, with values and rates of the order of 1 and w; a speed never jumps."""

ROUGH = {
    "abs": "abs(sin({w}*t))",
    "min": "min({w}*t, 1, {b})",
    "max": "max(sin({w}*t), 0)",
    "piecewise": "piecewise(t < {c}, 1, t < 2*{c}, cos({w}*t), 0.5)",
}
"""Functions that only loads may have: with kinks, jumps, or values at t = 0."""

PLAIN = ("{w}*t", "({w}*t)^2/2", "{w}*t - sin({w}*t)", "sin({w}*t)^3", "t^2*{w}^2*pi/6")


def unknown_functions() -> list[str]:
    """The functions of t in the language of expressions for which the corpus has no example."""
    return [name for name in FUNCTIONS if name not in SMOOTH and name not in ROUGH and name not in WHOLE]


WITHOUT_INTEGRAL = ("sqrt", "atan2")
"""The functions of SMOOTH that cannot be the speed of a drive, whose integral has to have a closed form."""


def speed_function(draft: Draft, size: float) -> str:
    """A function of t with values of about `size` whose integral has a closed form; it may be a product of two."""
    draws = draft.draws
    templates = {text: name for name, text in SMOOTH.items() if name not in WITHOUT_INTEGRAL}
    template = draws.choice([*PLAIN, *templates])
    text = f"{_table(draft, True)}(t)" if draws.chance(0.2) else _filled(draft, template)
    if templates.get(template) != "tanh" and draws.chance(0.3):  # whose products have none
        text = f"({text})*step(t, 0, {rounded(draws.between(0.2, 2) / draft.rate, 2):g})"
    return f"{_constant(draft, rounded(size, 2), '1')}*({text})"


def function(draft: Draft, size: float, smooth: bool = False, vanishes: bool = False) -> str:
    """A function of t with values of about `size`.

    smooth: its rate does not jump; vanishes: it is 0 at t = 0.
    """
    draws = draft.draws
    factor = _constant(draft, rounded(size, 2), "1")
    if draws.chance(0.2):
        text = f"{factor}*{_table(draft, vanishes)}(t)"
    else:
        template = draws.choice([*SMOOTH.values(), *PLAIN, *([] if smooth else ROUGH.values())])
        text = f"{factor}*({_filled(draft, template)})"
    if not vanishes and draws.chance(0.3):
        text = f"{rounded(size * draws.between(-1, 1), 2):g} + {text}"
    return text


def _filled(draft: Draft, template: str) -> str:
    """A function with constants: a rate w, a time c, and the ends a and b of a step."""
    draws = draft.draws
    values: dict[str, str] = {}
    if "{w}" in template:
        values["w"] = _constant(draft, rounded(draft.rate * draws.between(0.2, 1), 2), "rad/s")
    if "{c}" in template:
        values["c"] = _constant(draft, rounded(draws.between(0.2, 2) / draft.rate, 2), "s")
    values["a"], values["b"] = draws.choice([("0", "1"), ("0.1", "0.8"), ("0", "2")])
    return template.format(**values)


def _constant(draft: Draft, value: float, unit: str) -> str:
    """A number, or a parameter that is declared in `[parameters]`."""
    if not draft.draws.chance(0.3):
        return f"{value:g}" if value >= 0 else f"({value:g})"
    parameters = draft.section("parameters")
    for name, table in parameters.items():
        if table["default"] == value:
            return str(name)
    name = draft.name("parameters")
    parameters[name] = {"default": value} | ({"unit": unit} if draft.draws.chance(0.5) else {})
    return name


def _table(draft: Draft, vanishes: bool = False) -> str:
    """A table of values between -1 and 1, in a CSV file beside the scene."""
    draws = draft.draws
    name = draft.name("tables")
    rows, period = draws.choice([2, 3, 5, 9]), 3 / draft.rate
    lines = ["t_s,value"]
    for i in range(rows):
        value = 0.0 if i == 0 and vanishes else rounded(draws.between(-1, 1), 3)
        lines.append(f"{rounded(period * i / (rows - 1), 6):g},{value:g}")
    draft.files[f"{name}.csv"] = "\n".join(lines) + "\n"
    draft.section("tables")[name] = {"file": f"{name}.csv", "x": "t_s", "y": "value"}
    return name


def value(draft: Draft, size: float, inputs: bool = True) -> Any:
    """A random value of a force or a torque: a number, a function of t, or a run-time input."""
    draws = draft.draws
    if draws.chance(0.3):
        return rounded(size * draws.between(-1, 1), 2) or 0.5 * size
    if inputs and draws.chance(0.2):
        return run_time_input(draft, size)
    return function(draft, size * draws.sign())


def run_time_input(draft: Draft, size: float, smooth: bool = False, offset: float | None = None) -> dict[str, str]:
    """A new run-time input, as it is written where it is used.

    offset: the value at t = 0; by default any.
    """
    draws = draft.draws
    name = draft.name("inputs")
    table: dict[str, Any] = {}
    if offset is not None:
        table["value"] = f"{offset:.12g} + {function(draft, size, smooth=True, vanishes=True)}"
    elif draws.chance(0.8):
        table["value"] = rounded(size, 2) if draws.chance(0.3) else function(draft, size, smooth)
    if draws.chance(0.3):
        table["unit"] = "N"
    draft.section("inputs")[name] = table
    return {"input": name}
