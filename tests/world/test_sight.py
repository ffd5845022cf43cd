"""What the robot sees, and what it knows of what it doesn't see."""

from __future__ import annotations

import pytest

from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from tests.world.test_people import Life
from tests.world.worlds import rooms

CUP = 'objects = [{ name = "cup", x = 9, y = 3.5 }]\n'


@pytest.mark.parametrize("more", ["known = false\n" + CUP, CUP.replace("3.5 }", "3.5, known = false }")])
def test_what_is_not_known_has_to_be_seen(more: str) -> None:
    life = Life(rooms(more=more))
    robot = life.robot
    with pytest.raises(RobotError, match="I haven't seen the cup"):
        robot.locate("cup")
    goal = robot.navigate_to("cup")
    assert goal.failure == "I haven't seen the cup"
    assert not robot.sees("cup")
    robot.put(Pose(6.5, 2, 30))
    life.after(0.2)
    assert robot.sees("cup")
    assert (robot.locate("cup"), robot.seen("object")) == ((9, 3.5), ["cup"])
    assert ("see", "cup") in life.kinds("see")
    robot.put(Pose(1, 2, 180))
    life.after(0.2)
    assert not robot.sees("cup")
    assert robot.locate("cup") == (9, 3.5)  # it remembers


def test_without_a_word_things_are_known_where_the_list_puts_them() -> None:
    life = Life(rooms(more=CUP))
    assert life.robot.locate("cup") == (9, 3.5)
    assert not life.robot.sees("cup")


@pytest.mark.parametrize(
    ("pose", "sees"),
    [
        (Pose(6, 3.5, 0), True),
        (Pose(6, 3.5, 49), True),  # the camera sees 100 degrees
        (Pose(6, 3.5, 52), False),
        (Pose(2.9, 3.5, 0), False),  # farther than it sees, and behind a wall
        (Pose(4, 3.5, 0), False),  # behind a wall
        (Pose(7.4, 3.5, 180), True),  # behind its back, but the scanner recognises what is near
    ],
)
def test_field_of_view_range_and_walls(pose: Pose, sees: bool) -> None:
    life = Life(rooms(more=CUP))
    life.robot.put(pose)
    assert life.robot.sees("cup") is sees


def test_the_camera_turns_with_the_head() -> None:
    life = Life(rooms(more=CUP))
    life.robot.put(Pose(6, 3.5, 90))
    assert not life.robot.sees("cup")
    life.robot.move_joints({"head turn": -60})
    life.after(1)
    assert life.robot.sees("cup")


def test_who_walked_away_is_not_where_he_was_seen() -> None:
    life = Life(rooms('[[people]]\nname = "Otto"\nx = 9\ny = 3.5\nwalks = [{ to = [6, 0.5], at = 1 }]\n'))
    life.after(8)
    goal = life.robot.navigate_to("Otto")  # where the list has him
    life.until(lambda: goal.done, 60)
    assert goal.failure in (None, "I've lost sight of Otto")
    if goal.failure is None:
        assert life.robot.sees("Otto")  # he was met on the way


def test_who_is_not_where_he_was_seen_is_not_there() -> None:
    life = Life(rooms('[[people]]\nname = "Otto"\nx = 9\ny = 2\nwalks = [{ to = [6, 0.5], at = 1 }]\n'))
    there = {"named": "Otto", "at": "east"}
    life.after(8)
    assert life.robot.described("person", there) == ["Otto"]  # as far as it knows
    life.robot.put(Pose(7.5, 2, 0))
    life.after(0.2)
    assert not life.robot.sees("Otto")  # behind its back
    assert life.robot.described("person", there) == []
    life.robot.put(Pose(7.5, 2, 225))
    life.after(0.2)
    assert life.robot.described("person", {"named": "Otto"}) == ["Otto"]


def test_a_closed_door_hides_what_is_behind_it() -> None:
    door = '[[doors]]\nname = "gate"\nfrom = [5, 1.5]\nto = [5, 2.5]\n'
    life = Life(rooms(door, more='objects = [{ name = "cup", x = 7, y = 2 }]\n'))
    life.robot.put(Pose(3, 2, 0))
    assert life.robot.sees("cup")
    life.robot.surroundings.swing("gate", False)
    assert not life.robot.sees("cup")
