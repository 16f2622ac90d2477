"""Where `to_mean_frame` was; it lives in `derive.reduction.mean_frame` now."""

from derive.reduction.mean_frame import residuals, rigid_fields, to_mean_frame

__all__ = ["residuals", "rigid_fields", "to_mean_frame"]
