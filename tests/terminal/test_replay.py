"""The live view of a replay in a real terminal: it goes on and back, and to the next failure."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

from btlang.cli import main

from .emulator import BTC
from .test_live import Open

MISSION = "wait 60 s then try to grasp the book then wait 60 s then wave"


def is_at(seconds: str, screen: str) -> bool:
    """Whether the view shows the run at that time."""
    return re.search(rf" {seconds}\.\d s ", screen) is not None


def test_arrows_and_the_next_failure(terminal: Open, tmp_path: Path) -> None:
    recording = str(tmp_path / "run.mcap")
    assert main(["run", "-c", MISSION, "--speed", "max", "--quiet", "--record", recording]) == 0
    seen = terminal(*BTC, "replay", recording)
    seen.wait_for("left/right 10 s")
    seen.wait_for("living room")
    seen.press("Right")
    seen.wait_until(partial(is_at, r"1\d"))
    seen.press("f")
    screen = seen.wait_until(partial(is_at, "(?:59|60)"))
    assert "paused" in screen
    assert "✗ grasp book" in screen
    seen.press("Left")
    screen = seen.wait_until(partial(is_at, "(?:49|50)"))
    assert "✗" not in screen
    seen.press("q")
    seen.wait_for_end()
