"""The audit of the paper: each equation as the text shows it, as derived here, and the test that compares them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.report.paper.assumptions import ASSUMPTIONS
from derive.report.paper.model import AuditSection
from derive.report.paper.rows_appendix import SECTIONS as APPENDIX
from derive.report.paper.rows_beam import SECTIONS as BEAM
from derive.report.paper.rows_body import SECTIONS as BODY
from derive.report.paper.rows_frames import SECTIONS as FRAMES
from derive.report.paper.rows_results import SECTIONS as RESULTS
from derive.report.paper.statements import STATEMENTS

if TYPE_CHECKING:
    from derive.report.document.page import Page

SECTIONS: tuple[AuditSection, ...] = (*BODY, *FRAMES, *BEAM, *RESULTS, *APPENDIX)

__all__ = ["ASSUMPTIONS", "SECTIONS", "STATEMENTS", "audit_page"]


def audit_page() -> Page:
    """The audit of the paper as a page; what is derived is derived when this is called."""
    from derive.report.paper.page import build

    return build(SECTIONS, STATEMENTS, ASSUMPTIONS)
