"""Parsers for the expressions of a specification: polynomials in xi, and functions of time."""
