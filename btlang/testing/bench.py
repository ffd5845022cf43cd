"""Benches for tests with pytest: a component or a driver alone, without a robot, a world or a mission."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

from btlang.components.component import Component
from btlang.devices.driver import Device, DeviceSilent
from btlang.devices.kinds import Command, Reading
from btlang.devices.loop import DeviceLoop

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.devices.driver import Driver, MakesDriver

    Found = TypeVar("Found")
    Tested = TypeVar("Tested", bound=Component)

_PATIENCE = 5.0  # seconds, on a busy computer


class ComponentBench:
    """A bench that leads components through their life in this process: `bench(Machine, heat=70)` is one that is
    active.

    The test stands in for their devices: `readings` are their readings by name, and a device without one is silent;
    `commands` are the latest that they got. `events` are what the components have reported: kind and data.
    """

    def __init__(self) -> None:
        self.readings: dict[str, Reading] = {}
        self.commands: dict[str, Command] = {}
        self.events: list[tuple[str, Mapping[str, Any]]] = []
        self._active: list[Component] = []

    def __call__(self, kind: type[Tested], **parameters: object) -> Tested:
        """Return a component with these parameters, configured and active.

        Raises ComponentError, and what its hooks raise.
        """
        made = kind()
        made.name = kind.__name__.lower()
        made._devices = dict.fromkeys([*kind.needs, *self.readings], self)
        made._report_event = lambda event, data: self.events.append((event, data))
        made.set_parameters(parameters)
        made.configure()
        made.activate()
        self._active.append(made)
        return made

    def read(self, name: str) -> Reading:
        """Return the reading of a device. Raises DeviceSilent."""
        if name not in self.readings:
            raise DeviceSilent(f"the {name} is silent: the test gives no reading")
        return self.readings[name]

    def write(self, name: str, command: Command) -> None:
        """Keep a command to a device."""
        self.commands[name] = command

    def close(self) -> None:
        """Bring all of them down, the latest first."""
        while self._active:
            component = self._active.pop()
            component.deactivate()
            component.clean_up()
            component.shut_down()


class DeviceBench:
    """A driver with one device, in the loop that reads and writes it on a robot."""

    def __init__(
        self, make: MakesDriver, kind: str, port: str = "", *, name: str = "device", **options: object
    ) -> None:
        self._device = Device(name, kind, "bench", port, options)
        self.driver: Driver = make(port, [self._device])
        self._loop = DeviceLoop(self.driver, (self._device,))
        self._loop.start()

    def read(self) -> Reading:
        """Return the latest reading. Raises DeviceSilent."""
        return self._loop.read(self._device.name)

    def write(self, command: Command) -> None:
        """Send it a command, which counts for 0.2 s. Raises DeviceError."""
        self._loop.write(self._device.name, command)

    def wait(self, expected: Callable[[Any], bool] = lambda reading: True, seconds: float = _PATIENCE) -> Reading:
        """Return the first reading that is as expected. Raises AssertionError if none comes in so many seconds."""

        def look() -> Reading | None:
            try:
                reading = self.read()
            except DeviceSilent:
                return None
            return reading if expected(reading) else None

        return self._first(look, seconds, "gives no such reading")

    def wait_for_silence(self, seconds: float = _PATIENCE) -> str:
        """Return why it has fallen silent. Raises AssertionError where it doesn't in so many seconds."""
        return self._first(lambda: self._loop.silent(self._device.name), seconds, "is not silent")

    def close(self) -> None:
        """Bring it to rest, and let go of its port."""
        self._loop.close()

    def _first(self, look: Callable[[], Found | None], seconds: float, problem: str) -> Found:
        until = time.monotonic() + seconds
        while (found := look()) is None:
            if time.monotonic() > until:
                latest = self._loop.silent(self._device.name) or self.read()
                raise AssertionError(f"the {self._device.name} {problem} in {seconds:g} s; the latest: {latest}")
            time.sleep(0.005)
        return found
