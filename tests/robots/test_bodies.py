"""Missions on other bodies than the one that ships."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.cli.examples import Example, examples
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import read_body
from btlang.robots.geometry import Pose
from btlang.robots.preflight import find_missing_parts
from btlang.robots.registry import runs_on
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.text.source import Source
from btlang.vocabulary.shipped import BODIES, shipped
from tests.profiles import cases

EMPTY = World(start=Pose(0.0, 0.0))


@pytest.fixture
def small() -> Body:
    return read_body(f"{BODIES}/small.toml")


def run(text: str, **options: object) -> btlang.Outcome:
    return btlang.parse_tree(text).run(speed="max", **options)


def test_limits_are_those_of_the_body(small: Body) -> None:
    robot = SimulatedRobot(EMPTY, body=small)
    robot.drive(5.0, 0.0)
    for _ in range(100):
        robot.step(0.05)
    assert robot.velocity == (small.driving.top_speed, 0.0)
    robot.move_joints({"neck": 500.0})
    robot.step(0.5)
    assert robot.joint("neck") == 90.0
    robot.step(0.5)
    assert robot.joint("neck") == 120.0
    assert robot.joint("shoulder") == 10.0


def test_a_robot_of_a_file_runs_a_mission() -> None:
    fast = run("go to the lab").seconds
    slow = run("go to the lab", robot="small").seconds
    assert slow > 1.1 * fast
    assert run("pick up the cup then wave at Alice then look around", robot=f"{BODIES}/small.toml").succeeded


def test_a_world_needs_room_for_the_robot_that_is_chosen() -> None:
    """The standard robot has a radius of 0.2 m, the small one of 0.15 m."""
    start = "start = { x = 1, y = 1 }\n"
    tight = Source(
        f'{start}walls = [[[2.17, 0], [2.17, 3]]]\nplaces = [{{ name = "desk", x = 2, y = 1 }}]', "tight", roots=()
    )
    mission = btlang.parse_tree("go to the desk", world=tight)
    mission.check("small")
    assert mission.run(speed="max", robot="small").succeeded
    with pytest.raises(MissionError, match=r"the place \"desk\" .* leave 0.2 m to every wall"):
        mission.check("simulated")
    with pytest.raises(MissionError, match=r"leave 0\.2 m to every wall"):
        mission.run(speed="max")
    full = Source(f"{start}boxes = [{{ x = 1, y = 1, width = 5, height = 5 }}]", "full", roots=())
    with pytest.raises(MissionError, match=r"the start at \(1, 1\) is inside a wall or a box\."):
        btlang.parse_tree("wave", world=full)


def test_what_the_body_lacks_is_said_before_the_run() -> None:
    with pytest.raises(MissionError) as caught:
        run("say hello, then raise both arms, then nod, then dock", robot="small")
    assert [diagnostic.code for diagnostic in caught.value.diagnostics] == ["BT072"] * 3
    text = str(caught.value)
    assert "The robot 'small' has no left arm, which 'raise both arms' needs." in text
    assert "The robot 'small' has no posture \"nod\", which 'nod' needs." in text
    assert "The robot 'small' has no dock, which 'dock' needs." in text


def test_over_decides(tmp_path: Path) -> None:
    path = tmp_path / "r.toml"
    path.write_text('name = "r"\nradius = 0.2\nscreen = true\nover = "ros"')
    assert runs_on(str(path))[1] == "ros"
    assert runs_on(str(path), "simulated")[1] == "simulated"
    assert runs_on("actions")[1] == "actions"
    with btlang.Session(str(path), over="simulated") as session:
        assert session.run(btlang.parse_tree("print hello"), speed="max").outcome.succeeded
    with pytest.raises(ValueError, match="over must be 'simulated' or 'devices' or 'ros' or 'actions', not 'tcp'"):
        btlang.Session(over="tcp")
    with pytest.raises(ValueError, match="a robot file"):
        btlang.Session("simulatd")


def test_a_world_has_to_leave_room_for_the_body(tmp_path: Path) -> None:
    path = tmp_path / "wide.toml"
    path.write_text('name = "wide"\nradius = 2.0')
    with pytest.raises(MissionError, match="leave 2 m to every wall"):
        btlang.Session(str(path))


LACKS = {
    "dance": ["left arm", 'posture "right arm pointing"', 'posture "nod"', 'posture "look down"', 'posture "look up"'],
    "evening_rounds": ['posture "nod"'],
    "hide_and_seek": ['posture "nod"'],
    "locked_lab": ["left hand"],
    "morning_exercises": ["left arm", 'posture "nod"'],
    "museum_guide": ["dock", 'posture "nod"', 'posture "right arm pointing"'],
    "museum_tour": ['posture "nod"', 'posture "right arm pointing"', 'posture "look up"'],
    "night_patrol": ["dock"],
    "night_watch": ["dock"],
    "obedience": ['posture "nod"', "left arm"],
    "oily_floor": ["dock"],
    "parcels": ["dock"],
    "tea_service": ['posture "nod"'],
}
"""What the small robot lacks for examples; it runs the others."""
ENDS = {"roaming": btlang.Status.IDLE, "waiting": btlang.Status.FAILURE}
"""What examples come to that do not succeed: one goes on for ever, one waits for somebody who does not come."""


@cases("example", examples(), 8, ids=lambda example: example.name)
def test_examples_on_the_small_robot(example: Example) -> None:
    source = read_source(shipped("examples", f"{example.name}.txt"))
    mission = btlang.parse_tree(source, world=shipped("examples", example.world) if example.world else None)
    if example.name in LACKS:
        with pytest.raises(MissionError) as caught:
            mission.run(robot="small", speed="max")
        lacks = [dict(diagnostic.arguments)["parts"] for diagnostic in caught.value.diagnostics]
        assert sorted(" and no ".join(lacks).split(" and no ")) == sorted(LACKS[example.name])
    else:
        outcome = mission.run(robot="small", speed="max", seed=1, time_limit=600.0)
        assert outcome.status is ENDS.get(example.name, btlang.Status.SUCCESS)


def test_lacking(small: Body) -> None:
    mission = btlang.parse_tree("nod then raise the left arm")
    assert list(find_missing_parts(small, mission.tree, mission.vocabulary)) == ['posture "nod"', "left arm"]


def test_a_fake_needs_nothing_of_the_body(small: Body) -> None:
    @btlang.action("dock", id="Dock", replace=True)
    def dock() -> None: ...

    mission = btlang.parse_tree("dock", keywords=[dock])
    assert mission.run(robot="small", speed="max").succeeded


def test_words_in_python_say_what_they_need() -> None:
    @btlang.action("lift up", needs=["lift"])
    def lift_up() -> None: ...

    mission = btlang.parse_tree("lift up", keywords=[lift_up])
    with pytest.raises(MissionError, match="The robot 'standard' has no lift, which"):
        mission.run(speed="max")
    with pytest.raises(MissionError, match="BT041"):
        btlang.parse_tree("lift up and lift up at the same time", keywords=[lift_up])
