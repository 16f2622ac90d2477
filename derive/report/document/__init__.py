"""A report as data: pages, formulas, tables and anchors."""
