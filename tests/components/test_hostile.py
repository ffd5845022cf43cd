"""Components that raise where nobody expects it, lie, flood, or go on after they were given up."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.components.manager import Manager
from btlang.robots.body import ComponentPart
from btlang.robots.platforms import ALL
from btlang.robots.registry import connector
from btlang.robots.robot import RobotError
from tests.components.robots import robot_file
from tests.components.test_faults import wait_until

WORD = """
[[action]]
phrase = "misbehave"
id = "Misbehave"
call = "hostile:{call}"
needs = ["base"]
help = "Does what it must not."
example = "misbehave"
"""


def hostile(folder: Path, name: str, **keys: object) -> str:
    """A robot with one of the hostile components."""
    lines = "\n".join(f"{key} = {value}" for key, value in keys.items())
    return robot_file(folder, f'[[component]]\nname = "villain"\nclass = "hostile:{name}"\n{lines}')


def misbehave(folder: Path, call: str, text: str = "misbehave") -> btlang.Mission:
    (folder / "hostile.toml").write_text(WORD.format(call=call), encoding="utf-8")
    return btlang.parse_tree(text, keywords=[str(folder / "hostile.toml")])


def statuses(session: btlang.Session) -> Any:
    return session.connection.manager.statuses()  # type: ignore[attr-defined]


@pytest.mark.parametrize("runs", ["process", "here"])
def test_a_constructor_that_raises_is_a_failure_like_others(tmp_path: Path, runs: str) -> None:
    robot = hostile(tmp_path, "BrokenConstructor", runs=f'"{runs}"', restarts=1)
    with btlang.Session(robot) as session:
        wait_until(lambda: "given up" in (statuses(session) or [None])[0].why, 10)
        assert "no water" in statuses(session)[0].why
        assert statuses(session)[0].starts == 2


class _LyingHost:
    """Says of itself what nobody can use."""

    state, process = "unconfigured", None

    def load(self) -> Any:
        return 5

    def close(self) -> None:
        pass


def test_a_host_that_says_nonsense_of_itself_is_given_up() -> None:
    manager = Manager([ComponentPart("villain", "hostile:Liar", restarts=0)], lambda part, changed: _LyingHost())  # type: ignore[arg-type,return-value]
    manager.start()
    assert not manager.wait(5.0)
    assert [each.why for each in manager.statuses()] == [
        "TypeError: 'int' object is not subscriptable; it was given up after the first attempt"
    ]
    manager.close()


@pytest.mark.parametrize("over", ["simulated", "devices"])
def test_what_is_not_a_number_moves_nothing(over: str) -> None:
    with btlang.Session(connector("standard", over, **({"simulate": [ALL]} if over == "devices" else {}))) as session:
        robot = session.robot
        for velocity in ((math.nan, 0.0), (0.0, math.nan)):
            with pytest.raises(RobotError, match="can't drive at a speed that is not a number"):
                robot.drive(*velocity)
        name = robot.body.joints[0].name
        with pytest.raises(RobotError, match=f'the joint "{name}" can\'t move to what is not a number'):
            robot.move_joints({name: math.nan})
        before = robot.joint(name)
        for _ in range(40):
            robot.step(0.05)
        assert robot.velocity == (0.0, 0.0)
        assert robot.joint(name) == before


@pytest.mark.parametrize(("name", "reason"), [("FailingStep", "the pump is broken"), ("ExitingStep", "SystemExit: 3")])
def test_one_in_this_process_whose_step_fails_ends_its_actions_and_what_they_drive(
    tmp_path: Path, name: str, reason: str
) -> None:
    robot = hostile(tmp_path, name, runs='"here"', restarts=0)
    with btlang.Session(robot) as session:
        outcome = session.run(misbehave(tmp_path, f"{name}.roll"), speed="max", time_limit=20).outcome
        assert outcome is not None
        assert reason in outcome.why()
        session.robot.step(2.0)
        assert session.robot.velocity == (0.0, 0.0)


@pytest.mark.parametrize("runs", ["process", "here"])
def test_a_method_that_raises_drives_no_longer(tmp_path: Path, runs: str) -> None:
    robot = hostile(tmp_path, "Liar", runs=f'"{runs}"')
    mission = misbehave(tmp_path, "Liar.roll_and_raise", "try misbehave otherwise wait 2 seconds")
    with btlang.Session(robot) as session:
        outcome = session.run(mission, speed="max").outcome
        assert outcome is not None
        assert outcome.succeeded
        assert session.robot.travelled < 0.2


def test_a_hook_that_was_given_up_moves_nothing_any_more(tmp_path: Path) -> None:
    wheels = '[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "simulated"'
    robot = hostile(tmp_path, "EndlessHook", runs='"here"', limit=0.3, restarts=0, needs='["wheels"]')
    with open(robot, "a", encoding="utf-8") as file:
        file.write(f"\n{wheels}\n")
    with btlang.Session(robot) as session:
        wait_until(lambda: "given up" in statuses(session)[0].why, 10)
        session.robot.step(1.0)
        for _ in range(20):
            session.robot.step(0.05)
            time.sleep(0.01)
        assert session.robot.velocity == (0.0, 0.0)
