"""Servos without torque: people move them by hand, then they hold where they are."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import Device, DeviceError
from btlang.devices.drivers import SIMULATED
from btlang.devices.kinds import JointState, JointTarget
from btlang.robots.body import Body
from btlang.robots.body_file import unusable_robot
from btlang.robots.joints import joint_of
from btlang.support.interrupts import interrupts_later
from btlang.text.output import show

_EACH = 0.1  # seconds between two commands that keep servos loose
_WAITS = 2.0  # seconds until servos must have let go, or hold again
_LOOKS = 0.02  # seconds between two looks at them meanwhile
_SLOW = 5.0  # degrees a second at most until a servo holds


def servos_of(body: Body) -> tuple[Device, ...]:
    """The real servos of its joints."""
    return tuple(each for each in body.devices if each.driver != SIMULATED and body.joint(each.name) is not None)


@contextmanager
def loose(body: Body) -> Iterator[Callable[[], dict[str, float]]]:
    """The servos of a body without torque, and what reads where they are; at the end they hold there.

    Raises MissionError (BT071) where one can't be used. What reads raises DeviceError for one that is silent, and
    ValueError for one that was moved beyond the limits of its joint.
    """
    servos = _Servos(body)
    try:
        try:
            servos.let_go()
        except DeviceError as problem:
            raise unusable_robot(problem) from None
        yield servos.pose
    finally:
        with interrupts_later():
            servos.hold()
            servos.devices.close()


class _Servos:
    """A thread repeats their commands, as their loop requires."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._names = [servo.name for servo in servos_of(body)]
        try:
            self.devices = DeviceSet(body.replace(devices=servos_of(body)), None, _ignore)
        except DeviceError as problem:
            raise unusable_robot(problem) from None
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._keep, name="loose joints", daemon=True)

    def let_go(self) -> None:
        """Raises DeviceError where one is silent."""
        self.devices.start()
        self._thread.start()
        for name in self._until(lambda name: self._state(name).loose):
            self._state(name)
            raise DeviceError(f"the {name} doesn't let go")

    def hold(self) -> None:
        """Where they are; says which of them are silent, and so stay as they are."""
        self._done.set()
        if self._thread.ident is not None:
            self._thread.join()
        for name in self._until(self._holds):
            show(f"The {name} can't be told to hold its place.", sys.stderr)
        for name in self._names:
            self.devices.readers[name].write(name, JointTarget())

    def pose(self) -> dict[str, float]:
        """Where they are. See `loose`."""
        self._until(lambda name: bool(self._state(name)))  # one may be silent for a moment
        return {name: self._angle(name) for name in self._names}

    def _angle(self, name: str) -> float:
        joint, at = joint_of(self._body, name), self._state(name).position
        within = min(joint.high, max(joint.low, at))
        if abs(at - within) > joint.close_enough:
            says = f"it goes from {joint.low:g} to {joint.high:g}"
            raise ValueError(f"the {name} is at {at:.4g}, but {says}; move it back, then press Enter again")
        return round(within, 3 if joint.slides else 1)

    def _state(self, name: str) -> JointState:
        state = self.devices.readers[name].read(name)
        assert isinstance(state, JointState)
        return state

    def _keep(self) -> None:
        while not self._done.wait(_EACH):
            for name in self._names:
                self.devices.readers[name].write(name, JointTarget(loose=True))

    def _holds(self, name: str) -> bool:
        state = self._state(name)
        self.devices.readers[name].write(name, JointTarget(state.position, _SLOW))
        return not state.loose

    def _until(self, reached: Callable[[str], bool]) -> list[str]:
        """Asks again and again for those that haven't reached something; gives those that don't."""
        left, end = self._names, time.monotonic() + _WAITS
        while left and time.monotonic() < end:
            left = [name for name in left if not _is_so(reached, name)]
            if left:
                time.sleep(_LOOKS)
        return left


def _is_so(reached: Callable[[str], bool], name: str) -> bool:
    try:
        return reached(name)
    except DeviceError:  # silent; it may come back
        return False


def _ignore(kind: str, data: Mapping[str, object]) -> None:
    """Of devices that fall silent: reading says so."""
