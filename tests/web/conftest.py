"""The built page, and a robot with its server for a browser."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from hatch_build import build_page
from tests.web.packages import ROOT, WEB
from tests.web.served import served


@pytest.fixture(scope="session")
def page() -> Path:
    """The folder `dist`, of the sources as they are."""
    with open(Path(tempfile.gettempdir(), f"btlang-page-{os.getuid()}.lock"), "w", encoding="ascii") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        problem = build_page(WEB)
    if problem and not os.environ.get("CI"):
        pytest.skip(f"the page can't be built: {problem}")
    assert not problem
    return WEB / "dist"


@pytest.fixture(scope="module")
def robot(page: Path) -> Iterator[str]:
    """The address of a robot in the museum."""
    with served("--speed", "4", "--world", str(ROOT / "examples" / "worlds" / "museum.toml")) as address:
        yield address
