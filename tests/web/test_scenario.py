"""People at the page, in a browser: what a scenario prints is what went wrong, one fault a line.

With a folder in the environment variable BTLANG_SCREENSHOTS there is a picture of each step in it.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.profiles import amount
from tests.server.doors import PASSWORD
from tests.web.packages import installed, node

HERE = Path(__file__).parent


def test_a_first_user_writes_runs_and_stops_a_mission(robot: str) -> None:
    assert node(HERE / "first_user.mjs", robot, PASSWORD, folder=installed(HERE)).strip() == ""


@pytest.mark.long
@pytest.mark.skipif(not amount(0, 1), reason="takes seconds: with -m long")
@pytest.mark.parametrize("scenario", ["two_editors.mjs", "cut.mjs"])
def test_nothing_is_lost(robot: str, scenario: str) -> None:
    assert node(HERE / scenario, robot, PASSWORD, folder=installed(HERE)).strip() == ""
