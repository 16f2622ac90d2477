"""Checks of a whole specification, and the sentences in which faults are reported."""
