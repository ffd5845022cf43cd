"""Boards for tests, the simulated one and the firmware compiled for this computer, and a user who drives them."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isinf
from pathlib import Path
from typing import Any

import pytest

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import Distance, Wheels, WheelSpeeds
from btlang.devices.loop import DeviceLoop
from btlang.devices.serial_board import driver as driver_module
from btlang.devices.serial_board.driver import SerialBoard
from btlang.devices.serial_board.simulated_board import CHANNELS, SimulatedBoard, SimulatedLine
from tests.profiles import amount

FIRMWARE = Path(driver_module.__file__).parent / "firmware"
SHIM = Path(__file__).parent / "board_shim.c"
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
PATIENCE = 15.0  # seconds for what has to come, on a busy machine
AT_REST = amount(1000, 200) / 1000
"""Seconds in which motors have to be at rest."""
SPEED = 0.4


class TestBoard(SimulatedBoard):
    """The simulated board, with what tests set."""

    __test__ = False

    def set_range(self, metres: float) -> None:
        """Metres that its first sensor measures."""
        self.readings[1] = Distance(metres)


class FirmwareBoard:
    """The firmware in C, in this process; one at a time."""

    def __init__(self, library: Path, name: str) -> None:
        self._c = ctypes.CDLL(str(library))
        self._c.shim_reset.restype = ctypes.c_bool
        self._c.shim_receive.restype = ctypes.c_size_t
        self._answer = ctypes.create_string_buffer(8192)
        self._name = name
        self.frozen: set[int] = set()
        self.ahead = 0.0
        self.reset(0.0)

    def reset(self, now: float) -> None:
        """See BoardModel."""
        self._started = now
        assert self._c.shim_reset(self._name.encode())

    def receive(self, data: bytes, now: float) -> bytes:
        """See BoardModel."""
        size = self._c.shim_receive(data, ctypes.c_size_t(len(data)), self._milliseconds(now, self.ahead), self._answer)
        return self._answer.raw[:size]

    def turn(self, now: float) -> None:
        """See BoardModel."""
        frozen = sum(1 << number for number in self.frozen)
        self._c.shim_turn(self._milliseconds(now), self._milliseconds(now, self.ahead), frozen)

    @property
    def speeds(self) -> tuple[float, float]:
        """See BoardModel."""
        return self._c.shim_left() / 1000, self._c.shim_right() / 1000

    def set_range(self, metres: float) -> None:
        """See TestBoard."""
        self._c.shim_set_range(0xFFFF if isinf(metres) else round(metres * 1000))

    def text(self) -> str:
        """What its display shows."""
        self._c.shim_text(self._answer)
        return self._answer.value.decode()

    def _milliseconds(self, now: float, ahead: float = 0.0) -> ctypes.c_uint32:
        return ctypes.c_uint32(round((now - self._started + ahead) * 1000) % 2**32)


def compiled(folder: Path) -> Path:
    """The firmware as a library. Skips the test where there's no compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    library = folder / "board.so"
    sources = [str(FIRMWARE / "btlang_board.c"), str(SHIM)]
    subprocess.run(
        [compiler, *STRICT, "-shared", "-fPIC", f"-I{FIRMWARE}", *sources, "-o", str(library)], check=True, timeout=60
    )
    return library


def devices(port: str, *kinds: str, **options: Any) -> tuple[Device, ...]:
    """A device of each of these kinds (without any: of all), called as its kind, on channels 1 to 8."""
    return tuple(
        Device(channel.kind, channel.kind, "serial-board", port, {"channel": channel.number, **options})
        for channel in CHANNELS
        if channel.kind in kinds or not kinds
    )


@contextmanager
def running(port: str, *kinds: str, **options: Any) -> Iterator[DeviceLoop]:
    """A loop of these devices."""
    made = devices(port, *kinds, **options)
    loop = DeviceLoop(SerialBoard(port, made), made)
    loop.start()
    try:
        yield loop
    finally:
        loop.close()


class User:
    """Drives with `SPEED` and looks at everything that the loop tells: it fails where a value can't be true."""

    def __init__(self, loop: DeviceLoop, true: set[float]) -> None:
        self.loop, self.true = loop, true
        self._wheels: Wheels | None = None
        self._looked = 0.0
        self.drives = True
        self.served = 0
        """Times that all devices were served."""
        self.reasons: set[str] = set()
        """Why one wasn't."""

    def look(self) -> bool:
        """One look; whether all devices are served."""
        if self.drives:
            self.loop.write("drive", WheelSpeeds(SPEED, SPEED))
        found = {}
        for name in self.loop.devices:
            try:
                found[name] = self.loop.read(name)
            except DeviceError as problem:
                self.reasons.add(str(problem))
        if isinstance(told := found.get("range"), Distance):
            assert round(told.distance, 6) in self.true
        if isinstance(wheels := found.get("drive"), Wheels):
            self._check(wheels)
        served = len(found) == len(self.loop.devices)
        self.served += served
        return served

    def until(self, reached: Callable[[], object]) -> None:
        """Looks until something is so."""
        end = time.monotonic() + PATIENCE
        while not reached():
            assert time.monotonic() < end, (self.reasons, {name: self.loop.silent(name) for name in self.loop.devices})
            self.look()
            time.sleep(0.005)

    def drive(self, seconds: float) -> None:
        """Looks for some time."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() >= end)

    def until_served(self) -> None:
        """Looks until all devices are served and the wheels turn."""
        self.until(lambda: self.look() and self._wheels and self._wheels.left_speed == SPEED)

    def _check(self, wheels: Wheels) -> None:
        now = time.monotonic()
        assert (wheels.left_speed, wheels.right_speed) in {(0.0, 0.0), (SPEED, SPEED)}
        if self._wheels is not None:
            most = SPEED * (now - self._looked + 0.3)  # a reading may be a little old
            assert -1e-6 <= wheels.left - self._wheels.left <= most
            assert -1e-6 <= wheels.right - self._wheels.right <= most
        self._wheels, self._looked = wheels, now


@contextmanager
def driven(line: SimulatedLine, *kinds: str, port: str = "", **options: Any) -> Iterator[User]:
    """A user of the board of a line, once it drives."""
    with running(port or line.path, *(kinds or ("range", "drive")), **options) as loop:
        user = User(loop, {1.0})
        user.until_served()
        yield user


def at_rest_after(line: SimulatedLine, user: User, lost: float) -> None:
    """Waits until the wheels are at rest, and looks how long after `lost` that was."""
    user.until(lambda: line.still_since is not None)
    assert line.still_since is not None
    assert line.still_since - lost <= AT_REST
