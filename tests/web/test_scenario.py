"""The page in a browser, with a robot and its server as people start them."""

from __future__ import annotations

from pathlib import Path

from tests.server.doors import PASSWORD
from tests.web.packages import installed, node

HERE = Path(__file__).parent


def test_log_in_watch_stop_release(robot: str) -> None:
    node(HERE / "scenario.mjs", robot, PASSWORD, folder=installed(HERE))
