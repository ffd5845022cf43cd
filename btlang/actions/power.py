"""Docking and charging: to a staging pose in front of the dock, then slowly straight in, again if that fails."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from math import sqrt
from typing import Protocol

from btlang.actions.common import DrivingRobot, Watch
from btlang.actions.motion import Steps, drive_straight
from btlang.actions.navigation import accomplish
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Pose, wrap
from btlang.robots.robot import Docking, Navigation, Power, RobotError, Station

STAGING, APPROACH, CONNECTION, RETRY = "staging", "approach", "connection", "retry"
"""The stages of docking."""
_STRAIGHT = 5.0  # degrees
_PAUSE = 2.0  # seconds before another attempt: who stands in the way may walk on
_MARGIN = 0.02  # metres by which the scanner may be wrong


class HomingRobot(Navigation, Docking, DrivingRobot, Protocol):
    """A robot that finds its dock and drives into it."""


def enter_a_dock(robot: HomingRobot, stations: Sequence[Station]) -> Steps:
    """Enter the first dock that works. Fails with the reason of the last one."""
    watch = Watch(robot)
    for station in stations:
        try:
            yield from enter_dock(robot, station)
            return
        except ActionFailed:
            watch.check_stop()
            if station is stations[-1]:
                raise


def enter_dock(robot: HomingRobot, station: Station, stage: Callable[[str], object] = lambda stage: None) -> Steps:
    """Drive to the staging pose, then straight into the dock, and connect; from inside, it only connects.

    If that fails it backs off and tries again, as often as the body says. Fails with the reason of the last attempt.
    `stage` is called with each stage that begins.
    """
    part, watch = robot.body.dock, Watch(robot)
    assert part is not None
    spot, staging = station.spot, station.staging
    way = staging.distance_to((spot.x, spot.y))
    if not _is_in(robot.pose, spot, part.within):
        stage(STAGING)
        yield from accomplish(robot.navigate_to_pose(staging, station.name))
    for retries_left in reversed(range(part.retries + 1 if way else 1)):
        try:
            if way:
                stage(APPROACH)
                yield from _drive_in(robot, spot, part.speed)
            stage(CONNECTION)
            yield from accomplish(robot.dock())
            return
        except ActionFailed:
            watch.check_stop()
            if not retries_left:
                raise
        stage(RETRY)
        yield from drive_straight(robot, -max(0.0, staging.progress_of(robot.pose)), part.speed)
        yield from watch.pause(_PAUSE)


def _is_in(pose: Pose, spot: Pose, within: float) -> bool:
    return spot.distance_to((pose.x, pose.y)) <= within and abs(wrap(spot.heading - pose.heading)) <= _STRAIGHT


def _drive_in(robot: HomingRobot, spot: Pose, speed: float) -> Steps:
    with closing(drive_straight(robot, robot.pose.progress_of(spot), speed)) as driving:
        for _ in driving:
            if _is_blocked(robot, robot.pose.progress_of(spot)):
                raise ActionFailed("something is in the way into the dock")
            yield


def _is_blocked(robot: HomingRobot, left: float) -> bool:
    """Return whether it would run into something in the scan, driving on by `left` metres.

    Without a scan nobody knows: no.
    """
    if robot.body.sensor("scanner") is None:
        return False
    with suppress(RobotError):
        import numpy as np  # most missions need none

        ranges = robot.scan()
        near = np.flatnonzero(ranges < left + robot.radius)
        angles = np.radians(near)
        ahead, beside = ranges[near] * np.cos(angles), ranges[near] * np.sin(angles)
        width = robot.radius - _MARGIN
        return any(
            0.0 < x < left - _MARGIN + sqrt(robot.radius**2 - y**2)
            for x, y in zip(ahead, beside, strict=True)
            if abs(y) < width
        )
    return False


class UndockingRobot(DrivingRobot, Docking, Protocol):
    """A robot that can leave its dock."""


class ChargingRobot(HomingRobot, Power, Protocol):
    """A robot that finds its dock, and knows its battery."""


def dock(robot: HomingRobot) -> Steps:
    """Drive to the nearest dock and connect, or to the next one if that fails; do nothing when docked."""
    if not robot.docked:
        stations = robot.stations
        yield from accomplish(robot.dock()) if stations is None else enter_a_dock(robot, stations)


def undock(robot: UndockingRobot) -> Steps:
    """Disconnect and back off; do nothing when not docked."""
    if robot.docked:
        backs_off = robot.stations is not None
        yield from accomplish(robot.undock())
        if backs_off and robot.body.dock is not None:
            yield from drive_straight(robot, -robot.body.dock.backs_off)


def charge(robot: ChargingRobot, percent: float) -> Steps:
    """Dock if need be and wait until the battery has `percent`. Fails if the robot leaves the dock before."""
    yield from dock(robot)
    watch = Watch(robot)
    while robot.battery < percent:
        watch.check_stop()
        if not robot.docked:
            raise ActionFailed(f"the robot left the dock at {robot.battery:.0f}%")
        yield
