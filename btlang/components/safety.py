"""The gate before the wheels: it slows down for what distance sensors see, and stops where a bumper is pressed."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, radians, sqrt

from btlang.devices.device_set import Reads
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Distance, Pressed
from btlang.record import Record
from btlang.robots.body import Body

_MARGIN = 0.05  # metres that stay free
_AHEAD = 60.0  # degrees: sensors that look farther aside say nothing about the way


class Guard(Record):
    """A device that the gate asks: a distance sensor or bumper, `angle` degrees left of ahead."""

    name: str
    device: Reads
    angle: float = 0.0


class Safety:
    """Limits velocities, in metres and degrees a second. A guard that is silent counts as one that warns."""

    def __init__(self, guards: Sequence[Guard], body: Body) -> None:
        self._guards, self._body = guards, body
        self.reason = ""
        """Why it held the robot back at the latest look; "" where it didn't."""

    def limited(self, linear: float, angular: float, pressed: bool = False) -> tuple[float, float]:
        """What of a velocity is safe; turning on the spot always is, and so is driving away from what is near."""
        self.reason = "a bumper is pressed" if pressed and linear > 0.0 else ""
        if linear == 0.0:
            return linear, angular
        most = 0.0 if self.reason else abs(linear)
        for guard in self._guards:
            ahead = cos(radians(guard.angle)) * linear > 0.0 and abs(cos(radians(guard.angle))) >= cos(radians(_AHEAD))
            if ahead:
                most = min(most, self._safe_speed(guard))
        return (most if linear > 0.0 else -most), angular

    def _safe_speed(self, guard: Guard) -> float:
        """From which it can still brake before what the guard sees."""
        try:
            reading = guard.device.read(guard.name)
        except DeviceError as problem:
            self.reason = str(problem)
            return 0.0
        if isinstance(reading, Pressed):
            if reading.pressed:
                self.reason = f"the {guard.name} is pressed"
            return 0.0 if reading.pressed else float("inf")
        if not isinstance(reading, Distance) or not isfinite(reading.distance):
            return float("inf")
        free = reading.distance - _MARGIN
        if free <= 0.0:
            self.reason = f"the {guard.name} sees something {reading.distance:.2f} m away"
            return 0.0
        return sqrt(2 * self._body.driving.brake * free)
