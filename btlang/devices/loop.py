"""Reads and writes the devices of a port in their own thread, and checks all values, whoever made them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from math import fsum, isfinite, isnan

from btlang.devices.driver import Device, DeviceError, DeviceSilent, Driver
from btlang.devices.kinds import KINDS, Charge, Command, Distance, Image, JointTarget, Reading, Scan
from btlang.engine.leaves.leaf import describe_exception
from btlang.robots.motion.guard.readings import ChargeCheck

_NUMBERS, _NO_NUMBER, _NOT_FINITE = ("float", "int"), "not a number", "not finite"
SILENCE = 0.2
"""Seconds after which a command no longer counts, and after which a device that moves is silent."""
_RETRY = 0.25  # seconds until a lost port is opened again
_JOIN = 2.0
_NOT_YET, _NOTHING_NEW, _CLOSED = "it has not answered yet", "it reports nothing new", "its loop is closed"


def wrong_field(record: Reading | Command) -> tuple[str, str] | None:
    """Return the name of the first field that isn't a number although it has to be, and what is wrong with it.

    Distances may be infinite.
    """
    for name, may_lack in _number_fields(type(record)):
        value = getattr(record, name)
        if value is None and may_lack:
            continue
        try:
            if isnan(value):
                return name, _NO_NUMBER
        except (TypeError, OverflowError):  # OverflowError: a whole number of hundreds of digits
            return name, _NO_NUMBER
        if not isfinite(value) and not isinstance(record, Distance):
            return name, _NOT_FINITE
    return None


def check_command(name: str, kind: str, command: Command) -> None:
    """Raise DeviceError for a command that a device of this name and kind doesn't take."""
    wanted = KINDS[kind].command
    if wanted is None or not isinstance(command, wanted):
        raise DeviceError(f"the {name} doesn't take a {type(command).__name__}")
    if wrong := wrong_field(command):
        raise DeviceError(f"the {name} doesn't take a {wrong[0]} that is {wrong[1]}")


def wrong_content(reading: Reading) -> str:
    """Return why the beams of a scan or the pixels of a picture can't be used, "" if they can."""
    if isinstance(reading, Scan):
        try:
            all_invalid = isnan(fsum(reading.ranges)) and all(map(isnan, reading.ranges))
        except (TypeError, ValueError):  # ValueError: infinity of both signs
            return "its ranges have what is not a number"
        return "its scan has no valid beam" if all_invalid else ""
    if isinstance(reading, Image):
        size, wanted = len(reading.pixels), 3 * reading.width * reading.height
        if reading.width <= 0 or size != wanted:
            return f"its picture has {size} bytes, not {wanted}: 3 for each of {reading.width} by {reading.height}"
    return ""


@cache
def _number_fields(kind: type[Reading | Command]) -> tuple[tuple[str, bool], ...]:
    """Return the fields that are numbers, and whether each may be None."""
    kinds = ((name, str(kind.__annotations__.get(name, "")).split(" | ")) for name in kind.fields)
    return tuple((name, "None" in each) for name, each in kinds if each[0] in _NUMBERS)


class DeviceLoop:
    """The loop of one driver, from `start` to `close`. All other methods are for any thread.

    `changed` is called, in the thread of the loop, with a device and why it is silent (None: it is back).
    """

    def __init__(
        self,
        driver: Driver,
        devices: tuple[Device, ...],
        changed: Callable[[str, str | None], object] = lambda name, reason: None,
        silence: float = SILENCE,
    ) -> None:
        self._driver, self._changed, self._silence = driver, changed, silence
        self.devices: Mapping[str, Device] = {device.name: device for device in devices}
        self._commands: dict[str, tuple[Command, float]] = {}
        self._readings: dict[str, tuple[Reading, float]] = {}
        self._wrong: dict[str, str | None] = dict.fromkeys(self.devices, _NOT_YET)
        self._followers: dict[str, list[Callable[[Reading], object]]] = {}
        self._charges = {device.name: ChargeCheck() for device in devices if device.kind == "battery"}
        self.settled = threading.Event()
        """Set once it is known for each device whether it answers."""
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._work, name="btlang devices", daemon=True)
        self.rate = 0.0
        """Cycles a second that it reaches, over about a second; 0 while the port is not open."""

    def start(self) -> None:
        """Begin to open the port, and retry until it can be opened."""
        self._thread.start()

    def close(self) -> None:
        """Bring the devices to rest and close the port. May be called twice."""
        self._stopped.set()
        if self._thread.ident is not None:
            self._thread.join(_JOIN)

    def read(self, name: str) -> Reading:
        """Return the latest reading. Raises DeviceSilent if there is no new one."""
        found, wrong = self._readings.get(name), self.silent(name)
        if wrong is None and found is not None:
            return found[0]
        raise DeviceSilent(f"the {name} is silent: {wrong or _NOTHING_NEW}")

    def follow(self, name: str, take: Callable[[Reading], object]) -> None:
        """Call `take` with each new reading from now on, in the thread of the loop; it must return at once."""
        self._followers[name] = [*self._followers.get(name, ()), take]

    def write(self, name: str, command: Command) -> None:
        """Command a device; the command counts for `silence` seconds, so whoever drives repeats it.

        Raises DeviceError for an invalid command, or for a field that isn't a finite number.
        """
        check_command(name, self.devices[name].kind, command)
        self._commands[name] = command, time.monotonic()

    def rest(self) -> None:
        """Forget all commands: what moves comes to rest in the next cycle. Takes no lock."""
        self._commands.clear()

    def silent(self, name: str) -> str | None:
        """Return why a device is silent, None if it isn't."""
        found, wrong = self._readings.get(name), self._wrong[name]
        if wrong is None and (found is None or time.monotonic() - found[1] > self._silence):
            return _NOTHING_NEW  # its driver hangs
        return wrong

    def _work(self) -> None:
        while not self._stopped.is_set():
            try:
                self._driver.open()
                self._cycle()
            except DeviceError as problem:
                self._lost(str(problem))
            except BaseException as problem:  # of a driver by somebody else, sys.exit() too: others go on
                self._lost(describe_exception(problem))
            with suppress(Exception):
                self._driver.close()
            self._stopped.wait(_RETRY)
        self._lost(_CLOSED)

    def _cycle(self) -> None:
        period = 1.0 / self._driver.rate
        due = time.monotonic()
        counted, since, took = 0, due, 0.0
        while not self._stopped.is_set():
            began = time.monotonic()
            readings = self._driver.exchange(self._due_commands(began + period + took))
            now = time.monotonic()
            took = now - began
            for name, reading in readings.items():
                self._take_reading(name, reading, now)
            for name in self.devices:
                found = self._readings.get(name)
                if found is not None and self._wrong[name] is None and now - found[1] > self._silence:
                    self._set_wrong(name, _NOTHING_NEW)
            counted += 1
            if now - since >= 1.0:
                self.rate, counted, since = counted / (now - since), 0, now
            due = max(due + period, now - period)  # what was missed is left out
            if due > now:
                self._stopped.wait(due - now)

    def _due_commands(self, until: float) -> dict[str, Command]:
        """Return the commands that count until the next cycle. A device that moves rests while it's silent."""
        found: dict[str, Command] = {}
        for name, device in self.devices.items():
            kind = KINDS[device.kind]
            if kind.command is None:
                continue
            command, commanded = self._commands.get(name, (None, 0.0))
            heard = self._readings.get(name, (None, 0.0))[1]
            late = kind.moves and until - min(commanded, heard) > self._silence
            if command is not None and not late:
                found[name] = _inverse(command, device)
            elif kind.rest is not None:
                found[name] = kind.rest
        return found

    def _take_reading(self, name: str, reading: Reading | DeviceError, now: float) -> None:
        wrong = str(reading) if isinstance(reading, DeviceError) else _untrue(reading, self.devices[name])
        if wrong or isinstance(reading, DeviceError):
            self._readings.pop(name, None)
            self._set_wrong(name, wrong)
        else:
            calibrated = _calibrate(reading, self.devices[name])
            if isinstance(calibrated, Charge) and not self._charges[name].believes(calibrated.percent, now):
                before = self._readings.get(name)
                if before is not None and self._charges[name].is_recent(now):
                    self._readings[name] = before[0], now
                return
            self._readings[name] = calibrated, now
            for take in self._followers.get(name, ()):
                take(calibrated)
            self._set_wrong(name, None)

    def _set_wrong(self, name: str, reason: str | None) -> None:
        if self._wrong[name] != reason:
            self._wrong[name] = reason
            with suppress(Exception):  # whoever listens, the devices are read on
                self._changed(name, reason)
            if _NOT_YET not in self._wrong.values():
                self.settled.set()

    def _lost(self, reason: str) -> None:
        self.rate = 0.0
        for name in self.devices:
            self._readings.pop(name, None)
            self._set_wrong(name, reason)


def _untrue(reading: Reading, device: Device) -> str:
    """Return why a reading can't be used, "" if it can."""
    wanted = KINDS[device.kind].reading or Reading
    if not isinstance(reading, wanted):
        return f"its driver gives {type(reading).__name__}, not {wanted.__name__}"
    wrong = wrong_field(reading)
    return f"its {wrong[0]} is {wrong[1]}" if wrong else wrong_content(reading)


def _calibrate(reading: Reading, device: Device) -> Reading:
    if (device.scale, device.offset) == (1.0, 0.0):
        return reading
    kind, scale, offset = KINDS[device.kind], device.scale, device.offset
    changed = {name: getattr(reading, name) * scale for name in kind.scaled}
    changed |= {name: getattr(reading, name) * scale + offset for name in kind.shifted}
    made: Reading = reading.replace(**changed)
    return made


def _inverse(command: Command, device: Device) -> Command:
    if (device.scale, device.offset) == (1.0, 0.0):
        return command
    kind, changed = KINDS[device.kind], {}
    for name in (*kind.scaled, *kind.shifted):
        value = getattr(command, name, None)
        if value is not None:
            scale = abs(device.scale) if isinstance(command, JointTarget) and name == "speed" else device.scale
            changed[name] = (value - (device.offset if name in kind.shifted else 0.0)) / scale
    made: Command = command.replace(**changed)
    return made
