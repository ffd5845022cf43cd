"""Shared by all tests: hypothesis settings, and golden files that `UPDATE_GOLDEN=1` writes anew."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "ci", deadline=None, derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow]
)
for variable in ("FORCE_COLOR", "CLICOLOR_FORCE"):  # what is compared is plain text
    os.environ.pop(variable, None)


def matches_golden(actual: str, path: Path) -> None:
    """Fails where a text is not the one in a file."""
    if os.environ.get("UPDATE_GOLDEN"):
        path.write_text(actual, encoding="utf-8")
    if not path.exists():
        pytest.fail(f"{path.name} is missing; UPDATE_GOLDEN=1 writes it (then read it)")
    assert actual == path.read_text(encoding="utf-8"), f"{path.name} differs"
