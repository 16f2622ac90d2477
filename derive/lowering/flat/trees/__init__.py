"""Recursions along trees of rigid bodies in straight-line code, in frames that turn with the bodies."""
