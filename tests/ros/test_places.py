"""What a ROS 2 robot chooses by nouns with parts, and what it has given away."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.descriptions import Choices
from btlang.robots.worlds.world_file import load_world
from btlang.ros.robot.places import RosPlaces
from btlang.text.source import Source

WORLD = """
start = { x = 1, y = 1 }
places = [{ name = "lab", x = 2, y = 2 }, { name = "hall", x = 5, y = 5 }]
objects = [
    { name = "tea cup", x = 3, y = 1, kind = "cup", color = "red", size = 0.1 },
    { name = "mug", x = 2, y = 1, kind = "cup", color = "blue", size = 0.2, uses = ["drink"] },
    { name = "crate", x = 4, y = 1, kind = "box", color = "red", size = 0.5, known = false },
    { name = "shelf", x = 5, y = 1, fixed = true },
]
people = [
    { name = "Ann", x = 4, y = 3, wears = ["red coat"] },
    { name = "Bob", x = 3, y = 3, comes = 5, gesture = "waving" },
]
"""
HERE = Pose(1.0, 1.0)


@pytest.fixture
def places() -> RosPlaces:
    return RosPlaces(load_world(Source(WORLD)), standard_body())


def choose(places: RosPlaces, kind: str, how: str, parts: Mapping[str, str] = {}, told: list[Any] | None = None) -> str:
    tell = None if told is None else lambda event, data: told.append((event, data))
    return places.choose(kind, how, parts, lambda: HERE, lambda: HERE, Choices(), tell)


def test_it_chooses_by_distance_and_size(places: RosPlaces) -> None:
    told: list[Any] = []
    assert choose(places, "object", "nearest", told=told) == "mug"
    assert told == [("choose", {"type": "object", "how": "nearest", "name": "mug"})]
    assert choose(places, "object", "largest", {"kind": "cup"}) == "mug"
    assert choose(places, "object", "smallest", {"kind": "cup"}) == "tea cup"
    assert choose(places, "place", "nearest") == "lab"
    assert choose(places, "place", "random") in ("lab", "hall")


def test_it_chooses_by_what_things_are_like(places: RosPlaces) -> None:
    assert choose(places, "object", "nearest", {"color": "red"}) == "tea cup"
    assert choose(places, "object", "nearest", {"use": "drink"}) == "mug"
    assert choose(places, "person", "nearest", {"color": "red", "clothing": "coat"}) == "Ann"
    assert places.described("object", {"kind": "cup"}, HERE) == ["mug", "tea cup"]
    with pytest.raises(RobotError, match=r"^I haven't seen a green cup$"):
        choose(places, "object", "nearest", {"color": "green", "kind": "cup"})


def test_it_chooses_among_what_it_has_seen(places: RosPlaces) -> None:
    with pytest.raises(RobotError, match=r"^I haven't seen a box$"):
        choose(places, "object", "nearest", {"kind": "box"})
    with pytest.raises(RobotError, match=r"^I don't see anybody who is waving$"):
        choose(places, "person", "seen", {"gesture": "waving"})
    assert choose(places, "person", "seen") == "Ann"
    places.notice({"Bob": ("person", (3.0, 2.5)), "crate": ("object", (1.5, 1.0))}, 1.0, HERE)
    assert choose(places, "person", "seen") == "Bob"
    assert choose(places, "person", "seen", {"gesture": "waving"}) == "Bob"
    assert choose(places, "object", "largest", {"color": "red"}) == "crate"
    assert choose(places, "object", "nearest") == "crate"


def test_what_was_given_away_is_gone(places: RosPlaces) -> None:
    places.give("mug", "Ann")
    with pytest.raises(RobotError, match=r"^Ann has the mug$"):
        places.goal("mug", HERE)
    with pytest.raises(RobotError, match=r"^Ann has the mug$"):
        places.check_movable("mug")
    assert places.locate("mug", HERE) == places.locate("Ann", HERE) == (4.0, 3.0)
    assert choose(places, "object", "nearest") == "tea cup"
