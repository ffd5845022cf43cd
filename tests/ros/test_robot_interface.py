"""What the shipped leaves need of a ROS 2 robot. Needs no ROS 2."""

from __future__ import annotations

from btlang.robots.bodies.body_file import standard_body
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.ros.robot.interface import interfaces
from btlang.vocabulary.capabilities import CAPABILITIES, POSTURE

FREE = (
    "TimeOfDay",
    "TimeNow",
    "TodayIs",
    "Counted",
    "CallStaff",
    "RaiseAlarm",
    "ClearMap",
    "Count",
    "CountedNames",
    "DayOfWeek",
)
"""They ask the clock of the run or what was counted, or do something that nobody has to take notice of."""
OF_THE_WORLD = ("DoorOpen", "DoorClosed", "SwitchedOn", "SwitchedOff", "ZoneClosed")
"""They ask about something in the world, which has a topic of its own or is known by the world file."""


def test_all_that_shipped_leaves_need_is_something_on_the_wire() -> None:
    needs = {entries[0].id: entries[0].needs for entries in world_vocabulary().entries.values()}
    assert {name for name, needed in needs.items() if not needed} == {*FREE, *OF_THE_WORLD}
    needed = {need for needed in needs.values() for need in needed if not need.startswith(POSTURE)}
    assert [need for need in sorted(needed) if not interfaces(need, standard_body())] == []
    assert needed | {"joints"} == {*CAPABILITIES, "left arm", "right arm", "head"}


def test_hands_and_joints_are_those_of_the_body() -> None:
    body = standard_body().replace(hands=standard_body().hands[:1])
    assert [interface.name for interface in interfaces("hand", body)] == ["left_hand/close"]
    assert interfaces("right hand", body) == ()
    assert interfaces("head", body) == interfaces("joints", body) != ()
    assert interfaces("wings", body) == ()
