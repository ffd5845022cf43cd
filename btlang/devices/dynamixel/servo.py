"""One servo as a joint: its options, how it is made ready, what it is sent in a cycle, and what its answer means."""

from __future__ import annotations

import math
from collections.abc import Sequence

from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.client import ServoClient
from btlang.devices.dynamixel.protocol import HIGHEST_ID
from btlang.devices.kinds import JointState, JointTarget
from btlang.support.record import Record

_HIGHEST_BAUD = 4_500_000
WATCHDOG_SET = round(0.2 / table.WATCHDOG_UNIT)
"""The setting of a servo's watchdog: it stops after 200 ms without an instruction on the line."""
_COOLED = 5.0  # degrees Celsius below its limit at which a hot servo may be used again
_DEGREES = 360 / table.TICKS


class ServoOptions(Record):
    """The options of a servo. `hottest` is in degrees Celsius, `low` and `high` are limits in true degrees.

    None leaves them to the servo. `baud` is that of the port: all servos on it have the same.
    """

    id: int
    reverse: bool = False
    at_end: str = "hold"
    hottest: float | None = None
    low: float | None = None
    high: float | None = None
    baud: int = 1_000_000


def read_options(device: Device) -> ServoOptions:
    """Read the options of one servo. Raises DeviceError for ones that can't be used."""
    options = dict(device.options)
    names = ServoOptions.fields
    unknown = sorted(map(str, options.keys() - set(names)))
    if unknown:
        raise DeviceError(f"the {device.name}: a Dynamixel servo has no option '{unknown[0]}', but {', '.join(names)}")
    if "id" not in options:
        raise DeviceError(f"the {device.name}: the option 'id' is missing, the number of the servo on its port")
    read = ServoOptions(**options)
    for name, is_right, wanted in (
        ("id", _is_whole(read.id, 0, HIGHEST_ID), f"a whole number from 0 to {HIGHEST_ID}"),
        ("reverse", isinstance(read.reverse, bool), "true or false"),
        ("at_end", read.at_end in ("hold", "loose"), "'hold' or 'loose'"),
        ("hottest", _is_number(read.hottest), "degrees Celsius"),
        ("low", _is_number(read.low), "degrees"),
        ("high", _is_number(read.high), "degrees"),
        ("baud", _is_whole(read.baud, 9_600, _HIGHEST_BAUD), f"a whole number from 9600 to {_HIGHEST_BAUD}"),
    ):
        if not is_right:
            raise DeviceError(f"the {device.name}: {name} is {getattr(read, name)!r}; it has to be {wanted}")
    if read.low is not None and read.high is not None and read.low >= read.high:
        raise DeviceError(f"the {device.name}: low is {read.low:g}; it has to be less than high, {read.high:g}")
    return read


def read_all(devices: Sequence[Device]) -> list[ServoOptions]:
    """Read the options of the servos on a port. Raises DeviceError if they contradict each other."""
    read = [read_options(device) for device in devices]
    users: dict[int, str] = {}
    for device, options in zip(devices, read, strict=True):
        other = users.setdefault(options.id, device.name)
        if other != device.name:
            raise DeviceError(f"the {other} and the {device.name} have the same id {options.id} on {device.port}")
        if options.baud != read[0].baud:
            bauds = f"{read[0].baud} for the {devices[0].name} and {options.baud} for the {device.name}"
            raise DeviceError(f"the port {device.port} has one baud, but the options say {bauds}")
    return read


def _is_whole(value: object, low: int, high: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def _is_number(value: object) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value))


class ServoRestarted(DeviceSilent):
    """The error that a servo has lost its settings: it was without power, or somebody else wrote to it."""


class ServoCommands(Record):
    """The values to send to a servo in a cycle; None for nothing. `watchdog`: its watchdog
    stopped it and is set again.
    """

    goal: bytes | None = None
    torque: bool | None = None
    watchdog: bool = False


class Servo:
    """A joint on a port. Only `make_ready` may be used until it has succeeded."""

    def __init__(self, device: Device, options: ServoOptions) -> None:
        self.name, self.id, self.options = device.name, options.id, options
        self._device = device
        self.where = f"servo {options.id} on {device.port}"
        self._sign = -1 if options.reverse else 1
        self.delay = 0.0
        """Seconds that it waits before it answers."""
        self._model = next(iter(table.MODELS.values()))
        self._low, self._high, self._fastest, self._hottest = 0, 0, 1, 0.0
        self._has_torque, self._is_tripped, self._is_hot = False, False, False
        self._position = table.CENTRE
        self._hold: int | None = None  # where it rests
        self._refused: DeviceError | None = None
        self._target: JointTarget | None = None
        self._orders, self._is_steady = (
            ServoCommands(),
            False,
        )  # for the target, as long as nothing happens that changes them
        self._fault: DeviceError | None = None

    @property
    def state_address(self) -> int:
        """The address of its state."""
        return self._model.indirect_data

    def make_ready(self, client: ServoClient) -> None:
        """Find the servo, check its settings and set its watchdog. If its torque is on, it stops where it is.

        Raises DeviceSilent if it doesn't answer, DeviceError if it can't be used.
        """
        found = client.ping(self.id)
        if found is None:
            raise DeviceSilent(f"{self.where} doesn't answer")
        number, firmware = found
        if number not in table.MODELS:
            known = ", ".join(model.name for model in table.MODELS.values())
            raise DeviceError(f"{self.where} is of a model that isn't known, number {number}; known: {known}")
        self._model = table.MODELS[number]
        if firmware < table.FIRST_FIRMWARE:
            wanted = f"it needs {table.FIRST_FIRMWARE} or later. Update it with the Dynamixel Wizard"
            raise DeviceError(f"{self.where} has the firmware {firmware}, but {wanted}")
        self._read_settings(client.read(self.id, 0, table.SETTINGS.size))
        client.sync_write(table.STATUS_RETURN, {self.id: b"\2"})  # until then it might not answer what is written
        if client.read(self.id, table.INDIRECT_ADDRESS, len(table.INDIRECT)) != table.INDIRECT:
            client.write(self.id, table.INDIRECT_ADDRESS, table.INDIRECT)
        client.write(self.id, table.WATCHDOG, b"\0")
        torque, _, _, _, _, self._position, _ = table.STATE.unpack(
            client.read(self.id, self.state_address, table.STATE.size)
        )
        if torque:
            client.write(self.id, table.PROFILE_VELOCITY, table.GOAL.pack(self._fastest, self._position))
        client.write(self.id, table.WATCHDOG, bytes((WATCHDOG_SET,)))
        self._has_torque, self._is_tripped, self._is_hot = bool(torque), False, False
        self._hold = self._refused = self._fault = None
        self._is_steady = False

    def orders(self, target: JointTarget | None) -> ServoCommands:
        """Return what to send for a target; None means that nobody knows what it should do."""
        if target is self._target and self._is_steady:
            return self._orders
        self._refused, self._target = None, target
        self._orders = self._make_orders(target)
        self._is_steady = self._has_torque and not self._is_tripped and self._fault is None
        return self._orders

    def _make_orders(self, target: JointTarget | None) -> ServoCommands:
        if self._fault is not None or (target is not None and target.loose):
            self._hold = None
            return ServoCommands(torque=False if self._has_torque else None, watchdog=self._is_tripped)
        if target is None:
            return ServoCommands(watchdog=self._is_tripped)
        goal, fastest = self._goal(target)
        if goal is None:
            if not self._has_torque:
                return ServoCommands(watchdog=self._is_tripped)
            if self._hold is None:
                self._hold = self._position
            return ServoCommands(table.GOAL.pack(fastest, self._hold), watchdog=self._is_tripped)
        self._hold = None
        if not self._has_torque or self._is_tripped:
            goal = self._position  # else it would leap to a goal that it had before
        return ServoCommands(table.GOAL.pack(fastest, goal), None if self._has_torque else True, self._is_tripped)

    def reading(self, state: bytes) -> JointState:
        """Return the reading in its state.

        Raises Restarted if it has to be made ready again, DeviceError if it is at fault or its commanded goal isn't
        finite.
        """
        torque, error, watchdog, load, velocity, position, temperature = table.STATE.unpack_from(state)
        if torque > 1 or watchdog not in (WATCHDOG_SET, table.WATCHDOG_TRIPPED):
            self._has_torque = self._is_steady = False  # as far as is known; the position is none either
            raise ServoRestarted(f"{self.where} was without power for a moment")
        self._position, self._has_torque, self._is_tripped = position, torque == 1, watchdog == table.WATCHDOG_TRIPPED
        if error or temperature > self._hottest or self._fault is not None:
            self._fault = self._find_fault(error, temperature)
        self._is_steady &= self._has_torque and not self._is_tripped and self._fault is None
        wrong = self._fault or self._refused
        if wrong is not None:
            raise wrong
        return JointState(
            self._degrees(position),
            velocity * table.SPEED_UNIT * self._sign,
            100 * load / self._model.full_load * self._sign,
            float(temperature),
            not torque,
        )

    def _find_fault(self, error: int, temperature: int) -> DeviceError | None:
        if error:
            reasons = [text for bit, text in table.HARDWARE_ERRORS.items() if error & bit]
            text = " and ".join(reasons) or f"hardware error {error}"
            return DeviceError(f"{self.where} has no torque: {text}. Find out why, then switch its power off and on")
        self._is_hot = temperature > self._hottest - (_COOLED if self._is_hot else 0.0)
        if self._is_hot:
            text = f"it has {temperature} degrees Celsius, at most {self._hottest:g} are allowed"
            return DeviceError(f"{self.where} has no torque: {text}. It can be used again when it has cooled")
        return None

    def _goal(self, target: JointTarget) -> tuple[int | None, int]:
        """Return the goal in ticks, within the limits, and the highest speed in units of the servo."""
        position, speed = target.position, target.speed
        if not math.isfinite(position or 0.0) or not math.isfinite(speed or 0.0):
            self._refused = DeviceError(f"the {self.name} can't go to {position} at a speed of {speed}")
            return None, self._fastest
        if position is None or (speed is not None and speed <= 0):
            return None, self._fastest
        fastest = self._fastest
        if speed is not None:  # 0 would mean without a limit
            fastest = min(max(round(speed / table.SPEED_UNIT), 1), self._fastest)
        return min(max(self._ticks(position), self._low), self._high), fastest

    def _read_settings(self, settings: bytes) -> None:
        delay, drive_mode, mode, hottest, fastest, high, low = table.SETTINGS.unpack(settings)
        if mode not in (table.POSITION_MODE, table.EXTENDED_MODE, table.CURRENT_POSITION_MODE):
            raise DeviceError(f"{self.where} is in operating mode {mode}; set it to 3, position control")
        if drive_mode & (table.TIME_PROFILE | table.TORQUE_BY_GOAL):
            wanted = "set it to 0, or to 1 for the reverse direction"
            raise DeviceError(f"{self.where} is in drive mode {drive_mode}, which goes by time or by itself; {wanted}")
        if mode != table.POSITION_MODE:
            low, high = -table.MOST_TICKS, table.MOST_TICKS
        asked_low, asked_high = self._asked_range(low, high)
        if asked_low < low - 1 or asked_high > high + 1:
            own = " to ".join(f"{value:.1f}" for value in self._true_range(low, high))
            raise DeviceError(f"{self.where} goes from {own} degrees only; low or high of the {self.name} is beyond")
        self._low, self._high = max(low, asked_low), min(high, asked_high)
        self._fastest, self.delay = max(fastest, 1), delay * 2e-6
        self._hottest = hottest if self.options.hottest is None else min(self.options.hottest, hottest)

    def _asked_range(self, low: int, high: int) -> list[int]:
        """Return the limits of the robot file in ticks, by default those of the servo."""
        true_low, true_high = self._true_range(low, high)
        given = (
            true_low if self.options.low is None else self.options.low,
            true_high if self.options.high is None else self.options.high,
        )
        return sorted(self._ticks((value - self._device.offset) / self._device.scale) for value in given)

    def _true_range(self, low: int, high: int) -> list[float]:
        return sorted(self._degrees(tick) * self._device.scale + self._device.offset for tick in (low, high))

    def _degrees(self, ticks: int) -> float:
        return (ticks - table.CENTRE) * _DEGREES * self._sign

    def _ticks(self, degrees: float) -> int:
        return round(table.CENTRE + degrees * self._sign / _DEGREES)
