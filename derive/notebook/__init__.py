"""The HTML of objects in notebooks, `_repr_html_`: tables, drawings, formulas, charts and players."""
