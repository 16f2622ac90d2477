"""Conversion of expressions of the derivation to formulas in the notation of the paper."""
