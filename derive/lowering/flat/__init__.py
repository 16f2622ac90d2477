"""Lowering to straight-line code: every sum over the shapes is unrolled."""
