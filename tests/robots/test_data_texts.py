"""Worlds and robots that come as texts, perhaps from somebody who wishes no good."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.recording.bundle import files_of
from btlang.robots.bodies.body_file import read_body
from btlang.robots.worlds.world_file import read_world
from btlang.text.source import Source

START = "start = { x = 1, y = 1 }\n"
BODY = 'name = "a"\nradius = 0.2\n'
MANY = 200_000


def rows(row: Callable[[int], str], length: int = MANY) -> str:
    """As many different rows as a text of this length has."""
    made = map(row, itertools.count())
    found, left = [], length
    while left > 0:
        found.append(next(made))
        left -= len(found[-1])
    return "".join(found)


def place(number: int) -> str:
    return f'{{name="{number}",x=1,y=1}},'


FAULT = '{kind="blocked",place="z"},'


def joint(number: int) -> str:
    return f'{{name="{number}",part="b",low=0,high=1,speed=1}},'


WORLDS = {
    "no TOML": ("{", "this isn't TOML"),
    "a NUL": (START + "\0", "this isn't TOML"),
    "half a character": (START + r'places = [{ name = "\ud800", x = 1, y = 1 }]', "not a Unicode scalar value"),
    "NaN": (START + "walls = [[[nan, 1], [2, 2]]]", "a wall is a list of two or more points"),
    "infinity": (START + "walls = [[[inf, 1], [2, 2]]]", "a wall is a list of two or more points"),
    "a huge wall": (START + f"walls = [[[0x{'f' * 1000}, 1], [2, 2]]]", "a wall is a list of two or more points"),
    "a huge number": (f"start = {{ x = 0x{'f' * MANY}, y = 1 }}", "must be a number from -1,000,000 to 1,000,000"),
    "a long number": (f"start = {{ x = {'9' * MANY}, y = 1 }}", "a number is too long"),
    "too large a number": ("start = { x = 1e999, y = 1 }", "must be a number from"),
    "deep lists": (START + "walls = " + "[" * MANY, "nested too deep"),
    "deep tables": (START + "walls = " + "{a=" * MANY, "nested too deep"),
    "a deep key": (START + "a." * MANY + "a = 1", "a key has more than 16 parts"),
    "a deep header": ("[" + "a." * MANY + "a]", "a key has more than 16 parts"),
    "a deep key in quotes": (START + '"=". ' * MANY + "a = 1", "a key has more than 16 parts"),
    "many deep tables": (START + rows(lambda at: f"k{at}={'{a=' * 150}1{'}' * 150}\n"), 'unknown key "k0"'),
    "many keys": (START + rows(lambda at: f"k{at} = 1\n"), 'unknown key "k0"'),
    "quotes that don't end": (START + 'a = "' + r"\"" * MANY, "this isn't TOML"),
    "many places at many walls": (
        f"{START}walls = [[{'[9,9],' * 20_000}]]\nplaces = [{rows(place)}]",
        "places are too many for 19,999 pieces of wall",
    ),
    "many faults": (
        START + f"places = [{rows(place)}]\nfaults = [{rows(lambda at: FAULT)}]",
        '"place" must be one of',
    ),
}
ROBOTS = {
    "another robot": (BODY + 'over = "ros"', '"over" may only be "simulated" here'),
    "no robot": (BODY + 'over = "os:system"', '"over" must be one of "simulated", "devices", "ros", "actions"'),
    "infinity": ('name = "a"\nradius = inf', "must be a number from"),
    "twice the same": (BODY + f"joints = [{rows(joint)}{joint(7)}]", '"7" is given twice in joints'),
    "many steps": (
        BODY + f"joints = [{rows(joint)}]\n[postures]\nx = [{'{},' * 60_000}{{ q = 1 }}]",
        'the robot has no joint "q"',
    ),
}


@pytest.mark.parametrize("name", WORLDS)
def test_worlds_that_are_too_much(name: str) -> None:
    text, told = WORLDS[name]
    began = time.monotonic()
    with pytest.raises(MissionError) as caught:
        read_world(Source(text, "world"))
    assert time.monotonic() - began < 10.0
    [problem] = caught.value.diagnostics
    assert (problem.code, problem.span.source.name) == ("BT070", "world")
    assert told in problem.message


@pytest.mark.parametrize("name", ROBOTS)
def test_robots_that_are_too_much(name: str) -> None:
    text, told = ROBOTS[name]
    began = time.process_time()
    with pytest.raises(MissionError) as caught:
        read_body(Source(text, "robot"), ("simulated",))
    assert time.process_time() - began < 10.0
    [problem] = caught.value.diagnostics
    assert (problem.code, problem.span.source.name) == ("BT071", "robot")
    assert told in problem.message


def test_a_mistake_has_its_place_in_the_text() -> None:
    with pytest.raises(MissionError) as caught:
        read_world(Source("\r\n" + START + "wals = []", "world"))
    assert caught.value.diagnostics[0].span.place == "world:3:1"


def test_keys_of_a_text_are_no_parts_of_a_key() -> None:
    dots = ".".join("a" * 30)
    world = read_world(Source(f'# {dots}\n{START}places = [{{ name = "{dots}", x = 1, y = 1 }}]'))
    assert world.names.places == (dots,)
    for quotes in ('"""', "'''"):
        other = Source(f"{START}places = [{{ name = {quotes}{dots}{quotes}, x = 1, y = 1 }}]")
        assert read_world(other).names == world.names


def test_a_mission_in_a_world_that_is_a_text() -> None:
    world = Source(START + 'places = [{ name = "shed", x = 1, y = 2 }]', "garden")
    mission = btlang.parse_tree("go to the shed", world=world)
    assert mission.run(speed="max").succeeded
    module: dict[str, object] = {"__name__": "module"}
    exec(str(mission.to("python")), module)
    made = module["mission"]
    assert isinstance(made, btlang.Mission)
    assert (made.tree, made.run(speed="max").succeeded) == (mission.tree, True)
    assert files_of(mission, ())["world.toml"].decode() == world.text
    with pytest.raises(MissionError, match="BT070"):
        btlang.parse_tree("go to the shed", world=Source("", "garden"))
