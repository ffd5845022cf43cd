"""All devices of a robot by name, whatever is behind them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from btlang.devices.driver import SIMULATED, DeviceError, DeviceSilent, make_driver
from btlang.devices.kinds import KINDS, Command, Reading
from btlang.devices.loop import DeviceLoop
from btlang.devices.simulated import SimulatedDevice

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body, Device

_FIRST = 3.0  # seconds


class Reads(Protocol):
    """An object that reads and writes devices by their names; see DeviceLoop."""

    def read(self, name: str) -> Reading: ...
    def write(self, name: str, command: Command) -> None: ...
    def silent(self, name: str) -> str | None: ...


def reader(devices: Mapping[str, Reads], name: str, part: str) -> Reads:
    """Return the reader of a device. Raises DeviceSilent if a part has none."""
    if name not in devices:
        raise DeviceSilent(f"the {part} has no device")
    return devices[name]


class DeviceSet:
    """The devices of a body: those of one driver and port share a loop.

    Simulated ones act on `robot`. `report` gets an event when a device falls silent or is back: see
    btlang.run.events.PartChanged.
    """

    def __init__(self, body: Body, robot: Any, report: Callable[[str, Mapping[str, Any]], object]) -> None:
        self._report = report
        self.devices: Mapping[str, Device] = {device.name: device for device in body.devices}
        self._reads: dict[str, Reads] = {}
        self.loops: list[DeviceLoop] = []
        self._simulated: list[SimulatedDevice] = []
        ports: dict[tuple[str, str], list[Device]] = {}
        for device in body.devices:
            if device.kind not in KINDS:
                raise DeviceError(f'there is no kind "{device.kind}"; the kinds are {", ".join(KINDS)}')
            if device.driver == SIMULATED:
                simulated = self._reads[device.name] = SimulatedDevice(device, robot)
                if KINDS[device.kind].moves:
                    self._simulated.append(simulated)
            else:
                ports.setdefault((device.driver, device.port), []).append(device)
        for (driver, port), devices in ports.items():
            loop = DeviceLoop(make_driver(driver, body.folder, port, devices), tuple(devices), self._on_change)
            self.loops.append(loop)
            self._reads.update(dict.fromkeys(loop.devices, loop))

    def start(self) -> None:
        """Begin to read and write; wait a moment for first readings, so that a mission has them."""
        for loop in self.loops:
            loop.start()
        until = time.monotonic() + _FIRST
        for loop in self.loops:
            loop.settled.wait(max(0.0, until - time.monotonic()))

    def close(self) -> None:
        """Bring what moves to rest, and close the ports. May be called twice."""
        for loop in self.loops:
            loop.close()

    def step(self) -> None:
        """Step the simulated devices, in the thread of the robot: those not commanded again stop."""
        for device in self._simulated:
            device.step()

    @property
    def readers(self) -> Mapping[str, Reads]:
        """The reader of each device, by its name."""
        return self._reads

    def first(self, kind: str) -> str:
        """Return the name of the first device of a kind; "" if there is none."""
        return next((name for name, device in self.devices.items() if device.kind == kind), "")

    def follow(self, name: str, take: Callable[[Reading], object]) -> None:
        """Follow the readings, as DeviceLoop does; a simulated device has nothing to follow."""
        for loop in self.loops:
            if name in loop.devices:
                loop.follow(name, take)

    def states(self) -> Sequence[tuple[Device, str | None]]:
        """Return all devices, with the reason why each is silent."""
        return [(device, self._reads[name].silent(name)) for name, device in self.devices.items()]

    def _on_change(self, name: str, reason: str | None) -> None:
        state = "works" if reason is None else "silent"
        text = f"the {name} works" if reason is None else f"the {name} is silent: {reason}"
        self._report("part", {"kind": "device", "name": name, "state": state, "text": text})
