"""What a servo of a joint measures."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.devices.device_set import Reads, reader
from btlang.devices.kinds import JointState
from btlang.robots.bodies.body import Body
from btlang.robots.robot import joint_of


def servo_angle(body: Body, devices: Mapping[str, Reads], name: str) -> float:
    """Where a joint is, as its servo measures it. Raises RobotError for an unknown joint, and DeviceSilent."""
    reading = reader(devices, joint_of(body, name).name, name).read(name)
    assert isinstance(reading, JointState)
    return reading.position
