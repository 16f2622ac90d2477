"""The style of the pictures that scripts draw with matplotlib: that of all charts of Tisserand."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from derive.visual.chart_style import COLOURS, SETTINGS, in_page_style

__all__ = ["house_style", "in_page_style"]


@contextmanager
def house_style() -> Iterator[None]:
    """Draw figures in this context with the fonts, colours and grid of the charts, 7 inches wide."""
    import matplotlib as mpl
    from cycler import cycler

    own = {"figure.figsize": (7.0, 4.0), "figure.constrained_layout.use": True, "lines.linewidth": 1.6}
    own |= {"text.parse_math": True}  # powers of ten on logarithmic axes
    with mpl.rc_context({**SETTINGS, **own, "axes.prop_cycle": cycler(color=COLOURS)}):
        yield
