"""Its missions on the robot of robot.toml. patrol.test.txt tests in English what they do."""

import tomllib
from pathlib import Path

import btlang
import pytest

FOLDER = Path(__file__).parent
RULES = tomllib.loads((FOLDER / "robot.toml").read_text(encoding="utf-8")).get("rules")  # which never end
MISSIONS = sorted(path for path in FOLDER.glob("*.txt") if not path.name.endswith((".test.txt", RULES or ".test.txt")))


@pytest.mark.parametrize("path", MISSIONS, ids=lambda path: path.name)
def test_missions_succeed(path):
    with btlang.Session(FOLDER / "robot.toml") as session:  # knows the words of the robot's components and gestures
        outcome = session.run(path, speed="max", seed=0, time_limit=600).outcome
    assert outcome.succeeded, outcome.why()
