"""The audit of the paper: each equation as the text shows it, as derived here, and the test that compares them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.report.paper_audit.assumptions import ASSUMPTIONS
from derive.report.paper_audit.model import AuditSection
from derive.report.paper_audit.rows_appendix import SECTIONS as APPENDIX
from derive.report.paper_audit.rows_beam import SECTIONS as BEAM
from derive.report.paper_audit.rows_body import SECTIONS as BODY
from derive.report.paper_audit.rows_frames import SECTIONS as FRAMES
from derive.report.paper_audit.rows_results import SECTIONS as RESULTS
from derive.report.paper_audit.statements import STATEMENTS

if TYPE_CHECKING:
    from derive.report.document.page import Page

SECTIONS: tuple[AuditSection, ...] = (*BODY, *FRAMES, *BEAM, *RESULTS, *APPENDIX)

__all__ = ["ASSUMPTIONS", "SECTIONS", "STATEMENTS", "audit_page"]


def audit_page() -> Page:
    """The audit of the paper as a page; what is derived is derived when this is called."""
    from derive.report.paper_audit.page import build

    return build(SECTIONS, STATEMENTS, ASSUMPTIONS)
