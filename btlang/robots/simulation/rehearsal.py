"""A rehearsal of a gesture: what it does to a body, tried in the simulation before a robot does it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture
from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.support.record import Record

STEP = 0.02
"""Seconds between two angles of a rehearsal."""
AHEAD: Point = (3.0, -1.0)
"""The default target of gestures: metres ahead and to the left of the robot."""
_LONGEST = 120.0


class Rehearsal(Record):
    """A gesture as a body does it.

    `angles` are those of all joints after each STEP, `slower` is how many times as long as asked it takes. `problem` is
    why it can't be done, "" if it can.
    """

    angles: Sequence[Mapping[str, float]]
    slower: float = 1.0
    problem: str = ""

    @property
    def seconds(self) -> float:
        """The seconds that it takes."""
        return STEP * (len(self.angles) - 1)


def rehearse(body: Body, gesture: Gesture, aim: Point = AHEAD) -> Rehearsal:
    """Do a gesture from rest, at full speed."""
    heard: dict[str, Any] = {}
    alone = body.replace(gestures={gesture.name: gesture})
    robot = SimulatedRobot(World(start=Pose(0, 0)), lambda kind, data: heard.setdefault(kind, data), alone)
    angles = [_angles(robot)]
    try:
        going = robot.gesture(gesture.name, aim=aim)
    except RobotError as problem:
        return Rehearsal(angles, problem=str(problem))
    while not going.done and STEP * len(angles) < _LONGEST:
        robot.step(STEP)
        angles.append(_angles(robot))
    return Rehearsal(angles, heard["gesture"]["slower"], going.failure or "")


def _angles(robot: SimulatedRobot) -> dict[str, float]:
    return {joint.name: robot.joint(joint.name) for joint in robot.body.joints}
