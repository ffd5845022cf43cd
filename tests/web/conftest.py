"""The built page, and a robot with its server for a browser."""

from __future__ import annotations

import fcntl
import os
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from btlang.task.execution.missions import MissionReader
from btlang.task.store.records import TaskState
from hatch_build import build_page
from tests.task.layers import layer_in, submit, wait_for
from tests.web.packages import ROOT, WEB
from tests.web.served import served

YESTERDAY = """# Evening round
say "good evening"
go to the fountain
go to the cafe within 3 s
say "good night"
"""


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


def fail_yesterday(folder: Path, world: str) -> None:
    """A robot with this folder did a mission yesterday, which failed and was recorded."""
    recordings, begins = folder / "recordings", time.time() - 86_400
    with layer_in(folder, reader=MissionReader((), world), recordings=str(recordings), begins=begins) as layer:
        wait_for(layer, submit(layer, YESTERDAY), TaskState.FAILED)
    for recording in recordings.iterdir():
        os.utime(recording, (begins, begins))


@pytest.fixture(scope="module")
def robot(page: Path) -> Iterator[str]:
    """The address of a robot in the museum, whose mission of yesterday failed."""
    world = str(ROOT / "examples" / "worlds" / "museum.toml")

    def prepare(data: Path) -> None:
        fail_yesterday(data / "btlang" / "robots" / "robot", world)

    with served("--speed", "4", "--world", world, prepare=prepare) as address:
        yield address
