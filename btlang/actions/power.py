"""Docking and charging."""

from __future__ import annotations

from btlang.actions.motion import Steps, drive_straight
from btlang.actions.navigation import accomplish, travel
from btlang.actions.watch import Watch
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Robot


def dock(robot: Robot) -> Steps:
    """Drives to the dock and connects; does nothing when docked."""
    if not robot.docked:
        yield from travel(robot, "dock")
        yield from accomplish(robot.dock())


def undock(robot: Robot) -> Steps:
    """Disconnects and backs off; does nothing when not docked."""
    if robot.docked:
        yield from accomplish(robot.undock())
        if robot.body.dock is not None:
            yield from drive_straight(robot, -robot.body.dock.backs_off)


def charge(robot: Robot, percent: float) -> Steps:
    """Docks if need be and waits until the battery holds `percent`. Fails where the robot leaves the dock before."""
    yield from dock(robot)
    watch = Watch(robot)
    while robot.battery < percent:
        watch.check_stop()
        if not robot.docked:
            raise ActionFailed(f"the robot left the dock at {robot.battery:.0f}%")
        yield
