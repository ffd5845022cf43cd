"""Driving and turning by a distance or an angle.

All fail when the robot bumps, gets stuck, does not get on, goes much too far or is stopped.
"""

from __future__ import annotations

from collections.abc import Callable, Generator

from btlang.actions.common import BaseWatch, DrivingRobot, share_of, where
from btlang.engine.leaves.leaf import ActionFailed, ignore_progress
from btlang.robots.geometry import wrap
from btlang.robots.motion.progress import Approach, DriveProgress

Steps = Generator[None, None, None]
Report = Callable[[float], object]

_CLOSE_ENOUGH = 0.004
_ANGLE_CLOSE_ENOUGH = 0.25
_SLOWEST, _SLOWEST_TURN = 0.012, 1.0  # near the goal; slower, one that swings round it would take too long
_STRAIGHTENING = 2.0  # degrees a second for each degree off course


def move_forward(
    robot: DrivingRobot,
    distance: float,
    speed: float | None = None,
    manner: str | None = None,
    progress: Report = ignore_progress,
) -> Steps:
    """Drive straight ahead by `distance` metres, to the centimetre, at `speed` m/s (or in this manner)."""
    yield from drive_straight(robot, distance, _speed(robot, speed, manner), progress)


def move_backward(
    robot: DrivingRobot,
    distance: float,
    speed: float | None = None,
    manner: str | None = None,
    progress: Report = ignore_progress,
) -> Steps:
    """Drive straight back by `distance` metres, to the centimetre, at `speed` m/s (or in this manner)."""
    yield from drive_straight(robot, -distance, _speed(robot, speed, manner), progress)


def _speed(robot: DrivingRobot, speed: float | None, manner: str | None) -> float:
    return share_of(robot, manner) * (speed or robot.normal_speed)


def turn_left(robot: DrivingRobot, angle: float, progress: Report = ignore_progress) -> Steps:
    """Turn on the spot by `angle` degrees counter-clockwise, to the degree."""
    yield from turn(robot, angle, progress)


def turn_right(robot: DrivingRobot, angle: float, progress: Report = ignore_progress) -> Steps:
    """Turn on the spot by `angle` degrees clockwise, to the degree."""
    yield from turn(robot, -angle, progress)


def turn_around(robot: DrivingRobot) -> Steps:
    """Turn on the spot to where its back was."""
    yield from turn(robot, 180.0)


def turn_once_around(robot: DrivingRobot) -> Steps:
    """Turn on the spot by a full turn."""
    yield from turn(robot, 360.0)


def stop(robot: DrivingRobot) -> Steps:
    """Bring the base to rest. Fails if it does not come to rest within the patience of the robot."""
    robot.drive(0.0, 0.0)
    until = robot.time + robot.body.patience
    while (velocity := robot.velocity) != (0.0, 0.0):
        if robot.time > until:
            raise ActionFailed(
                "the robot doesn't stop: it is moving at {:.2f} m/s and {:.0f} degrees/s".format(*velocity)
            )
        yield


def face_place(robot: DrivingRobot, place: str | None = None, x: float | None = None, y: float | None = None) -> Steps:
    """Turn on the spot towards a place or a point."""
    yield from turn(robot, robot.pose.bearing_to(where(robot, place, x, y)))


def face_person(robot: DrivingRobot, person: str) -> Steps:
    """Turn on the spot towards a person."""
    yield from turn(robot, robot.pose.bearing_to(robot.locate(person)))


def face_object(robot: DrivingRobot, object: str) -> Steps:
    """Turn on the spot towards an object."""
    yield from turn(robot, robot.pose.bearing_to(robot.locate(object)))


def drive_straight(
    robot: DrivingRobot, distance: float, speed: float | None = None, progress: Report = ignore_progress
) -> Steps:
    """Drive `distance` metres along the heading (negative: backwards), keep the course, and brake."""
    start, watch = robot.pose, BaseWatch(robot)
    bounds = DriveProgress(
        distance, _CLOSE_ENOUGH, False, lambda: robot.time, robot.body.patience, lambda: robot.limited_by
    )
    driving = robot.body.driving
    limit = min(driving.speed if speed is None else abs(speed), driving.top_speed)
    approach = Approach(limit, 3.0, driving.slowing, _SLOWEST)
    try:
        while True:
            pose = robot.pose
            gone = start.progress_of(pose)
            watch.check_base(f"{abs(gone):.2f} m")
            left = distance - gone
            if abs(left) <= _CLOSE_ENOUGH:
                return
            bounds.check(left, start.distance_to((pose.x, pose.y)))
            progress(gone / distance)
            course = wrap(start.heading - pose.heading)
            robot.drive(approach.velocity(left), _STRAIGHTENING * course)
            yield
    finally:
        robot.drive(0.0, 0.0)


def turn(robot: DrivingRobot, angle: float, progress: Report = ignore_progress) -> Steps:
    """Turn on the spot by `angle` degrees (left positive; more than a whole turn is fine) and brake."""
    heading, turned, watch = robot.pose.heading, 0.0, BaseWatch(robot)
    turning = robot.body.turning
    approach = Approach(turning.speed, 4.0, turning.slowing, _SLOWEST_TURN)
    bounds = DriveProgress(angle, _ANGLE_CLOSE_ENOUGH, True, lambda: robot.time, robot.body.patience)
    try:
        while True:
            turned += wrap(robot.pose.heading - heading)
            heading = robot.pose.heading
            watch.check_base(f"{abs(turned):.0f} degrees")
            left = angle - turned
            if abs(left) <= _ANGLE_CLOSE_ENOUGH:
                return
            bounds.check(left, turned)
            progress(turned / angle)
            robot.drive(0.0, approach.velocity(left))
            yield
    finally:
        robot.drive(0.0, 0.0)
