"""Marks by which a test says which equation of the paper it compares; test_audit holds them against the audit."""

from __future__ import annotations

import pytest


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "equation(*numbers): compares these equations of the paper with a derivation")
    config.addinivalue_line("markers", "statement(key): proves, or refutes, what the paper says in words")
