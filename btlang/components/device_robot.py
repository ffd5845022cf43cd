"""A robot over its devices: real ones, or their simulated twins."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress

from btlang.components.parts.parts import device_parts
from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import SIMULATED, DeviceError
from btlang.devices.simulated import twin, twins
from btlang.robots.bodies.body import Sensor
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.platforms import ALL
from btlang.robots.robot import RobotError
from btlang.robots.simulation.connection import Simulation
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.run.controls import Controls
from btlang.run.pace import Pace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body, Device
    from btlang.robots.parts import Parts
    from btlang.robots.worlds.obstacles import Obstacles
    from btlang.robots.worlds.world import World

_CONTROL = 0.05  # seconds between two looks at the devices, however slowly a mission ticks
_EYES = Sensor("scanner", "", 100.0)  # of the twin of a robot without a scanner, for its other sensors


class DeviceSimulation(Simulation):
    """A connection whose robot has `devices`; simulated ones act on a twin of the robot in a world.

    With only simulated devices it runs as fast as requested, and deterministically; otherwise in real time.
    """

    def __init__(self, world: World, body: Body) -> None:
        super().__init__(world, body, self._parts)
        self.real = bool(self.devices.loops)
        self.robot.moves_by_itself = self.real
        self.devices.start()

    def pace(self, speed: float, controls: Controls) -> Pace:
        """Return the pace. Raises ValueError for another speed than 1 if devices are real."""
        if not self.real:
            return super().pace(speed, controls)
        if speed != 1.0:
            raise ValueError("a robot with real devices runs in real time")
        return DevicePace(controls, self.robot.step)

    def close(self) -> None:
        """Bring what moves to rest, and close the ports."""
        self.robot.disable()
        self.devices.close()

    def _parts(self, world: World, obstacles: Obstacles, body: Body) -> Parts:
        sees = body if body.range else body.replace(sensors=(*body.sensors, _EYES))
        plain = tuple(joint.replace(acceleration=0.0, jerk=0.0) for joint in body.joints)  # they go where commanded
        self._twin = SimulatedRobot(world, None, sees.replace(joints=plain), None, obstacles, sees=False)
        self.devices = DeviceSet(body, self._twin, self._report)
        drive = self.devices.first("drive")
        self._drives = bool(drive) and self.devices.devices[drive].driver == SIMULATED
        locate = (lambda: self._twin.pose) if self._drives else None  # as good as the localization of other robots
        return device_parts(world, obstacles, body, self.devices, self._advance, locate)

    def _advance(self, seconds: float) -> None:
        """Step the twin; if the wheels are real, it is put where they are."""
        self.devices.step()
        if not self._drives:
            with suppress(RobotError):  # it stays where it was seen last
                self._twin.carry(self.robot.pose)
        self._twin.step(seconds)


class DevicePace(Pace):
    """A pace of real time. Between ticks, however rare, it reads and commands devices."""

    def __init__(self, controls: Controls, step: Callable[[float], object]) -> None:
        super().__init__(1.0, controls)
        self._step = step

    def sleep(self, period: float, wait: float = math.inf) -> float:
        left, total = min(period, wait), 0.0
        while left > 1.5 * _CONTROL and not self._woken:
            passed = super().sleep(_CONTROL)
            self._step(passed)
            total, left = total + passed, left - passed
            self.stepped += passed
        return total + super().sleep(left)


def connect_devices(world: World, *, body: Body, simulate: Sequence[str] = (), **options: Any) -> DeviceSimulation:
    """Return a connection to the devices of a body.

    Those whose name or kind is in `simulate` are simulated (ALL: every one, and what the body has no device for).
    Raises MissionError (BT071) for devices that can't be used.
    """
    try:
        return DeviceSimulation(world, body.replace(devices=simulate_devices(body, simulate)))
    except DeviceError as problem:
        raise unusable_robot(problem) from None


def simulate_devices(body: Body, names: Sequence[str]) -> tuple[Device, ...]:
    """Return the devices of a body, some of them simulated. Raises DeviceError for an unknown name."""
    if ALL in names:
        return twins(body)
    known = {name for device in body.devices for name in (device.name, device.kind)}
    for name in names:
        if name not in known:
            raise DeviceError(f"the robot has no device '{name}' to simulate")
    return tuple(twin(each) if {each.name, each.kind} & set(names) else each for each in body.devices)
