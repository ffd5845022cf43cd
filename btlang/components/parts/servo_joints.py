"""Smooth joints over servos: plans are written to them a hundred times a second, concurrently with the tick."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from btlang.components.parts.sensors import servo_angle
from btlang.devices.device_set import Reads
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import JointTarget
from btlang.devices.loop import DeviceLoop
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture, joints_of
from btlang.robots.motion.course import PERIOD
from btlang.robots.motion.guard.tracking import JointProgress
from btlang.robots.motion.smooth_joints import SmoothJoints
from btlang.robots.robot import RobotError, joint_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.robot import Operation

_LATE = 3 * PERIOD
"""Seconds that one turn of the loop counts at most: after a pause the joints go on from where they are."""


class ServoJoints:
    """Planned joints over servos of the same names, as a JointsPart.

    A thread writes to real servos while anything moves. If it hangs, the loop of their devices brings them to rest.
    `step` commands simulated ones.
    """

    def __init__(self, body: Body, devices: Mapping[str, Reads]) -> None:
        self._body, self._devices = body, devices
        self._smooth = SmoothJoints(body)
        self._is_real = any(isinstance(devices.get(joint.name), DeviceLoop) for joint in body.joints)
        self._commanded: frozenset[str] = frozenset()
        self._lets_go = False
        self._time = 0.0
        self._progress = JointProgress(body, lambda: self._time)
        self._thread: threading.Thread | None = None

    @property
    def moving(self) -> bool:
        """Whether any joint is on its way, as far as that is known."""
        try:
            return self._smooth.moving or not self._have_reached(self._commanded)
        except DeviceError:
            return False

    def angle(self, name: str) -> float:
        """Return the measured angle of a joint. Raises RobotError for an unknown one, and DeviceSilent."""
        return servo_angle(self._body, self._devices, name)

    def move(self, targets: Mapping[str, float]) -> None:
        self._begin(targets)
        self._smooth.move(targets)
        self._go_on()

    def play(self, wanted: Gesture | Sequence[Mapping[str, float]], room: float | None) -> tuple[Operation, float]:
        self._begin(joints_of(wanted))
        made = self._smooth.play(wanted, room)
        self._go_on()
        return made

    @property
    def planned(self) -> SmoothJoints:
        return self._smooth

    def idle(self, targets: Mapping[str, float], least: float) -> bool:
        """Move idle joints, as SmoothJoints does; not if a servo is silent."""
        try:
            if not (self._commanded.issuperset(targets) and self._have_reached(targets)):
                self._begin(targets)
        except RobotError:
            return False
        found = self._smooth.idle(targets, least)
        if found:
            self._go_on()
        return found

    def lead(self, wanted: Gesture | Sequence[Mapping[str, float]]) -> float:
        return self._smooth.lead(wanted)

    def at_target(self, names: tuple[str, ...]) -> bool:
        """Return whether none of these joints is on its way. Raises DeviceSilent, and RobotError if one is stuck."""
        if not self._smooth.at_target(names):
            self._progress.start(names)  # where it stands by then counts from the end of its movement on
            return False
        planned = self._smooth.angles
        own = [name for name in names if name in self._commanded]
        return all(self._progress.has_arrived(name, planned[name] - self.angle(name)) for name in own)

    def freeze(self, names: tuple[str, ...] | None = None) -> None:
        """Brake these joints to rest, where they stay; None: all of them, which takes no lock."""
        self._smooth.freeze(names)
        self._lets_go = self._lets_go or names is None

    def step(self, dt: float) -> None:
        """Command the joints again; one that has arrived holds its position by itself."""
        self._time += dt
        if self._smooth.timeline.rests():
            self._write()
            return
        for name in self._commanded:
            if (silent := self._devices[name].silent(name)) is not None:
                self._smooth.timeline.halt(f"the {name} is silent: {silent}")
        if self._is_real:
            self._go_on()
        else:
            self._smooth.step(dt)
            self._write()

    def _begin(self, names: Iterable[str]) -> None:
        """Begin where the servos are, if they rest. Raises DeviceSilent."""
        wanted = frozenset(names)
        for name in wanted:
            self.angle(name)
        if self._smooth.timeline.rests():
            wanted = frozenset(joint.name for joint in self._body.joints)
        at = [self._measure(name) if name in wanted else self._smooth.angle(name) for name in self._smooth.angles]
        self._smooth.timeline.put(np.array(at))
        self._lets_go = False
        self._commanded |= wanted

    def _measure(self, name: str) -> float:
        try:
            return self.angle(name)
        except DeviceError:
            return self._smooth.angle(name)

    def _go_on(self) -> None:
        if self._is_real and (self._thread is None or not self._thread.is_alive()):
            self._thread = threading.Thread(target=self._work, name="btlang body", daemon=True)
            self._thread.start()

    def _work(self) -> None:
        before = due = time.monotonic()
        while not self._smooth.timeline.rests():
            due = max(due + PERIOD, before)
            time.sleep(max(0.0, due - time.monotonic()))
            now = time.monotonic()
            self._smooth.step(min(now - before, _LATE))
            before = now
            self._write()

    def _write(self) -> None:
        at, let_go = self._smooth.angles, self._lets_go and self._smooth.timeline.rests()
        for name in self._commanded:
            target = JointTarget() if let_go else JointTarget(at[name], joint_of(self._body, name).speed)
            self._devices[name].write(name, target)
        if let_go:
            self._commanded, self._lets_go = frozenset(), False

    def _have_reached(self, names: Iterable[str]) -> bool:
        """Return whether servos are at their targets. Raises DeviceSilent."""
        planned = self._smooth.angles
        return all(abs(self.angle(name) - planned[name]) <= joint_of(self._body, name).close_enough for name in names)
