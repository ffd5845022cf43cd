"""The driver `dynamixel`: joints made of servos of the X series on one port, read in each cycle."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import ClassVar

from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.client import LineLost, SerialLine, ServoClient
from btlang.devices.dynamixel.control_table import STATE
from btlang.devices.dynamixel.protocol import OVERHEAD
from btlang.devices.dynamixel.servo import WATCHDOG_SET, Servo, ServoCommands, ServoRestarted, read_all
from btlang.devices.kinds import Command, JointTarget, Reading
from btlang.support.record import Record

_SILENCE = 0.15  # seconds without an answer after which a servo is no longer asked with the others
_BLAMES = 3  # ... if it was the first that didn't answer as often, since those behind it wait for its answer
_LENGTHS = 4  # a question after one that was not answered in full has another length, so late answers don't fit it
_PLAIN = 1.0  # seconds for which each answers with a packet of its own after a common answer was damaged
_RATE = 100.0
_MORE_TRIES = 2  # to find a servo when the line is opened
_PAUSES = (0.1, 0.2, 0.4, 1.0)
"""Seconds until a servo that can't be used is tried again; the last one repeats."""
_PACKET = 14  # bytes of a packet to all servos, beside those of each


class _Asked:
    def __init__(self, address: int, fast: bool, now: float) -> None:
        self.address, self.fast, self.answered = address, fast, now
        self.blames = 0


class Polling:
    """The order in which servos are asked.

    Servos that can answer with one common packet do; those whose answer is missing are asked last, since in a chain of
    answers each waits for the one before.
    """

    def __init__(self, client: ServoClient) -> None:
        self._client = client
        self._asked: dict[int, _Asked] = {}
        self._groups: dict[tuple[int, bool], list[int]] | None = None  # None: they have changed
        self._plain_until, self._extra = 0.0, 0

    def add(self, id: int, address: int) -> None:
        """Ask a servo from now on, whose state begins at this address, and try whether it knows the fast way."""
        fast = any(self._client.sync_read(address, STATE.size, (id,), fast=True) for _ in range(2))
        self._asked[id] = _Asked(address, fast, time.monotonic())
        self._groups = None

    def remove(self, id: int) -> None:
        """Stop asking a servo."""
        self._asked.pop(id, None)
        self._groups = None

    def read(self) -> Mapping[int, bytes]:
        """Do one cycle: return the states of the servos that answered, perhaps with some bytes more."""
        if self._groups is None or 0 < self._plain_until < time.monotonic():
            self._groups = self._group()
        found: dict[int, bytes] = {}
        for (address, fast), ids in self._groups.items():
            found |= self._ask(address, ids, fast)
        return found

    def _group(self) -> dict[tuple[int, bool], list[int]]:
        """Return the servos that are asked together, by the address of their state and whether they answer in one
        packet.
        """
        if self._plain_until < time.monotonic():
            self._plain_until = 0.0
        groups: dict[tuple[int, bool], list[int]] = {}
        for id, asked in sorted(self._asked.items(), key=lambda item: item[1].blames):
            groups.setdefault((asked.address, asked.fast and not self._plain_until), []).append(id)
        return groups

    def silent(self) -> list[int]:
        """Return the servos that haven't answered for so long that they only hold up the others."""
        now = time.monotonic()
        return [id for id, asked in self._asked.items() if asked.blames >= _BLAMES and now - asked.answered > _SILENCE]

    def _ask(self, address: int, ids: list[int], fast: bool) -> dict[int, bytes]:
        found = self._client.sync_read(address, STATE.size + self._extra, ids, fast)
        now = time.monotonic()
        missing = [id for id in ids if id not in found]
        for id in found:
            self._asked[id].blames, self._asked[id].answered = 0, now
        if missing:
            self._asked[missing[0]].blames += 1
            self._groups = None
            self._extra = (self._extra + 1) % _LENGTHS
            if fast:
                self._plain_until = now + _PLAIN
        return found


class _Absent(Record):
    """A servo that can't be used: why, when it is tried again, and how often it was."""

    reason: DeviceError
    due: float
    tries: int = 0


class DynamixelDriver:
    """Servos on a port. Raises DeviceError for unusable options.

    A servo that can't be used is named in each cycle and tried again from time to time; the others go on.
    """

    kinds: ClassVar[Sequence[str]] = ("joint",)
    needs_port: ClassVar[bool] = True

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        options = read_all(devices)
        self.rate = _RATE
        """Cycles a second: 100, or what the line carries."""
        self._servos = {own.id: Servo(device, own) for device, own in zip(devices, options, strict=True)}
        self._line = SerialLine(port, options[0].baud)
        self._client = ServoClient(self._line)
        self._polling = Polling(self._client)
        self._absent: dict[int, _Absent] = {}

    def open(self) -> None:
        """Find the servos. Raises DeviceError if none can be used now."""
        self._line.open()
        self._client = ServoClient(self._line)
        self._polling = Polling(self._client)
        self._absent = {}
        for servo in self._servos.values():
            self._find(servo)
        for _ in range(_MORE_TRIES):  # an answer may be late, and a robot that starts can wait for it
            for id in [id for id, absent in self._absent.items() if isinstance(absent.reason, DeviceSilent)]:
                self._find(self._servos[id])
        if len(self._absent) == len(self._servos):
            raise next(iter(self._absent.values())).reason
        self._client.delay = max(servo.delay for servo in self._servos.values())
        self.rate = min(_RATE, 1 / self._cycle_seconds())

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """Do one cycle: send goals to all servos, read all states, and try one that couldn't be used."""
        self._try_one()
        orders = {}
        for id, servo in self._servos.items():  # one that doesn't answer may hear: it rests
            target = JointTarget() if id in self._absent else commands.get(servo.name)
            orders[id] = servo.orders(target if isinstance(target, JointTarget) else None)
        self._send(orders)
        readings: dict[str, Reading | DeviceError] = {}
        for id, state in self._polling.read().items():
            servo = self._servos[id]
            try:
                readings[servo.name] = servo.reading(state)
            except ServoRestarted as problem:
                self._give_up(servo, problem, pause=0.0)
            except DeviceError as problem:
                readings[servo.name] = problem
        self._client.flush()  # where nobody was asked
        for id in self._polling.silent():
            servo = self._servos[id]
            self._give_up(servo, DeviceSilent(f"{servo.where} doesn't answer"))
        readings.update((self._servos[id].name, absent.reason) for id, absent in self._absent.items())
        return readings

    def close(self) -> None:
        """Hold or release the joints, as their option `at_end` says, and close the port."""
        with suppress(DeviceError):
            self._rest()
        self._line.close()

    def _find(self, servo: Servo, tries: int = 0) -> None:
        try:
            servo.make_ready(self._client)
            self._polling.add(servo.id, servo.state_address)
        except LineLost:
            raise
        except DeviceError as problem:
            pause = _PAUSES[min(tries, len(_PAUSES) - 1)]
            self._absent[servo.id] = _Absent(problem, time.monotonic() + pause, tries + 1)
        else:
            self._absent.pop(servo.id, None)
            self._client.delay = max(self._client.delay, servo.delay)

    def _try_one(self) -> None:
        if not self._absent:
            return
        now = time.monotonic()
        due = [(absent.due, id) for id, absent in self._absent.items() if absent.due <= now]
        if due:
            id = min(due)[1]
            self._find(self._servos[id], self._absent[id].tries)

    def _give_up(self, servo: Servo, reason: DeviceError, pause: float = _PAUSES[0]) -> None:
        self._polling.remove(servo.id)
        self._absent[servo.id] = _Absent(reason, time.monotonic() + pause)

    def _send(self, orders: Mapping[int, ServoCommands]) -> None:
        goals, torques, stopped = {}, {}, []
        for id, order in orders.items():
            if order.goal is not None:
                goals[id] = order.goal
            if order.torque is not None:
                torques[id] = bytes((order.torque,))
            if order.watchdog:
                stopped.append(id)
        self._client.sync_write(table.WATCHDOG, dict.fromkeys(stopped, b"\0"))  # else it would refuse the goal
        self._client.sync_write(table.PROFILE_VELOCITY, goals)
        self._client.sync_write(table.WATCHDOG, dict.fromkeys(stopped, bytes((WATCHDOG_SET,))))
        self._client.sync_write(table.TORQUE, torques)

    def _rest(self) -> None:
        present = [servo for id, servo in self._servos.items() if id not in self._absent]
        for id, state in self._polling.read().items():  # where they are now, not a moment ago
            with suppress(DeviceError):
                self._servos[id].reading(state)
        targets = {servo.id: JointTarget(loose=servo.options.at_end == "loose") for servo in self._servos.values()}
        for _ in range(2):  # nothing says whether it arrived
            self._send({id: self._servos[id].orders(target) for id, target in targets.items()})
            self._client.flush()
        for servo in present:
            try:
                self._client.write(servo.id, table.WATCHDOG, b"\0")
            except LineLost:
                raise
            except DeviceError:
                continue

    def _cycle_seconds(self) -> float:
        """Return how long all bytes of a cycle, and the delays of the servos, take on the line."""
        count = len(self._servos)
        sent = 2 * _PACKET + count * (1 + table.GOAL.size + 1)
        answers = count * (table.STATE.size + OVERHEAD)
        return self._line.seconds(sent + answers) + sum(servo.delay for servo in self._servos.values())
