"""The names that keyword entries give to what they need of a robot: `needs = ["navigation"]`.

A name that is not here is a part of the body that has joints, such as "head", "left arm" or "lift"; two commands that
run at the same time cannot both have it. "posture wave" is a posture that the robot file has to name.
"""

from __future__ import annotations

from collections.abc import Iterable

from btlang.support.record import Record


class Capability(Record):
    """`part` is what the robot lacks without it, in messages; `resources` are what it needs for itself."""

    part: str
    resources: tuple[str, ...] = ()


_ARMS = ("left arm", "right arm")
HOLDING = "holding"
HEARS = "ears"
TRAVELS = "navigation"
"""What a command needs that drives by itself: it takes a place in its own way, or none."""
CAPABILITIES = {
    "base": Capability("base", ("base",)),
    "pose": Capability("base"),
    TRAVELS: Capability("navigation", ("base",)),
    "docking": Capability("dock", ("base",)),
    "docked": Capability("dock"),
    "battery": Capability("battery"),
    "charging": Capability("battery"),
    "scanner": Capability("scanner"),
    "bumper": Capability("bumper"),
    "joints": Capability("joints"),
    "hand": Capability("hand", _ARMS),
    "left hand": Capability("left hand", _ARMS[:1]),
    "right hand": Capability("right hand", _ARMS[1:]),
    HOLDING: Capability("hand"),
    "voice": Capability("voice", ("voice",)),
    HEARS: Capability("ears"),
    "perception": Capability("camera that recognises things"),
    "screen": Capability("screen", ("screen",)),
}
"""By name. Those without resources are for any number of commands at once."""
MOVES, SPEAKS = "base", "voice"
"""The resources of what moves the robot and of what speaks: a warning is spoken before the robot moves."""
POSTURE = "posture "
"""Before the name of a posture."""


def resources_of(needs: Iterable[str]) -> tuple[str, ...]:
    """What needs take for themselves, each once."""
    found: dict[str, None] = {}
    for need in needs:
        if not need.startswith(POSTURE):
            found.update(dict.fromkeys(CAPABILITIES[need].resources if need in CAPABILITIES else (need,)))
    return tuple(found)


def part_of(need: str) -> str:
    """What a robot lacks that has not got it."""
    if need.startswith(POSTURE):
        return f'posture "{need.removeprefix(POSTURE)}"'
    return CAPABILITIES[need].part if need in CAPABILITIES else need
