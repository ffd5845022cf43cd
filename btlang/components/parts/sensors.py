"""The sensors of a robot over its devices: readings for the guard, a scan, and the angles of servos."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

from btlang.devices.device_set import DeviceSet, Reads, reader
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Distance, JointState, Pressed, Scan
from btlang.robots.bodies.body import Body, Sensor
from btlang.robots.geometry import CENTRE
from btlang.robots.motion.guard.readings import ContactReading, ObstacleReading, RangeReading, ScanReading
from btlang.robots.robot import joint_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.scan import Array


class DeviceSensors:
    """The distance sensors, the `bumpers` and the lidar of a robot. The lidar is where the `scanner` of its body is."""

    def __init__(
        self, devices: DeviceSet, bumpers: Sequence[str], lidar: str, scanner: Sensor | None, radius: float
    ) -> None:
        self._readers, self._lidar, self._radius = devices.readers, lidar, radius
        self._scanner = scanner or Sensor("scanner", "")
        self._near = [device for name, device in devices.devices.items() if device.kind == "range" or name in bumpers]
        # the latest scan, around the centre, and its summary
        self._seen: tuple[Scan, Array, float, float] | None = None

    def scan(self) -> Array:
        """Return the distances around the centre, as Sensors does. Raises DeviceSilent."""
        return self._look()[0]

    def readings(self, now: float) -> list[ObstacleReading]:
        """Return the readings for the guard."""
        found = [self._reading(device.name, device.angle, now) for device in self._near]
        if self._lidar:
            view, angle = self._scanner.view, self._scanner.angle
            if (exact := getattr(self._readers[self._lidar], "exact", None)) is not None:
                return [
                    *found,
                    ScanReading("scanner", now, "", self.scan, view, angle, exact.room, inf, exact.free_way),
                ]
            try:
                _, room, content = self._look()
            except DeviceError as problem:
                found.append(ScanReading("scanner", now, str(problem), self.scan, view, angle))
            else:
                found.append(ScanReading("scanner", now, "", self.scan, view, angle, room, content))
        return found

    def _reading(self, name: str, angle: float, now: float) -> ObstacleReading:
        try:
            reading = self._readers[name].read(name)
        except DeviceError as problem:
            return RangeReading(name, now, str(problem), inf, angle)
        if isinstance(reading, Pressed):
            return ContactReading(name, now, "", reading.pressed, angle)
        assert isinstance(reading, Distance)
        return RangeReading(name, now, "", reading.distance, angle)

    def _look(self) -> tuple[Array, float, float]:
        reading = reader(self._readers, self._lidar, "lidar").read(self._lidar)
        assert isinstance(reading, Scan)
        if self._seen is None or self._seen[0] is not reading:
            import numpy as np  # most missions need none

            from btlang.robots.worlds.scan import around, summary

            ranges = np.array(reading.ranges, dtype=np.float64)
            ranges[ranges == -inf] = 0.0  # too close to be measured
            ranges[ranges < 0.0] = np.nan
            angles = np.radians(reading.start + reading.step * np.arange(len(ranges)))
            found = around(ranges, angles, self._scanner.pose if self._scanner.frame else CENTRE, abs(reading.step))
            self._seen = reading, found, *summary(found, self._radius)
        return self._seen[1:]


def servo_angle(body: Body, devices: Mapping[str, Reads], name: str) -> float:
    """Return the angle of a joint, as its servo measures it. Raises RobotError for an unknown
    joint, and DeviceSilent.
    """
    reading = reader(devices, joint_of(body, name).name, name).read(name)
    assert isinstance(reading, JointState)
    return reading.position
