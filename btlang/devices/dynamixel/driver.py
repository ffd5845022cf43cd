"""The driver `dynamixel`: joints made of servos of the X series on one port."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import ClassVar

from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.client import Client
from btlang.devices.dynamixel.line import LineLost, SerialLine
from btlang.devices.dynamixel.options import read_all
from btlang.devices.dynamixel.polling import Polling
from btlang.devices.dynamixel.protocol import OVERHEAD
from btlang.devices.dynamixel.servo import WATCHDOG_SET, Orders, Restarted, Servo
from btlang.devices.kinds import Command, JointTarget, Reading
from btlang.support.record import Record

_RATE = 100.0
_MORE_TRIES = 2  # to find a servo when the line is opened
_PAUSES = (0.1, 0.2, 0.4, 1.0)
"""Seconds until a servo that can't be used is tried again, the last of them from then on."""
_PACKET = 14  # bytes of a packet to all servos, beside those of each


class _Absent(Record):
    """Why a servo can't be used, when it is tried again, and how often it was."""

    reason: DeviceError
    due: float
    tries: int = 0


class DynamixelDriver:
    """Servos on a port. Raises DeviceError for options that it can't use.

    A servo that can't be used is named in each cycle and tried again from time to time; the others go on.
    """

    kinds: ClassVar[Sequence[str]] = ("joint",)
    needs_port: ClassVar[bool] = True

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        options = read_all(devices)
        self.rate = _RATE
        """100, or what the line carries."""
        self._servos = {own.id: Servo(device, own) for device, own in zip(devices, options, strict=True)}
        self._line = SerialLine(port, options[0].baud)
        self._client = Client(self._line)
        self._polling = Polling(self._client)
        self._absent: dict[int, _Absent] = {}

    def open(self) -> None:
        """Finds the servos. Raises DeviceError if none can be used now."""
        self._line.open()
        self._client = Client(self._line)
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
        """One cycle: goals to all servos, the state from all, and a try with one that could not be used."""
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
            except Restarted as problem:
                self._lose(servo, problem, pause=0.0)
            except DeviceError as problem:
                readings[servo.name] = problem
        self._client.flush()  # where nobody was asked
        for id in self._polling.silent():
            servo = self._servos[id]
            self._lose(servo, DeviceSilent(f"{servo.where} doesn't answer"))
        readings.update((self._servos[id].name, absent.reason) for id, absent in self._absent.items())
        return readings

    def close(self) -> None:
        """Joints hold where they are or let go, as their option `at_end` says; the port is free then."""
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

    def _lose(self, servo: Servo, reason: DeviceError, pause: float = _PAUSES[0]) -> None:
        self._polling.remove(servo.id)
        self._absent[servo.id] = _Absent(reason, time.monotonic() + pause)

    def _send(self, orders: Mapping[int, Orders]) -> None:
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
        """How long all bytes of a cycle take on the line, and the servos to begin their answers."""
        count = len(self._servos)
        sent = 2 * _PACKET + count * (1 + table.GOAL.size + 1)
        answers = count * (table.STATE.size + OVERHEAD)
        return self._line.seconds(sent + answers) + sum(servo.delay for servo in self._servos.values())
