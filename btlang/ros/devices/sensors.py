"""The messages of devices that only measure: distances, motion, charge, buttons and pictures."""

from __future__ import annotations

from array import array
from math import degrees, hypot, inf, isnan, nan, radians

import numpy as np
from sensor_msgs.msg import BatteryState, Imu, LaserScan, Range
from sensor_msgs.msg import Image as ImageMessage
from std_msgs.msg import Bool

from btlang.devices import kinds
from btlang.devices.driver import DeviceSilent
from btlang.devices.kinds import Reading
from btlang.ros.devices.translation import Translation, number
from btlang.ros.messages import echoes, set_yaw, yaw_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_UNKNOWN = -1.0  # the first covariance of what an inertial unit doesn't measure
_MOST_PIXELS = 50_000_000
_CHARGES = (BatteryState.POWER_SUPPLY_STATUS_CHARGING, BatteryState.POWER_SUPPLY_STATUS_FULL)


class RangeTranslation(Translation):
    """A range sensor as Range: -inf is too close to be measured, inf means that nothing is in range (REP 117)."""

    reads = Range

    def _read(self, message: Any) -> Reading:
        distance = message.range
        if distance == -inf:
            return kinds.Distance(max(0.0, message.min_range))
        seen = message.max_range > message.min_range and distance > message.max_range
        return kinds.Distance(inf if seen else number(distance, "range"))

    def shown(self, reading: Any) -> Any:
        return Range(
            radiation_type=Range.ULTRASOUND, max_range=self._setting.range or inf, range=float(reading.distance)
        )


class LidarTranslation(Translation):
    """A scanner as LaserScan; a beam without a measurement is NaN."""

    reads = LaserScan

    def _read(self, message: Any) -> Reading:
        return kinds.Scan(echoes(message).tolist(), degrees(message.angle_min), degrees(message.angle_increment))

    def shown(self, reading: Any) -> Any:
        count, step = len(reading.ranges), radians(reading.step)
        start = radians(reading.start)
        return LaserScan(
            angle_min=start, angle_max=start + step * (count - 1), angle_increment=step,
            range_max=self._setting.range, ranges=array("f", reading.ranges),
        )  # fmt: skip


class ImuTranslation(Translation):
    """An Imu with angular velocity and acceleration; its orientation is only the heading."""

    reads = Imu

    def _read(self, message: Any) -> Reading:
        turning, acceleration = message.angular_velocity.z, message.linear_acceleration
        q = message.orientation
        known = message.linear_acceleration_covariance[0] != _UNKNOWN
        faces = message.orientation_covariance[0] != _UNKNOWN and abs(hypot(q.x, q.y, q.z, q.w) - 1.0) < 0.05
        ahead, left, up = (
            number(value, "acceleration") if known else None
            for value in (acceleration.x, acceleration.y, acceleration.z)
        )
        heading = degrees(yaw_of(q)) if faces else None
        return kinds.Motion(degrees(number(turning, "angular velocity")), ahead, left, up, heading)

    def shown(self, reading: Any) -> Any:
        message = Imu()
        message.angular_velocity.z = radians(reading.turning)
        accelerations = reading.ahead, reading.left, reading.up
        if all(each is None for each in accelerations):
            message.linear_acceleration_covariance[0] = _UNKNOWN
        else:
            x, y, z = (float(each or 0.0) for each in accelerations)
            message.linear_acceleration.x, message.linear_acceleration.y, message.linear_acceleration.z = x, y, z
        if reading.heading is None:
            message.orientation_covariance[0] = _UNKNOWN
        else:
            set_yaw(message.orientation, radians(reading.heading))
        return message


class BatteryTranslation(Translation):
    """A BatteryState; `percentage` is from 0 to 1, and what isn't measured is NaN."""

    reads = BatteryState

    def _read(self, message: Any) -> Reading:
        if not 0.0 <= message.percentage <= 1.0:
            raise DeviceSilent(f"it gives no percentage from 0 to 1, but {message.percentage:g}")
        status = message.power_supply_status
        charging = None if status == BatteryState.POWER_SUPPLY_STATUS_UNKNOWN else status in _CHARGES
        others = (message.voltage, message.current, message.temperature)
        volts, amperes, temperature = (None if isnan(value) else value for value in others)
        return kinds.Charge(100.0 * message.percentage, volts, amperes, temperature, charging)

    def shown(self, reading: Any) -> Any:
        message = BatteryState(percentage=reading.percent / 100, present=True)
        message.charge = message.capacity = message.design_capacity = nan
        for name, value in (
            ("voltage", reading.volts), ("current", reading.amperes), ("temperature", reading.temperature)
        ):  # fmt: skip
            setattr(message, name, nan if value is None else float(value))
        if reading.charging is not None:
            states = BatteryState.POWER_SUPPLY_STATUS_DISCHARGING, BatteryState.POWER_SUPPLY_STATUS_CHARGING
            message.power_supply_status = states[bool(reading.charging)]
        return message


class ButtonTranslation(Translation):
    """A Bool: whether the button is pressed."""

    reads = Bool

    def _read(self, message: Any) -> Reading:
        return kinds.Pressed(bool(message.data))

    def shown(self, reading: Any) -> Any:
        return Bool(data=bool(reading.pressed))


class CameraTranslation(Translation):
    """An Image: rgb8, bgr8 and mono8 can be read, rgb8 is published."""

    reads = ImageMessage

    def _read(self, message: Any) -> Reading:
        width, height, depth = message.width, message.height, 1 if message.encoding == "mono8" else 3
        if message.encoding not in ("rgb8", "bgr8", "mono8"):
            raise DeviceSilent(f"its pictures are in {message.encoding[:20]}, not in rgb8, bgr8 or mono8")
        row = max(message.step, width * depth)
        if not 0 < width * height <= _MOST_PIXELS or len(message.data) < row * height:
            raise DeviceSilent(f"a picture of {width} x {height} pixels has {len(message.data)} bytes")
        rows = np.frombuffer(message.data, np.uint8, row * height).reshape(height, row)[:, : width * depth]
        pixels = rows.reshape(height, width, depth)[:, :, ::-1] if message.encoding == "bgr8" else rows
        return kinds.Image(width, height, (np.repeat(pixels, 3, axis=1) if depth == 1 else pixels).tobytes())

    def shown(self, reading: Any) -> Any:
        return ImageMessage(
            width=reading.width, height=reading.height, encoding="rgb8", step=3 * reading.width,
            data=array("B", reading.pixels),
        )  # fmt: skip
