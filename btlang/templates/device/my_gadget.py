"""A driver of the gadget, a distance sensor on a serial line: the line "?" asks it, "1234" are millimetres, "-" is
nothing in range.
"""

from math import inf

from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Distance

LOOPBACK = "loopback"


class Loopback:
    """A gadget in this computer, for tests and for the port "loopback". It has the methods of a serial line."""

    answer = b"500\n"

    def write(self, data):
        assert data == b"?\n"

    def readline(self):
        return self.answer

    def close(self):
        self.answer = b""


class GadgetDriver:
    kinds, needs_port = ("range",), True
    rate = 20.0  # cycles a second

    def __init__(self, port, devices):
        if len(devices) > 1:
            raise DeviceError(f"the {devices[1].name} has the port of the {devices[0].name}; it needs another one")
        self._port, self._name = port, devices[0].name
        self.line = None

    def open(self):
        self.line = Loopback() if self._port == LOOPBACK else self._serial()

    def exchange(self, commands):
        self.line.write(b"?\n")  # an OSError, such as of a cable that was pulled, is noticed and open() called again
        answer = self.line.readline().strip()
        if not answer:
            return {}  # nothing new; after 0.2 s it is silent
        if answer != b"-" and not answer.isdigit():
            return {self._name: DeviceError(f"it says {answer!r}")}
        return {self._name: Distance(inf if answer == b"-" else int(answer) / 1000)}

    def close(self):
        if self.line is not None:
            self.line.close()

    def _serial(self):
        import serial  # only where a real one is used: pip install 'btlang[serial]'

        return serial.Serial(self._port, 115200, timeout=0.1)
