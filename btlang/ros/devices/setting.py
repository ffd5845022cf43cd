"""What messages of ROS 2 need to know of a device. Imports no ROS."""

from __future__ import annotations

from math import pi

from btlang.support.record import Record

COMMANDS = "command"
"""The name of the topic for commands, below that of the readings."""


class Setting(Record):
    """The properties of a device that its messages depend on.

    `joint` is the name of a joint or a hand in messages, and `slides` whether its position is in metres; `wheel_gap` is
    the metres between two wheels, `range` the metres that a sensor sees, `frame` the frame that it is in.
    """

    joint: str
    slides: bool = False
    wheel_gap: float = 0.0
    range: float = 0.0
    frame: str = "base_link"

    @property
    def si(self) -> float:
        """What a unit of the joint is in messages."""
        return 1.0 if self.slides else pi / 180


class TopicDevice(Record):
    """A device with its topics, "" where it has none, and the seconds after which it is silent."""

    name: str
    kind: str
    topic: str
    command: str
    silence: float
    setting: Setting


def topic_name(device: str) -> str:
    """Return the default topic of a device, without a namespace: characters that ROS 2 doesn't take become `_`."""
    name = "".join(each if each.isascii() and each.isalnum() else "_" for each in device)
    return name if name[:1].isalpha() else f"device_{name}"
