"""What a robot file says a robot does all day: its rules, its missions and its schedules."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.bodies.body_file import read_body
from btlang.robots.registry import connector
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import LABEL, TaskLayer, make_robot_layer, read_schedules
from btlang.vocabulary.shipped import STANDARD_BODY

from .layers import layer_in, submit, wait_until

WEEK = """
[[schedule]]
mission = "tour"
every = "every day at 9:00"
within = 600
priority = 3

[[schedule]]
mission = "closing"
every = "on weekdays at 18:00"
overlap = "replace"
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """A robot file with everything beside it."""
    (tmp_path / "missions").mkdir()
    (tmp_path / "missions" / "tour.txt").write_text("go to the lab then wave", encoding="utf-8")
    (tmp_path / "missions" / "closing.txt").write_text('say "We close."', encoding="utf-8")
    (tmp_path / "week.toml").write_text(WEEK, encoding="utf-8")
    (tmp_path / "rules.txt").write_text("whenever the battery is below 20%, dock then charge", encoding="utf-8")
    path = tmp_path / "robot.toml"
    keys = 'rules = "rules.txt"\nmissions = "missions"\nschedules = "week.toml"\n'
    path.write_text(keys + Path(STANDARD_BODY).read_text(encoding="utf-8"), encoding="utf-8")
    return path


def up(robot: Path) -> TaskLayer:
    return make_robot_layer(connector(str(robot)), MissionReader(), folder=str(robot.parent / "store"), speed="max")


def test_missions_schedules_and_rules_come_from_the_robot_file(robot: Path) -> None:
    with closing(up(robot)) as layer:
        assert {each.name for each in layer.store.texts()} == {"tour", "closing"}
        tour, closing_time = layer.store.schedules()
        assert (tour.rule, tour.mission.text) == ("every day at 09:00", "go to the lab then wave")
        assert (tour.within, tour.priority, tour.labels) == (600.0, 3, (LABEL,))
        assert closing_time.overlap == "replace"
        assert layer.rules.reactions


def test_after_another_start_only_what_has_changed_is_new(robot: Path) -> None:
    with closing(up(robot)) as layer:
        layer.handle({"command": "schedule", "rule": "every day at 7:00", "text": "wave"}, "ann")
        before = {each.mission.text: each.id for each in layer.store.schedules()}
    with closing(up(robot)) as layer:
        assert {each.mission.text: each.id for each in layer.store.schedules()} == before
    week = robot.parent / "week.toml"
    week.write_text(week.read_text(encoding="utf-8").replace("18:00", "19:00").split("[[")[2].join(["[[", ""]))
    with closing(up(robot)) as layer:
        after = {each.mission.text: each.id for each in layer.store.schedules()}
        assert after.keys() == {"wave", 'say "We close."'}
        assert after["wave"] == before["wave"]
        assert after['say "We close."'] != before['say "We close."']


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("every day at 9:00", "every day at 9", "Write for example: 9 am, or 9 pm, or 9:00"),
        ("within = 600", "within = 0", '"within" must be'),
        ("priority", "prioritty", '"prioritty"'),
        ('"replace"', '"throw away"', '"overlap" must be'),
        ('mission = "tour"', "mission = 3", '"mission" must be'),
    ],
)
def test_what_is_wrong_with_a_file_of_schedules(robot: Path, old: str, new: str, reason: str) -> None:
    week = robot.parent / "week.toml"
    week.write_text(WEEK.replace(old, new), encoding="utf-8")
    with pytest.raises(MissionError) as caught:
        read_schedules(str(week))
    [problem] = caught.value.diagnostics
    assert (problem.code, problem.span.place.split(":")[0]) == ("BT191", str(week))
    assert reason in problem.message


def test_a_schedule_of_an_unknown_mission_is_refused(robot: Path) -> None:
    (robot.parent / "week.toml").write_text(WEEK.replace('"tour"', '"detour"'), encoding="utf-8")
    with pytest.raises(MissionError, match="detour"):
        up(robot)
    up_again = robot.parent / "week.toml"
    up_again.write_text(WEEK, encoding="utf-8")
    up(robot).close()  # the store was let go of


@pytest.mark.parametrize("key", ["rules", "missions", "schedules"])
def test_they_are_in_the_folder_of_the_robot_file(robot: Path, key: str) -> None:
    text = robot.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith(key))
    for other in ("/etc/passwd", "../robot.toml", "nowhere"):
        robot.write_text(text.replace(line, f'{key} = "{other}"'), encoding="utf-8")
        with pytest.raises(MissionError, match="in the folder of the robot file"):
            read_body(str(robot))


def test_a_rule_of_a_single_command_acts(tmp_path: Path) -> None:
    """It was taken for a command of the mission, so nobody heard that a rule acts."""
    rules = tmp_path / "rules.txt"
    rules.write_text("whenever the battery is below 60%, wait 10 minutes\n")
    with layer_in(tmp_path, rules=str(rules)) as layer:
        submit(layer, "wait 10 minutes")
        wait_until(lambda: layer.executor.task is not None and layer.executor.run is not None)
        assert not layer.executor.is_rule_acting
        layer.session.robot.power.set_level(50.0)
        wait_until(lambda: layer.executor.is_rule_acting)
