"""A simulated servo of the X series: its control table, and a shaft that goes to its goal."""

from __future__ import annotations

import time
from struct import pack_into, unpack_from

from btlang.devices.dynamixel import control_table as table

_EEPROM_END = 64
_INDIRECT_COUNT = 20  # those of the smallest models
_FAILED, _RANGE, _LIMIT, _ACCESS = 1, 4, 6, 7
_DATA_LENGTH = 5
_SIZE = 300


class FakeServo:
    """A servo with the settings of a new one, but for the delay of its answers. Times are of time.monotonic().

    The attributes are faults that may be set at any time: it is `silent`; answers with the id `answers_as`; `late` by
    some seconds; it has a fast way of reading only if it `is_fast`.
    """

    def __init__(self, id: int, model: int = 1060, firmware: int = 46, is_fast: bool = True) -> None:
        self.id, self.model = id, model
        self.silent, self.answers_as, self.late, self.is_fast = False, id, 0.0, is_fast
        self.memory = bytearray(_SIZE)
        self._now = time.monotonic()
        self._heard = self._now
        self._exact = float(table.CENTRE)
        m = self.memory
        pack_into("<H4xBB", m, 0, model, firmware, id)
        pack_into("<B", m, table.OPERATING_MODE, table.POSITION_MODE)
        pack_into("<B", m, table.TEMPERATURE_LIMIT, 72)
        pack_into("<Iii", m, table.MAX_POSITION - 4, 265, table.TICKS - 1, 0)
        self.temperature = 30
        self.reboot()

    def reboot(self) -> None:
        """As after its power was off: torque and watchdog are off, and it has forgotten its indirect addresses."""
        self.memory[_EEPROM_END:] = bytes(_SIZE - _EEPROM_END)
        data = table.MODELS[self.model].indirect_data if self.model in table.MODELS else 224
        pack_into(f"<{_INDIRECT_COUNT}H", self.memory, table.INDIRECT_ADDRESS, *range(data, data + _INDIRECT_COUNT))
        self.memory[table.STATUS_RETURN] = 2
        self.temperature = self.temperature
        self.turn_to(self._exact)

    @property
    def temperature(self) -> int:
        """Degrees Celsius."""
        return self._temperature

    @temperature.setter
    def temperature(self, degrees: int) -> None:
        self._temperature = self.memory[table.TEMPERATURE] = degrees

    @property
    def has_torque(self) -> bool:
        """Whether it holds its shaft."""
        return self.memory[table.TORQUE] == 1

    @property
    def position(self) -> float:
        """Where its shaft is, in ticks, at the last instruction on the line."""
        return self._exact

    @property
    def goal(self) -> int:
        """In ticks."""
        goal: int = unpack_from("<i", self.memory, table.GOAL_POSITION)[0]
        return goal

    def turn_to(self, ticks: float) -> None:
        """Turns the shaft by hand."""
        self._exact = ticks
        pack_into("<ii", self.memory, table.VELOCITY, 0, round(ticks))
        if not self.has_torque:
            pack_into("<i", self.memory, table.GOAL_POSITION, round(ticks))

    def fail(self, bits: int) -> None:
        """A hardware error: it lets go until it is rebooted."""
        self.memory[table.HARDWARE_ERROR] = bits
        self.memory[table.TORQUE] = 0

    def hear(self, now: float) -> None:
        """An instruction for anybody was on the line."""
        period = self.memory[table.WATCHDOG] * table.WATCHDOG_UNIT
        if self.has_torque and 0 < period < 127 * table.WATCHDOG_UNIT and now - self._heard > period:
            self._move(self._heard + period)
            self.memory[table.WATCHDOG] = table.WATCHDOG_TRIPPED
        self._move(now)
        self._heard = now

    def read(self, address: int, length: int) -> bytes:
        """Bytes of its control table."""
        return bytes(self.memory[self._at(a)] for a in range(address, address + length))

    def write(self, address: int, data: bytes) -> int:
        """Writes to its control table, or returns the error why not."""
        cells = [self._at(a) for a in range(address, address + len(data))]
        error = self._error(cells, data)
        if not error:
            for cell, byte in zip(cells, data, strict=True):
                self.memory[cell] = byte
        return error

    def _at(self, address: int) -> int:
        first = table.MODELS[self.model].indirect_data if self.model in table.MODELS else 224
        if first <= address < first + _INDIRECT_COUNT:
            place: int = unpack_from("<H", self.memory, table.INDIRECT_ADDRESS + 2 * (address - first))[0]
            return min(place, _SIZE - 1)
        return min(address, _SIZE - 1)

    def _error(self, cells: list[int], data: bytes) -> int:
        if cells[-1] >= _SIZE - 1:
            return _DATA_LENGTH
        if cells[0] < _EEPROM_END and self.has_torque:
            return _ACCESS
        if table.TORQUE in cells and data[cells.index(table.TORQUE)] and self.memory[table.HARDWARE_ERROR]:
            return _FAILED
        if table.GOAL_POSITION in cells:
            if self.memory[table.WATCHDOG] == table.WATCHDOG_TRIPPED:
                return _RANGE
            goal: int = unpack_from("<i", data, cells.index(table.GOAL_POSITION))[0]
            high, low = unpack_from("<ii", self.memory, table.MAX_POSITION)
            if not low <= goal <= high:
                return _LIMIT
        return 0

    def _move(self, now: float) -> None:
        seconds, self._now = max(now - self._now, 0.0), max(now, self._now)
        if not self.has_torque or self.memory[table.WATCHDOG] == table.WATCHDOG_TRIPPED:
            self.turn_to(self._exact)
            return
        fastest: int = unpack_from("<I", self.memory, table.PROFILE_VELOCITY)[0] or table.TICKS
        most = fastest * table.SPEED_UNIT * table.TICKS / 360 * seconds
        step = min(max(self.goal - self._exact, -most), most)
        self._exact += step
        velocity = 0 if step == 0 else fastest if step > 0 else -fastest
        pack_into("<ii", self.memory, table.VELOCITY, velocity, round(self._exact))
