"""The messages of devices that act: wheels, joints, hands, speakers, lights and displays."""

from __future__ import annotations

from array import array
from math import cos, degrees, isfinite, isnan, nan, radians, sin

import numpy as np
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_msgs.msg import ColorRGBA, Float64, Int16MultiArray, MultiArrayDimension, String
from trajectory_msgs.msg import JointTrajectory

from btlang.devices import kinds
from btlang.devices.driver import DeviceError, DeviceSilent
from btlang.devices.kinds import Command, Reading
from btlang.robots.geometry import Pose, wrap
from btlang.ros.devices.setting import Setting
from btlang.ros.devices.translation import Translation, number
from btlang.ros.messages import BASE, ODOM, pose_message, pose_of, seconds_of, trajectory, velocity

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_RATE = "rate"


class DriveTranslation(Translation):
    """A base as Odometry and Twist; the distances that its wheels have rolled follow from their gap, and back."""

    reads, takes = Odometry, Twist

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting)
        self._pose: Pose | None = None
        self._wheels = 0.0, 0.0

    def reading(self, message: Any) -> Reading:
        """Implement Translation. A jump of the pose doesn't count as rolled."""
        try:
            return super().reading(message)
        except DeviceSilent:
            self._pose = None
            raise

    def _read(self, message: Any) -> Reading:
        pose = pose_of(message.pose.pose)
        before, self._pose = self._pose or pose, pose
        turn = wrap(pose.heading - before.heading)
        middle = radians(before.heading + turn / 2)
        way = (pose.x - before.x) * cos(middle) + (pose.y - before.y) * sin(middle)
        side = radians(turn) * self._setting.wheel_gap / 2
        self._wheels = self._wheels[0] + way - side, self._wheels[1] + way + side
        return kinds.Wheels(*self._wheels, *self._sides(message.twist.twist))

    def shown(self, reading: Any) -> Any:
        """Implement Translation. The pose counts from the first reading."""
        gap, wheels = self._setting.wheel_gap, (reading.left, reading.right)
        pose, before = self._pose or Pose(0.0, 0.0, 0.0), self._wheels if self._pose is not None else wheels
        left, right = wheels[0] - before[0], wheels[1] - before[1]
        way, turn = (left + right) / 2, degrees((right - left) / gap)
        middle = radians(pose.heading + turn / 2)
        self._wheels = wheels
        self._pose = Pose(pose.x + way * cos(middle), pose.y + way * sin(middle), wrap(pose.heading + turn))
        message = Odometry(child_frame_id=BASE)
        message.pose.pose = pose_message(self._pose)
        message.twist.twist.linear.x = (reading.left_speed + reading.right_speed) / 2
        message.twist.twist.angular.z = (reading.right_speed - reading.left_speed) / gap
        message.header.frame_id = ODOM
        return message

    def sent(self, command: Any) -> Any:
        turn = (command.right - command.left) / self._setting.wheel_gap
        return velocity(Twist, (command.left + command.right) / 2, turn, None)

    def command(self, message: Any) -> Command:
        if not isfinite(message.linear.x) or not isfinite(message.angular.z):
            raise DeviceError("a velocity that is not finite")
        return kinds.WheelSpeeds(*self._sides(message))

    def _sides(self, twist: Any) -> tuple[float, float]:
        """Return the metres a second of each wheel."""
        side = twist.angular.z * self._setting.wheel_gap / 2
        return twist.linear.x - side, twist.linear.x + side


class JointTranslation(Translation):
    """A joint among those of JointState; a JointTrajectory without points lets it stay where it is."""

    reads, takes = JointState, JointTrajectory

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting)
        self._at = 0.0

    def concerns(self, message: Any) -> bool:
        """Implement Translation. A robot may report its limbs in separate messages."""
        return self._setting.joint in message.name

    def _read(self, message: Any) -> Reading:
        if not self.concerns(message):
            raise DeviceSilent(f'it doesn\'t report the joint "{self._setting.joint}"')
        index, si = list(message.name).index(self._setting.joint), self._setting.si
        if index >= len(message.position):
            raise DeviceSilent("it gives no position")
        self._at = number(message.position[index], "position") / si
        speed = message.velocity[index] if index < len(message.velocity) else 0.0
        return kinds.JointState(self._at, 0.0 if isnan(speed) else speed / si)

    def shown(self, reading: Any) -> Any:
        self._at, si = reading.position, self._setting.si
        return JointState(
            name=[self._setting.joint], position=[float(reading.position * si)], velocity=[float(reading.speed * si)]
        )

    def sent(self, command: Any) -> Any:
        if command.position is None or command.loose:
            return JointTrajectory(joint_names=[self._setting.joint])
        seconds = abs(command.position - self._at) / command.speed if command.speed else 0.0
        return trajectory({self._setting.joint: command.position * self._setting.si}, seconds)

    def command(self, message: Any) -> Command:
        if message.joint_names and self._setting.joint not in message.joint_names:
            raise DeviceError(f'it has nothing for the joint "{self._setting.joint}"')
        if not message.points:
            return kinds.JointTarget()
        point, index = message.points[-1], list(message.joint_names).index(self._setting.joint)
        position = number(point.positions[index], "position") / self._setting.si
        seconds = seconds_of(point.time_from_start)
        return kinds.JointTarget(position, abs(position - self._at) / seconds if seconds > 0.0 else None)


class HandTranslation(Translation):
    """A JointState whose position is how far the hand is closed, 0 to 1; its effort is 1 if
    the hand holds something.
    """

    reads, takes = JointState, Float64

    def _read(self, message: Any) -> Reading:
        if not message.position:
            raise DeviceSilent("it gives no position")
        effort = message.effort[0] if message.effort else nan
        return kinds.Grip(number(message.position[0], "position"), None if isnan(effort) else effort >= 0.5)

    def shown(self, reading: Any) -> Any:
        effort = [] if reading.holds is None else [float(reading.holds)]
        return JointState(name=[self._setting.joint], position=[float(reading.closed)], effort=effort)

    def sent(self, command: Any) -> Any:
        """Implement Translation. NaN means that the hand stays as it is."""
        return Float64(data=nan if command.closed is None else float(command.closed))

    def command(self, message: Any) -> Command:
        return kinds.GripTarget(None if isnan(message.data) else min(1.0, max(0.0, message.data)))


class MicrophoneTranslation(Translation):
    """Sound of 16 bits; the size of the second dimension, "rate", is the number of samples a second."""

    reads = Int16MultiArray

    def _read(self, message: Any) -> Reading:
        return kinds.Sound(*_samples(message))

    def shown(self, reading: Any) -> Any:
        return _sound(reading)


class SpeakerTranslation(Translation):
    """The seconds that it still has to play, and the sound to play, in the message type of a microphone."""

    reads, takes = Float64, Int16MultiArray

    def _read(self, message: Any) -> Reading:
        return kinds.Playing(number(message.data, "time"))

    def shown(self, reading: Any) -> Any:
        return Float64(data=float(reading.left))

    def sent(self, command: Any) -> Any:
        return _sound(command)

    def command(self, message: Any) -> Command:
        return kinds.Play(*_samples(message))


class LightTranslation(Translation):
    """A colour, each part from 0 to 1; `a` is 1."""

    takes = ColorRGBA

    def sent(self, command: Any) -> Any:
        return ColorRGBA(r=float(command.red), g=float(command.green), b=float(command.blue), a=1.0)

    def command(self, message: Any) -> Command:
        return kinds.Colour(*(min(1.0, max(0.0, number(each, "colour"))) for each in (message.r, message.g, message.b)))


class DisplayTranslation(Translation):
    """The text that it shows."""

    takes = String

    def sent(self, command: Any) -> Any:
        return String(data=command.text)

    def command(self, message: Any) -> Command:
        return kinds.Shown(message.data)


def _samples(message: Any) -> tuple[bytes, int]:
    rate = next((each.size for each in message.layout.dim if each.label == _RATE), 0)
    if not 1000 <= rate <= 200_000:
        raise DeviceSilent('its sound has no dimension "rate" with the samples a second')
    return np.asarray(message.data, dtype="<i2").tobytes(), int(rate)


def _sound(sound: Any) -> Any:
    message = Int16MultiArray(data=array("h", np.frombuffer(sound.samples, "<i2").astype(np.int16).tobytes()))
    count = len(message.data)
    samples = MultiArrayDimension(label="samples", size=count, stride=count)
    message.layout.dim = [samples, MultiArrayDimension(label=_RATE, size=sound.rate)]
    return message
