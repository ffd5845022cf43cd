"""What a ROS 2 robot knows of people and objects, from what is in view."""

from __future__ import annotations

from types import SimpleNamespace as Made
from typing import Any

import pytest

from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world_file import load_world
from btlang.ros.robot.places import RosPlaces
from btlang.ros.robot.sensors import _fault
from btlang.text.source import Source

WORLD = """
start = { x = 1, y = 1 }
places = [{ name = "lab", x = 2, y = 2 }]
objects = [
    { name = "cup", x = 3, y = 1 },
    { name = "key", x = 4, y = 1, known = false },
    { name = "lamp", x = 5, y = 1, fixed = true },
]
people = [
    { name = "Bob", x = 3, y = 3, walks = ["lab"] },
    { name = "Ann", x = 4, y = 3 },
    { name = "Zoe", x = 4, y = 4, comes = 5 },
]
"""
HERE = Pose(1.0, 1.0)


@pytest.fixture
def met() -> list[str]:
    return []


@pytest.fixture
def places(met: list[str]) -> RosPlaces:
    return RosPlaces(load_world(Source(WORLD, "hall.toml")), standard_body(), met.append)


def test_before_anything_is_seen(places: RosPlaces) -> None:
    places.notice({}, 0.1, HERE)
    assert places.locate("cup", HERE) == (3.0, 1.0)
    assert places.locate("Bob", HERE) == (3.0, 3.0)
    for name, said in (("key", "the key"), ("zoe", "Zoe")):
        with pytest.raises(RobotError, match=f"^I haven't seen {said}$"):
            places.goal(name, HERE)
    assert places.free("object") == ["cup"]
    assert places.nearby_people(10.0, HERE) == ["Ann"]


def test_what_is_seen_is_known(places: RosPlaces, met: list[str]) -> None:
    places.notice(
        {"key": ("object", (4.5, 1.0)), "BOB": ("person", (2.0, 1.0)), "cup": ("object", (3.5, 1.0))}, 1.0, HERE
    )
    assert places.locate("key", HERE) == (4.5, 1.0)
    assert places.locate("cup", HERE) == (3.5, 1.0)
    assert places.nearby_people(2.0, HERE) == ["Bob"]
    assert places.sight.seen("person", HERE) == ["Bob"]
    assert sorted(met) == ["Bob", "key"]
    places.notice({}, 9.0, HERE)
    assert places.sight.seen("person", HERE) == []
    assert places.nearby_people(10.0, HERE) == ["Ann"]
    assert places.locate("Bob", HERE) == (2.0, 1.0)
    assert ("Bob", 2.0, 1.0, False) in places.whereabouts()
    assert places.sight.lost("Bob") == "I've lost sight of Bob"
    assert places.sight.lost("key") == "the key is no longer where I saw it"
    assert places.sight.lost("cup") is None
    places.sight.forget()
    with pytest.raises(RobotError, match=r"^I haven't seen Bob$"):
        places.locate("Bob", HERE)


def test_a_stranger_gets_a_name(places: RosPlaces) -> None:
    places.notice({"visitor 1": ("person", (2.0, 1.0))}, 1.0, HERE)
    assert places.known("Visitor 1") == "visitor 1"
    assert places.goal("visitor 1", HERE).distance_to((2.0, 1.0)) < 1.5
    assert "visitor 1" in places.free("person")


def test_what_is_fixed_cannot_be_picked_up(places: RosPlaces) -> None:
    with pytest.raises(RobotError, match=r"^the lamp is fixed$"):
        places.check_movable("lamp")
    with pytest.raises(RobotError, match=r"^I haven't seen the key$"):
        places.check_movable("key")
    places.check_movable("cup")


def message(frame: str = "map", **sighting: Any) -> Any:
    each = Made(**{"name": "cup", "kind": "object", "position": Made(x=1.0, y=2.0), **sighting})
    return Made(header=Made(frame_id=frame), sightings=[each])


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        (message(), ""),
        (message("base_link"), "gives points in the frame base_link, not map"),
        (message(position=Made(x=float("inf"), y=0.0)), "sends numbers that are not finite"),
        (message(kind="cat"), "names something that is neither a person nor an object"),
        (message(name=""), "names something that is neither a person nor an object"),
        (Made(header=Made(frame_id=""), sightings=[None] * 1001), "has more than 1000 things in view at once"),
    ],
)
def test_what_cannot_be_in_view_is_refused(given: Any, reason: str) -> None:
    assert _fault(given) == reason
