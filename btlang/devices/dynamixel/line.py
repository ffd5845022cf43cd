"""A serial port that is waited for with `select`."""

from __future__ import annotations

import os
import select
import time
from contextlib import suppress

from btlang.devices.driver import DeviceError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from serial import Serial


class LineLost(DeviceError):
    """A port that can't be opened, or can't be read or written any more."""


class SerialLine:
    """A port and its bits a second. All methods but `close` raise LineLost once it is lost."""

    def __init__(self, port: str, baud: int) -> None:
        self.port, self.baud = port, baud
        self.sent_by = 0.0
        """When all that was sent is out (of time.monotonic()): a slow line is still at it."""
        self._serial: Serial | None = None

    def open(self) -> None:
        """Opens it for this process alone. Raises LineLost where that can't be done."""
        try:
            import serial
        except ImportError:
            raise LineLost("serial ports need the package pyserial: pip install 'btlang[serial]'") from None
        self.close()
        try:
            self._serial = serial.Serial(self.port, self.baud, timeout=0, exclusive=True)
        except (OSError, ValueError) as problem:  # serial.SerialException is an OSError
            raise LineLost(f"the port {self.port} can't be opened: {_reason(problem)}") from None
        with suppress(OSError, ValueError):  # a USB adapter otherwise keeps what it got for 16 ms; others don't know it
            self._serial.set_low_latency_mode(True)

    def close(self) -> None:
        """Lets go of it. May be called twice."""
        if self._serial is not None:
            with suppress(OSError):
                self._serial.close()
            self._serial = None

    def seconds(self, count: int) -> float:
        """How long as many bytes take on the line."""
        return count * 10 / self.baud

    def send(self, data: bytes) -> None:
        """Sends bytes. What has come before is forgotten: it answers something else."""
        try:
            file = self._file()
            while select.select((file,), (), (), 0)[0]:
                if not os.read(file, 4096):
                    raise OSError("it was pulled out")
            self.sent_by = max(self.sent_by, time.monotonic()) + self.seconds(len(data))
            while data:
                with suppress(BlockingIOError):
                    data = data[os.write(file, data) :]
                if data and not select.select((), (file,), (), 1.0)[1]:
                    raise OSError("it takes nothing")
        except (OSError, ValueError) as problem:
            raise self._lost(problem) from None

    def receive(self, until: float) -> bytes:
        """What comes next, as soon as something does; nothing, if nothing does until then (of time.monotonic())."""
        try:
            file = self._file()
            wait = max(until - time.monotonic(), 0.0)
            if not select.select((file,), (), (), wait)[0]:
                return b""
            data = os.read(file, 4096)
        except (OSError, ValueError) as problem:
            raise self._lost(problem) from None
        if not data:
            raise self._lost(OSError("it was pulled out"))
        return data

    def _file(self) -> int:
        if self._serial is None:
            raise OSError("it is not open")
        file: int = self._serial.fileno()
        return file

    def _lost(self, problem: Exception) -> LineLost:
        return LineLost(f"the port {self.port} is lost: {_reason(problem)}")


def _reason(problem: Exception) -> str:
    number = getattr(problem, "errno", None)
    return os.strerror(number) if isinstance(number, int) else str(problem)
