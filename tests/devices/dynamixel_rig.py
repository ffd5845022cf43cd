"""Simulated servos, driven by the loop of devices as a robot does it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any

from btlang.devices.driver import Device, DeviceSilent, MakesDriver
from btlang.devices.dynamixel.driver import DynamixelDriver
from btlang.devices.dynamixel.fake_bus import FakeBus, FakeServo
from btlang.devices.kinds import JointState, JointTarget
from btlang.devices.loop import SILENCE, DeviceLoop

PATIENCE = 20.0  # seconds: much more than anything takes, since other tests keep the computer busy


def device(id: int, port: str, /, **options: Any) -> Device:
    """A joint `j1` with the servo 1, and so on. `scale` and `offset` calibrate it."""
    calibration = {key: options.pop(key) for key in ("scale", "offset") if key in options}
    return Device(f"j{id}", "joint", "dynamixel", port, {"id": id, **options}, **calibration)


class Rig:
    """A loop over the servos of a bus. `events` are the changes that it reported."""

    def __init__(self, bus: FakeBus, devices: tuple[Device, ...], silence: float = SILENCE) -> None:
        self.bus, self.events = bus, list[tuple[str, str | None]]()
        make: MakesDriver = DynamixelDriver
        self.driver = make(devices[0].port, devices)
        self.loop = DeviceLoop(self.driver, devices, lambda name, reason: self.events.append((name, reason)), silence)
        self.seen: dict[str, list[JointState]] = {device.name: [] for device in devices}

    def until(
        self,
        holds: Callable[[], object],
        targets: Mapping[str, JointTarget] | None = None,
        patience: float = PATIENCE,
    ) -> None:
        """Tells the targets again and again until something holds; all readings are kept in `seen`.

        What looks at the latest reading doesn't hold before there is one.
        """

        def is_so() -> object:
            with suppress(IndexError):
                return holds()
            return False

        end = time.monotonic() + patience
        while not is_so():
            assert time.monotonic() < end, f"waited in vain; reported: {self.events}"
            for name, target in (targets or {}).items():
                self.loop.write(name, target)
            for name in self.seen:
                if self.loop.silent(name) is None:
                    self._look(name)
            time.sleep(0.01)

    def for_a_while(self, seconds: float, targets: Mapping[str, JointTarget] | None = None) -> None:
        """Tells the targets for some time."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() > end, targets, seconds + PATIENCE)

    def is_back(self, *names: str) -> bool:
        """Whether these joints, else all, tell what they should."""
        return all(self.loop.silent(name) is None for name in names or self.seen)

    def _look(self, name: str) -> None:
        try:
            reading = self.loop.read(name)
        except DeviceSilent:  # just now
            return
        assert isinstance(reading, JointState)
        self.seen[name].append(reading)


@contextmanager
def rig(*servos: FakeServo, silence: float = SILENCE, **options: Any) -> Iterator[Rig]:
    """Servos on a bus, and a loop that has not begun to open it."""
    with FakeBus(servos) as bus:
        found = Rig(bus, tuple(device(servo.id, bus.port, **options) for servo in servos), silence)
        try:
            yield found
        finally:
            found.loop.close()


def degrees(servo: FakeServo) -> float:
    """Where its shaft is."""
    return (servo.position - 2048) * 360 / 4096
