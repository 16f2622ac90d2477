"""The report: every equation of a model shown, with its reasons and its code."""
