"""Lowering: equations of motion to kernels, in straight-line code or in loops over the modes."""
