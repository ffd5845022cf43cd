"""Fourteen servos at 100 cycles a second, beside dynamixel-sdk: `python -m tests.benchmarks.dynamixel [--seconds 10]`.

Simulated servos in a process of their own are on a pty; each cycle writes all goals and reads all states. The clients
take turns, each in a process of its own: how many cycles a second, how late does each begin, and what share of a core
does the thread take that reads and writes? Where the system allows it, clients and servos have real-time priority
(SCHED_FIFO) in a second round.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from dynamixel_sdk import COMM_SUCCESS, GroupSyncRead, GroupSyncWrite, PacketHandler, PortHandler

from btlang.devices.driver import Device, DeviceError
from btlang.devices.dynamixel.control_table import GOAL, LOAD, PROFILE_VELOCITY, TEMPERATURE
from btlang.devices.dynamixel.driver import DynamixelDriver
from btlang.devices.kinds import Command, JointState, JointTarget, Reading
from btlang.devices.loop import DeviceLoop

ROOT = Path(__file__).parents[2]
IDS = range(1, 15)
RATE = 100.0
WARM_UP = 1.0
_PRIORITY = 50


class Clock:
    """When cycles began, from the end of the warm-up on, and what its thread had taken of the processor then."""

    def __init__(self, seconds: float) -> None:
        self._begin = time.monotonic() + WARM_UP
        self.end = self._begin + seconds
        self.times: list[float] = []
        self._taken: list[float] = []

    def mark(self) -> None:
        """A cycle begins."""
        now = time.monotonic()
        if now >= self._begin:
            self.times.append(now)
            self._taken.append(time.thread_time())

    def figures(self, failed: int) -> dict[str, Any]:
        """What was measured. A cycle is late by what is between its time on a grid from the first one, which starts
        again after one that was late by a period."""
        late, due = [], self.times[0]
        for at in self.times:
            late.append(max(at - due, 0.0))
            due = (at if late[-1] > 1 / RATE else due) + 1 / RATE
        seconds = self.times[-1] - self.times[0]
        share = (self._taken[-1] - self._taken[0]) / seconds
        return {"rate": (len(late) - 1) / seconds, "late": sorted(late), "share": share, "failed": failed}


class MarkedDriver(DynamixelDriver):
    """Tells a clock of each cycle."""

    clock: Clock
    failed = 0

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        self.clock.mark()
        told = super().exchange(commands)
        self.failed += sum(isinstance(told.get(f"j{id}"), JointState) for id in IDS) != len(IDS)
        return told


def btlang_client(port: str, seconds: float, missing: tuple[int, ...] = ()) -> dict[str, Any]:
    """The loop of devices with the driver; new goals come 20 times a second from another thread, as from ticks."""
    devices = tuple(Device(f"j{id}", "joint", "dynamixel", port, {"id": id}) for id in (*IDS, *missing))
    driver = MarkedDriver(port, devices)
    driver.clock = clock = Clock(seconds)
    loop = DeviceLoop(driver, devices)
    loop.start()
    while time.monotonic() < clock.end:
        for device in devices:
            loop.write(device.name, JointTarget(10.0 * math.sin(time.monotonic())))
        time.sleep(0.05)
    figures = clock.figures(driver.failed)
    loop.close()
    return figures


def silent_client(port: str, seconds: float) -> dict[str, Any]:
    """The same with one servo more, which doesn't answer."""
    return btlang_client(port, seconds, missing=(100,))


def sdk_client(port: str, seconds: float) -> dict[str, Any]:
    """Without loop and threads, dynamixel-sdk alone: a sync write and a fast sync read in each cycle."""
    handler, line = PacketHandler(2.0), PortHandler(port)
    line.setBaudRate(1_000_000)
    write = GroupSyncWrite(line, handler, PROFILE_VELOCITY, GOAL.size)
    read = GroupSyncRead(line, handler, LOAD, TEMPERATURE + 1 - LOAD)
    for id in IDS:
        read.addParam(id)
        write.addParam(id, list(GOAL.pack(100, 2100)))
    clock, failed = Clock(seconds), 0
    due = time.monotonic()
    while time.monotonic() < clock.end:
        clock.mark()
        write.txPacket()
        failed += read.fastSyncRead() != COMM_SUCCESS
        due = max(due + 1 / RATE, time.monotonic() - 1 / RATE)
        time.sleep(max(due - time.monotonic(), 0.0))
    return clock.figures(failed)


CLIENTS: dict[str, Callable[[str, float], dict[str, Any]]] = {
    "btlang": btlang_client,
    "btlang, one silent": silent_client,
    "dynamixel-sdk": sdk_client,
}


def measured(client: str, port: str, seconds: float, real_time: bool) -> dict[str, Any]:
    """The figures of one client in a process of its own."""
    command = [sys.executable, "-m", "tests.benchmarks.dynamixel", "--client", client, "--port", port]
    command += ["--seconds", str(seconds), *(["--real-time"] if real_time else [])]
    done = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    figures: dict[str, Any] = json.loads(done.stdout)
    return figures


def allows_real_time() -> bool:
    """Whether this process may have real-time priority; it has not got it afterwards."""
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        return True
    return False


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="Fourteen Dynamixel servos at 100 cycles a second.")
    options.add_argument("--seconds", type=float, default=10.0)
    options.add_argument("--client", choices=CLIENTS, help=argparse.SUPPRESS)
    options.add_argument("--port", help=argparse.SUPPRESS)
    options.add_argument("--real-time", action="store_true", help=argparse.SUPPRESS)
    given = options.parse_args()
    if given.client:
        if given.real_time:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
        print(json.dumps(CLIENTS[given.client](given.port, given.seconds)))
        return
    command = [sys.executable, "-m", "btlang.devices.dynamixel.fake_bus", *map(str, IDS)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as bus:
        try:
            assert bus.stdout is not None
            port = bus.stdout.readline().strip()
            print("late, ms: median, 99th percentile and most; share of a core; cycles that were not answered in full")
            for real_time in (False, True) if allows_real_time() else (False,):
                if real_time:  # servos don't wait for a computer that has other things to do
                    for thread in Path(f"/proc/{bus.pid}/task").iterdir():
                        os.sched_setscheduler(int(thread.name), os.SCHED_FIFO, os.sched_param(_PRIORITY))
                for client in CLIENTS:
                    show(client, real_time, measured(client, port, given.seconds, real_time))
        finally:
            bus.send_signal(signal.SIGINT)


def show(client: str, real_time: bool, figures: Mapping[str, Any]) -> None:
    """One line of figures."""
    late = figures["late"]
    told = " ".join(f"{late[min(int(len(late) * p), len(late) - 1)] * 1e3:7.3f}" for p in (0.5, 0.99, 1))
    name = f"{client}{', real time' if real_time else ''}"
    print(f"{name:30} {figures['rate']:6.2f} Hz  late {told}  {figures['share']:6.1%}  {figures['failed']}", flush=True)


if __name__ == "__main__":
    main()
