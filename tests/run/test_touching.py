"""Who may touch what is ahead: missions that wait for a bump, and actions whose keyword entry says so."""

from __future__ import annotations

import pytest

import btlang
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose
from btlang.robots.simulation.connection import Simulation
from btlang.robots.worlds.world import World
from btlang.vocabulary.decorators import action

WALL = World(start=Pose(0.0, 0.0), walls=(((2.0, -2.0), (2.0, 2.0)),))


@action("push the wall", touches=True)
def push(robot):
    """Drives until it touches."""
    try:
        while not robot.bumped:
            robot.drive(0.5, 0.0)
            yield
    finally:
        robot.drive(0.0, 0.0)


def run(mission: str) -> tuple[str, int, float]:
    """Why it failed, how often it bumped, and the greatest speed in the last 3 cm."""
    speeds = [0.0]
    simulation = Simulation(WALL, standard_body())
    robot = simulation.robot
    robot.on_step = lambda dt: speeds.append(abs(robot.velocity[0])) if 1.77 < robot.pose.x < 1.799 else None
    with btlang.Session(lambda world: simulation) as session:
        made = session.run(btlang.parse_tree(mission, keywords=[push]), speed="max", time_limit=30.0)
    assert made.outcome is not None
    return made.why(), robot.bumps, max(speeds)


@pytest.mark.parametrize(
    "mission", ["move forward until bumped", "move forward 5 m until I hit the wall", "push the wall"]
)
def test_it_drives_to_contact_at_the_contact_speed(mission: str) -> None:
    why, bumps, speed = run(mission)
    assert (why, bumps) == ("", 1)
    assert 0.0 < speed <= standard_body().contact_speed + 1e-6


@pytest.mark.parametrize(
    "mission",
    ["move forward 5 m", "whenever bumped, say ouch. move forward 5 m", "unless bumped, move forward 5 m"],
)
def test_else_it_stops_before(mission: str) -> None:
    why, bumps, _ = run(mission)
    assert "scanner: 0.04 m ahead" in why
    assert bumps == 0
