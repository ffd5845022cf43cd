"""The world of a module of tests, as a file."""

from pathlib import Path

import pytest


@pytest.fixture
def world(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The file with what the module calls WORLD."""
    path = tmp_path / "world.toml"
    path.write_text(request.module.WORLD, encoding="utf-8")
    return str(path)
