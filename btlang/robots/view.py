"""What the sensors of a simulated robot have in view."""

from __future__ import annotations

from collections.abc import Callable

from btlang.robots.body import Body, Sensor
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.obstacles import Obstacles


class View:
    """The sensors of a body that recognise people and objects. Walls and closed doors hide what is behind them.

    `joint` says where a joint of the robot stands, in degrees.
    """

    def __init__(self, obstacles: Obstacles, body: Body, joint: Callable[[str], float]) -> None:
        self._sensors = [sensor for sensor in body.sensors if sensor.recognizes]
        self._obstacles, self._joint = obstacles, joint

    def point(self, name: str, pose: Pose) -> Point | None:
        """Where something is that a robot at this pose has in view; None for what it hasn't."""
        point = self._obstacles.point(name)
        return point if point is not None and self._has(point, pose) else None

    def _has(self, point: Point, pose: Pose) -> bool:
        for sensor in self._sensors:
            eye = pose
            if sensor.ahead or sensor.left:
                eye = Pose(*pose.ahead(sensor.ahead, sensor.left), pose.heading)
            if (
                eye.distance_to(point) <= sensor.recognizes
                and self._covers(sensor, eye.bearing_to(point))
                and not self._obstacles.wall_between((eye.x, eye.y), point)
            ):
                return True
        return False

    def _covers(self, sensor: Sensor, bearing: float) -> bool:
        if sensor.view >= 360.0:
            return True
        middle = sensor.angle + (self._joint(sensor.joint) if sensor.joint else 0.0)
        return abs(wrap(bearing - middle)) <= sensor.view / 2
