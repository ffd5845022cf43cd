"""Simulated devices of all kinds: they act in the world of the simulated robot, with noise, delay and faults."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from math import inf, isfinite, radians
from random import Random

from btlang.devices.driver import SIMULATED, Device, DeviceError, DeviceSilent
from btlang.devices.kinds import (
    KINDS,
    Charge,
    Command,
    Distance,
    Grip,
    GripTarget,
    Image,
    JointState,
    JointTarget,
    Measured,
    Motion,
    Play,
    Playing,
    Pressed,
    Reading,
    Scan,
    Sound,
    Wheels,
    WheelSpeeds,
)
from btlang.devices.loop import SILENCE, check_command
from btlang.robots.bodies.body import Body
from btlang.robots.geometry import CENTRE
from btlang.robots.robot import RobotError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_WIDTH, _HEIGHT = 160, 120
_RATE = 16_000
_OPTIONS = {
    "range": ("cone", "range"), "camera": ("view",), "joint": ("part",), "hand": ("part",),
    "button": ("bumper",), "gauge": ("value",),
}  # fmt: skip


class SimulatedDevice:
    """One device. `read` and `write` are for any thread, `step` for that of the robot. Seconds are those of its world.

    Options of all kinds: `noise` (standard deviation), `delay` in seconds, `silent` and `frozen` as [from, until]. Of a
    range sensor: `cone` (degrees), `range` (metres). Of a camera: `view` (degrees). Of a joint or hand: `part`, the
    name in the body, by default that of the device. Of a button: `bumper`. Of a gauge: `value`.
    """

    def __init__(self, device: Device, robot: Any) -> None:
        self._device, self._robot = device, robot
        self._kind = KINDS[device.kind]
        known = {"noise", "delay", "silent", "frozen", *_OPTIONS.get(device.kind, ())}
        for name, value in device.options.items():
            if name not in known:
                raise DeviceError(f'unknown option "{name}" of the {device.name}; it has {", ".join(sorted(known))}')
            is_right, wanted = _VALUES.get(name, (_is_number, "a number"))
            if not is_right(value):
                raise DeviceError(f'"{name}" of the {device.name} must be {wanted}, not {value!r}')
        self._is_perfect = not {"noise", "delay", "silent", "frozen"} & set(device.options)
        self._past: deque[tuple[float, Reading]] = deque()
        self._command: Command | None = None
        self._command_time = -inf
        self._begun = 0.0
        self._at_dock = False
        self.is_pressed = False
        """Whether somebody presses this button."""
        self.measured = float(device.options.get("value", 0.0))
        """What this gauge measures."""

    @property
    def shown(self) -> Command | None:
        """The latest command: what a light or a display shows."""
        return self._command

    def read(self, name: str) -> Reading:
        """Return the latest reading. Raises DeviceSilent."""
        if self._is_perfect:
            return self._read()
        now = self._robot.time
        if self._within("silent", now):
            raise DeviceSilent(f"the {name} is silent")
        if self._within("frozen", now) and self._past:
            return self._past[-1][1]
        reading = self._with_noise(self._read(), now)
        delay = float(self._option("delay", 0.0))
        self._past.append((now, reading))
        while len(self._past) > 1 and self._past[1][0] <= now - delay:
            self._past.popleft()
        return self._past[0][1]

    @property
    def exact(self) -> Any:
        """The base around which a lidar sees everything exactly, so that there's no need to measure it; else None."""
        sees = self._is_perfect and self._device.kind == "lidar" and not self._robot.faults.scanner_silent
        return self._robot.base if sees else None

    def _read(self) -> Reading:
        try:
            return _READ[self._device.kind](self) if self._kind.reading is not None else Reading()
        except RobotError as problem:
            raise DeviceSilent(f"the {self._device.name} is silent: {problem}") from None

    def write(self, name: str, command: Command) -> None:
        """Command the device. Raises DeviceError for an invalid command."""
        check_command(name, self._device.kind, command)
        self._command, self._command_time = command, self._robot.time
        act = _WRITE.get(self._device.kind)
        if act is not None:
            act(self, command)

    def step(self) -> None:
        """Bring the device to rest if it moves and its command isn't repeated."""
        rest = self._kind.rest
        if rest is not None and self._command is not None and self._robot.time - self._command_time > SILENCE:
            self._command = None
            _WRITE[self._device.kind](self, rest)

    def silent(self, name: str) -> str | None:
        """Return why it is silent."""
        return "it is switched off in the robot file" if self._within("silent", self._robot.time) else None

    def _option(self, name: str, usual: Any) -> Any:
        return self._device.options.get(name, usual)

    @property
    def _part(self) -> str:
        return str(self._option("part", self._device.name))

    def _within(self, fault: str, now: float) -> bool:
        begin, end = self._option(fault, (inf, inf))
        return bool(begin <= now < end)

    def _with_noise(self, reading: Reading, now: float) -> Reading:
        noise = float(self._option("noise", 0.0))
        if not noise:
            return reading
        chance = Random(f"{self._device.name} {now}")  # so that it doesn't depend on who else looks
        if isinstance(reading, Scan):
            return Scan([each + chance.gauss(0, noise) for each in reading.ranges], reading.start, reading.step)
        names = (*self._kind.scaled, *self._kind.shifted)
        changed = {name: getattr(reading, name) + chance.gauss(0, noise) for name in names}
        noisy: Reading = reading.replace(**changed)
        return noisy

    def _distance(self) -> Distance:
        angle, cone = self._device.angle, float(self._option("cone", 15.0))
        ranges = self._robot.scan()
        beams = range(round(angle - cone / 2), round(angle + cone / 2) + 1)
        nearest = min(float(ranges[beam % 360]) for beam in beams) - self._robot.radius  # it sits on the rim
        return Distance(nearest if nearest <= float(self._option("range", 4.0)) else inf)

    def _scan(self) -> Scan:
        from btlang.robots.worlds.scan import as_measured  # brings numpy

        scanner = self._robot.body.sensor("scanner")
        ranges: Any = as_measured(self._robot.scan(), CENTRE if scanner is None else scanner.pose)
        return Scan(ranges)

    def _wheels(self) -> Wheels:
        linear, angular = self._robot.velocity
        side = radians(angular) * self._gap / 2
        left, right = self._robot.wheels
        return Wheels(left, right, linear - side, linear + side)

    @property
    def _gap(self) -> float:
        base = self._robot.body.base
        return float(base.wheel_gap) if base is not None else 1.0

    def _roll(self, command: Command) -> None:
        assert isinstance(command, WheelSpeeds)
        turn = (command.right - command.left) / self._gap
        self._robot.drive((command.left + command.right) / 2, turn / radians(1))

    def _motion(self) -> Motion:
        return Motion(self._robot.velocity[1], up=9.81, heading=self._robot.pose.heading)

    def _charge(self) -> Charge:
        was_at_dock, self._at_dock = self._at_dock, self._robot.power.is_near_dock(self._robot.pose)
        if self._at_dock and not was_at_dock:
            with suppress(RobotError):  # its contacts touch those of the dock when it comes there
                self._robot.dock()
        return Charge(self._robot.battery, charging=self._robot.charging)

    def _joint(self) -> JointState:
        return JointState(self._robot.joint(self._part), temperature=30.0)

    def _bend(self, command: Command) -> None:
        assert isinstance(command, JointTarget)
        if command.position is None:
            self._robot.freeze_joints(self._part)
        else:
            self._robot.move_joints({self._part: command.position})

    def _grip(self) -> Grip:
        held = self._robot.holding(self._part.split()[0]) is not None
        closed = self._command.closed if isinstance(self._command, GripTarget) else None
        return Grip(float(held) if closed is None else closed, held)

    def _close_hand(self, command: Command) -> None:
        assert isinstance(command, GripTarget)
        hand = self._part.split()[0]
        try:
            if command.closed is not None and command.closed >= 0.5 and self._robot.holding(hand) is None:
                self._robot.grasp(hand)
            elif command.closed is not None and command.closed < 0.5 and self._robot.holding(hand) is not None:
                self._robot.release(hand)
        except RobotError:  # it closes on nothing
            pass

    def _image(self) -> Image:
        """Return an image of what the scanner sees, as walls that are darker and lower the farther they are."""
        import numpy as np  # most missions need none

        view, angle = float(self._option("view", 60.0)), self._device.angle
        ranges = np.asarray(self._robot.scan())
        columns = np.arange(_WIDTH)
        bearings = angle + view / 2 - columns * view / _WIDTH
        distances = ranges[np.round(bearings).astype(int) % 360] * np.cos(np.radians(bearings - angle))
        halves = np.clip(_HEIGHT / 2 / np.maximum(distances, 0.3), 0, _HEIGHT / 2)
        rows = np.abs(np.arange(_HEIGHT)[:, None] - _HEIGHT / 2)
        shade = np.clip(255 / (1 + distances / 3), 30, 255)
        grey = np.where(rows <= halves[None, :], shade[None, :], np.where(np.arange(_HEIGHT)[:, None] < 60, 235, 90))
        pixels = np.repeat(grey.astype(np.uint8)[:, :, None], 3, axis=2)
        return Image(_WIDTH, _HEIGHT, pixels.tobytes())

    def _sound(self) -> Sound:
        now = self._robot.time
        count, self._begun = int((now - self._begun) * _RATE), now
        return Sound(bytes(2 * min(count, _RATE)), _RATE)

    def _playing(self) -> Playing:
        command = self._command
        length = len(command.samples) / 2 / command.rate if isinstance(command, Play) else 0.0
        return Playing(max(0.0, length - (self._robot.time - self._command_time)))

    def _pressed(self) -> Pressed:
        return Pressed(self._robot.bumped if self._option("bumper", False) else self.is_pressed)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _is_span(value: object) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))


_VALUES: dict[str, tuple[Callable[[Any], bool], str]] = {
    "silent": (_is_span, "[from, until] in seconds"),
    "frozen": (_is_span, "[from, until] in seconds"),
    "part": (lambda value: isinstance(value, str), "a name"),
    "bumper": (lambda value: isinstance(value, bool), "true or false"),
}
"""The valid values of options that aren't numbers."""
_READ: dict[str, Callable[[SimulatedDevice], Reading]] = {
    "range": SimulatedDevice._distance,
    "lidar": SimulatedDevice._scan,
    "drive": SimulatedDevice._wheels,
    "imu": SimulatedDevice._motion,
    "battery": SimulatedDevice._charge,
    "joint": SimulatedDevice._joint,
    "hand": SimulatedDevice._grip,
    "camera": SimulatedDevice._image,
    "microphone": SimulatedDevice._sound,
    "speaker": SimulatedDevice._playing,
    "button": SimulatedDevice._pressed,
    "gauge": lambda device: Measured(device.measured),
}
_WRITE: dict[str, Callable[[SimulatedDevice, Command], None]] = {
    "drive": SimulatedDevice._roll,
    "joint": SimulatedDevice._bend,
    "hand": SimulatedDevice._close_hand,
}


def twins(body: Body) -> tuple[Device, ...]:
    """Return a simulated device for each device of the body, and for each part without a device."""
    made = {device.name: twin(device) for device in body.devices}
    kinds = {device.kind for device in body.devices}
    parts = [
        ("drive", body.base),
        ("lidar", body.sensor("scanner")),
        ("battery", body.battery),
        ("display", body.screen),
    ]
    for kind, part in parts:
        if part and kind not in kinds:
            made.setdefault(kind, Device(kind, kind, SIMULATED))
    if body.sensor("bumper") is not None and not any(each.kind == "button" for each in body.devices):
        made["bumper"] = Device("bumper", "button", SIMULATED, options={"bumper": True})
    for joint in body.joints:
        made.setdefault(joint.name, Device(joint.name, "joint", SIMULATED))
    for hand in body.hands:
        made.setdefault(f"{hand.name} hand", Device(f"{hand.name} hand", "hand", SIMULATED))
    return tuple(made.values())


def twin(device: Device) -> Device:
    """Return a simulated device in place of another one. Of the options of its driver those of its kind count."""
    if device.driver == SIMULATED:
        return device
    usual = {"bumper": True} if device.kind == "button" and "bumper" in device.name else {}
    given = {name: device.options[name] for name in _OPTIONS.get(device.kind, ()) if name in device.options}
    options = usual | {name: value for name, value in given.items() if _VALUES.get(name, (_is_number, ""))[0](value)}
    return Device(device.name, device.kind, SIMULATED, options=options, angle=device.angle)
