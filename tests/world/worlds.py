"""Worlds with people in them, for tests and benchmarks."""

from __future__ import annotations

from random import Random

from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import load_world
from btlang.text.source import Source
from btlang.vocabulary.shipped import shipped

TWO_ROOMS = """
start = { x = 1, y = 2, facing = 0 }
walls = [[[0, 0], [10, 0], [10, 4], [0, 4], [0, 0]], [[5, 0], [5, 1.5]], [[5, 2.5], [5, 4]]]
places = [{ name = "west", x = 1, y = 2 }, { name = "east", x = 9, y = 2 }]
"""
"""Two rooms with a doorway of a metre between them."""

_ZONES = """
[[zones]]
name = "wet floor"
kind = "slow"
speed = 0.2
points = [[8, 8], [12, 8], [12, 9], [8, 9]]
[[zones]]
name = "stairs"
kind = "keep out"
points = [[8.2, 5], [8.8, 5], [8.8, 8], [8.2, 8]]
[[zones]]
name = "exhibit"
kind = "keep out"
points = [[14, 12], [16, 12], [16, 14], [14, 14]]
"""
_SPOTS = ((9, 9.5), (5.5, 3.2), (14.5, 4.6), (1, 1), (12, 12), (8, 1.5), (2, 13), (18, 1), (18, 13), (10, 9))


def world_of(text: str) -> World:
    """The world of a text."""
    return load_world(Source(text, "world.toml"))


def rooms(people: str = "", more: str = "") -> World:
    """The two rooms with these people and whatever else."""
    return world_of(more + TWO_ROOMS + people)


def museum(people: int, zones: bool = True) -> World:
    """The museum of the examples with at most ten people who walk from place to place, and three zones."""
    with open(shipped("examples/worlds/museum.toml"), encoding="utf-8") as file:
        text = file.read().partition("people = [")[0]
    text += _ZONES if zones else ""
    for index, (x, y) in enumerate(_SPOTS[:people]):
        text += f'\n[[people]]\nname = "P{index}"\nx = {x}\ny = {y}\nwalks = "anywhere"\n'
    return world_of(text)


def doorway(seed: int) -> World:
    """Two people who want through the doorway, one from each side, as the robot does."""
    random = Random(seed)
    west, east = random.uniform(1, 3), random.uniform(7, 9)
    heights = [random.uniform(0.6, 3.4) for _ in range(2)]
    return rooms(f"""
[[people]]
name = "A"
x = {west}
y = {heights[0] if abs(heights[0] - 2) > 0.6 else 3.2}
walks = [[9, 3]]
[[people]]
name = "B"
x = {east}
y = {heights[1]}
walks = [[1, 1]]
""")


LIVELY = (
    TWO_ROOMS
    + """
objects = [{ name = "cup", x = 8.5, y = 3.6, known = false }]
[[zones]]
name = "wet floor"
kind = "slow"
speed = 0.2
points = [[2.2, 0.3], [4.2, 0.3], [4.2, 1.3], [2.2, 1.3]]
[[zones]]
name = "stairs"
kind = "keep out"
points = [[6, 0.3], [7.5, 0.3], [7.5, 1.2], [6, 1.2]]
[[doors]]
name = "door"
from = [5, 1.5]
to = [5, 2.5]
[[people]]
name = "Vera"
x = 9
y = 3.2
comes = 2
walks = [[6.2, 2], [3, 3.2]]
leaves = 25
[[people]]
name = "Olga"
x = 2.4
y = 2.8
answers = { "coffee" = "yes" }
"""
)
"""The two rooms with zones, a door, somebody who comes and goes, and somebody who answers."""
