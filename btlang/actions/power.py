"""Docking and charging."""

from __future__ import annotations

from typing import Protocol

from btlang.actions.docking import Homing, enter_a_dock
from btlang.actions.motion import Steps, drive_straight
from btlang.actions.navigation import accomplish
from btlang.actions.watch import Driving, Watch
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Docking, Power


class Undocking(Driving, Docking, Protocol):
    """It can leave its dock."""


class Charging(Homing, Power, Protocol):
    """It finds its dock, and knows its battery."""


def dock(robot: Homing) -> Steps:
    """Drives to the nearest dock and connects, or to the next one where that fails; does nothing when docked."""
    if not robot.docked:
        stations = robot.stations
        yield from accomplish(robot.dock()) if stations is None else enter_a_dock(robot, stations)


def undock(robot: Undocking) -> Steps:
    """Disconnects and backs off; does nothing when not docked."""
    if robot.docked:
        backs_off = robot.stations is not None
        yield from accomplish(robot.undock())
        if backs_off and robot.body.dock is not None:
            yield from drive_straight(robot, -robot.body.dock.backs_off)


def charge(robot: Charging, percent: float) -> Steps:
    """Docks if need be and waits until the battery holds `percent`. Fails where the robot leaves the dock before."""
    yield from dock(robot)
    watch = Watch(robot)
    while robot.battery < percent:
        watch.check_stop()
        if not robot.docked:
            raise ActionFailed(f"the robot left the dock at {robot.battery:.0f}%")
        yield
