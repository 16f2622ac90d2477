"""The version of the tool; the only place that states it."""

VERSION = "0.1.0"
