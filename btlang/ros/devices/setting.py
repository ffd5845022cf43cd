"""What has to be known of a device so that messages of ROS 2 can be made of it. Imports no ROS."""

from __future__ import annotations

from math import pi

from btlang.support.record import Record

COMMANDS = "command"
"""The name of the topic for commands, below that of the readings."""


class Setting(Record):
    """`joint` is the name of a joint or a hand in messages, and `slides` whether that is in metres; `wheel_gap` are the
    metres between two wheels, `range` those that a sensor sees, `frame` is where it is.
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
    """That of a device where nothing else is said, without a namespace: other signs than ROS 2 takes become `_`."""
    name = "".join(each if each.isascii() and each.isalnum() else "_" for each in device)
    return name if name[:1].isalpha() else f"device_{name}"
