"""A page as PDF, by Typst, whose wheel brings its fonts with it."""

from __future__ import annotations

from derive.errors import TisserandError
from derive.report.document.page import Page
from derive.report.writers.typst import typst


class NoTypst(TisserandError):
    """The wheel that makes PDF is not installed."""


def pdf(page: Page) -> bytes:
    """The page as PDF: the same bytes for the same page and version of Typst. Raises NoTypst."""
    try:
        import typst as wheel
    except ImportError as error:
        raise NoTypst("PDF needs the Python package typst: pip install 'tisserand[report]'") from error
    made: bytes = wheel.compile(typst(page).encode(), format="pdf", ignore_system_fonts=True, timestamp=0)
    return made
