"""A first user in a browser, with a robot: writes a mission, mends it, changes its tree, tries, keeps, runs and stops it."""

from __future__ import annotations

import json
import os
from pathlib import Path

from tests.server.doors import PASSWORD
from tests.web.packages import installed, node


def test_a_first_user(robot: str) -> None:
    here = Path(__file__).parent
    pictures = os.environ.get("BTLANG_PICTURES")  # a folder
    words = [robot, "ed", PASSWORD, *([pictures] if pictures else [])]
    said = node(here / "scenario.mjs", *words, folder=installed(here))
    problems = json.loads(said.splitlines()[-1])
    assert not problems, "\n".join(problems)
