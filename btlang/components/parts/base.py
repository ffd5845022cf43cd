"""The base over devices: odometry from the encoders, and limited acceleration."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, degrees, hypot, inf, radians, sin

from btlang.devices.device_set import Reads, reader
from btlang.devices.driver import DeviceError, DeviceSilent
from btlang.devices.kinds import Motion, Pressed, Wheels, WheelSpeeds
from btlang.robots.bodies.body import Body
from btlang.robots.geometry import Pose, wrap
from btlang.robots.motion.guard.guard import FASTEST
from btlang.robots.simulation.base import clip_speed, limit_value, step_towards

_STUCK_AFTER = 2.0  # seconds: a faster base the guard stops before, with what the odometry shows
_REST = 0.002  # metres a second: less is noise of the encoders
_FREE_AGAIN = 0.03
_JUMP = 1.0  # metres


class DeviceBase:
    """A base over devices, as a BasePart. `drive` and `brake` may be called from any thread.

    `wheels`, `imu` and `bumpers` are names of devices. The heading is that of the inertial unit if there is one.
    Without readings of the wheels it commands them to stand, and the pose isn't known. `locate` returns where it really
    is, if anything knows that better than the wheels; `advance` steps simulated devices.
    """

    grips = (1.0, 1.0)

    def __init__(
        self,
        pose: Pose,
        body: Body,
        devices: Mapping[str, Reads],
        *,
        wheels: str,
        imu: str = "",
        bumpers: tuple[str, ...] = (),
        locate: Callable[[], Pose] | None = None,
        advance: Callable[[float], object] = lambda seconds: None,
    ) -> None:
        self._pose, self.body = pose, body
        self._devices, self._drive, self._imu, self._bumpers = devices, wheels, imu, bumpers
        self._locate, self._advance = locate, advance
        self._gap = body.base.wheel_gap if body.base is not None else 1.0
        self.travelled, self.wheels = 0.0, (0.0, 0.0)
        self.bumps, self.bumped_into = 0, ""
        self.commanded = self._speeds = (0.0, 0.0)
        self.limits = inf, inf
        self._velocity: tuple[float, float] | None = None
        self._seen: Wheels | None = None
        self._heading: float | None = None
        self._pressed: set[str] = set()
        self._contact: Pose | None = None
        self._jump = ""
        self._idle = 0.0

    @property
    def pose(self) -> Pose:
        """The pose, or the last one that was known."""
        return self._pose

    @property
    def velocity(self) -> tuple[float, float]:
        """The measured metres and degrees a second, 0 if nobody knows."""
        return self._velocity or (0.0, 0.0)

    @property
    def silent(self) -> str | None:
        """Why its pose and motion aren't known, None if they are."""
        try:
            self._read()
        except DeviceError as problem:
            return str(problem)
        return self._jump or None

    @property
    def bumped(self) -> bool:
        """Whether a bumper is pressed, or was and it hasn't moved away yet."""
        return bool(self._pressed) or self._contact is not None

    @property
    def stuck(self) -> bool:
        """Whether it has been commanded to move for a second and doesn't."""
        return self._idle >= _STUCK_AFTER

    @property
    def rolling(self) -> bool:
        """Whether it isn't at rest yet; True also if nobody knows."""
        return self._velocity is None or self._velocity != (0.0, 0.0)

    def drive(self, linear: float, angular: float) -> None:
        """Set the wanted velocity, within the limits."""
        driving, turning = self.body.driving, self.body.turning
        self.commanded = clip_speed(linear, driving.top_speed), clip_speed(angular, turning.top_speed)
        if self.commanded == (0.0, 0.0):
            self._idle = 0.0

    def brake(self) -> None:
        """Command the wheels to stand at once."""
        self.commanded = self._speeds = (0.0, 0.0)
        self._idle = 0.0
        self._write(WheelSpeeds())

    def put(self, pose: Pose) -> None:
        """Set the pose, from somebody who knows it."""
        self._pose, self._contact = pose, None

    def step(self, dt: float) -> None:
        """Command the wheels for the next `dt` seconds, and read how far they have rolled."""
        self._command(dt)
        self._advance(dt)
        try:
            wheels = self._read()
            self._check_jump(wheels, dt)
        except DeviceError:
            self._seen = self._velocity = None
            self._speeds = (0.0, 0.0)
            return
        before = self._pose
        self._move(wheels)
        if self._locate is not None:
            self._pose = self._locate()
        self._feel()
        wanted = min(self.limits[0], abs(self.commanded[0]))
        wanted += self.body.radius * radians(min(self.limits[1], abs(self.commanded[1])))
        way = before.distance_to((self._pose.x, self._pose.y))
        turn = abs(wrap(self._pose.heading - before.heading))
        moved = way + self.body.radius * radians(turn)
        self._idle = self._idle + dt if moved < 0.05 * wanted * dt else 0.0

    def _command(self, dt: float) -> None:
        driving, turning = self.body.driving, self.body.turning
        wanted = tuple(limit_value(value, most) for value, most in zip(self.commanded, self.limits, strict=True))
        linear = step_towards(self._speeds[0], wanted[0], driving.acceleration * dt, driving.brake * dt)
        angular = step_towards(self._speeds[1], wanted[1], turning.acceleration * dt, turning.brake * dt)
        if self._velocity is None:
            linear = angular = 0.0
        self._speeds = linear, angular
        side = radians(angular) * self._gap / 2
        self._write(WheelSpeeds(linear - side, linear + side))

    def _read(self) -> Wheels:
        wheels = reader(self._devices, self._drive, "base").read(self._drive)
        assert isinstance(wheels, Wheels)
        return wheels

    def _check_jump(self, wheels: Wheels, dt: float) -> None:
        """Raise DeviceSilent if the wheels have rolled farther than any can, for example because their board has
        restarted.
        """
        before = self._seen or wheels
        way = max(abs(wheels.left - before.left), abs(wheels.right - before.right))
        self._jump = f"the {self._drive} jumps by {way:.3g} m" if way > _JUMP + FASTEST * dt else ""
        if self._jump:
            raise DeviceSilent(self._jump)

    def _write(self, speeds: WheelSpeeds) -> None:
        if self._drive in self._devices:
            self._devices[self._drive].write(self._drive, speeds)

    def _move(self, wheels: Wheels) -> None:
        before, self._seen = self._seen or wheels, wheels
        left, right = wheels.left - before.left, wheels.right - before.right
        way, turn = (left + right) / 2, degrees((right - left) / self._gap)
        turn = self._turn(turn)
        middle = radians(self._pose.heading + turn / 2)
        pose = self._pose
        self._pose = Pose(pose.x + way * cos(middle), pose.y + way * sin(middle), wrap(pose.heading + turn))
        self.travelled += abs(way)
        self.wheels = wheels.left, wheels.right
        speed = (wheels.left_speed + wheels.right_speed) / 2
        spin = degrees((wheels.right_speed - wheels.left_speed) / self._gap)
        still = hypot(wheels.left_speed, wheels.right_speed) < _REST
        self._velocity = (0.0, 0.0) if still else (speed, spin)

    def _turn(self, by_wheels: float) -> float:
        """Return the degrees since the last step, by the inertial unit if it measures a heading."""
        if not self._imu:
            return by_wheels
        try:
            motion = self._devices[self._imu].read(self._imu)
        except DeviceError:
            self._heading = None
            return by_wheels
        assert isinstance(motion, Motion)
        before, self._heading = self._heading, motion.heading
        return by_wheels if before is None or motion.heading is None else wrap(motion.heading - before)

    def _feel(self) -> None:
        for name in self._bumpers:
            try:
                reading = self._devices[name].read(name)
            except DeviceError:
                continue  # the guard lets nobody drive by a bumper that is silent
            if isinstance(reading, Pressed) and reading.pressed and name not in self._pressed:
                self._pressed.add(name)
                self.bumps, self.bumped_into, self._contact = self.bumps + 1, "something", self._pose
            elif isinstance(reading, Pressed) and not reading.pressed:
                self._pressed.discard(name)
        if self._contact is not None and self._contact.distance_to((self._pose.x, self._pose.y)) > _FREE_AGAIN:
            self._contact = None
