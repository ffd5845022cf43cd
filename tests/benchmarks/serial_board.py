"""What a board costs: `python -m tests.benchmarks.serial_board [--rate 100] [--seconds 10]`.

A simulated board with one channel of each kind runs in another process, on a pty. Printed are the cycles a second that
are reached, how late they begin and how long their answers take (median and p99), and the share of a core.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Mapping
from statistics import quantiles

from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Command, Reading, WheelSpeeds
from btlang.devices.loop import DeviceLoop
from btlang.devices.serial_board.driver import SerialBoard
from tests.devices.boards import devices


class TimedBoard(SerialBoard):
    """Keeps when its cycles began and how long they took."""

    def __init__(self, port: str, rate: float) -> None:
        super().__init__(port, devices(port, rate=rate, baud=921_600))
        self.began: list[float] = []
        self.took: list[float] = []

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """See Driver."""
        self.began.append(time.perf_counter())
        told = super().exchange(commands)
        self.took.append(time.perf_counter() - self.began[-1])
        return told


def milliseconds(values: list[float]) -> str:
    """Median and p99."""
    parts = quantiles(values, n=100)
    return f"{parts[49] * 1000:.2f} ms, p99 {parts[98] * 1000:.2f} ms"


def main(rate: float, seconds: float) -> None:
    """Runs it once."""
    program = [sys.executable, "-m", "btlang.devices.serial_board.simulated_board", "base"]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as board:
        assert board.stdout is not None
        port = board.stdout.readline().strip()
        driver = TimedBoard(port, rate)
        loop = DeviceLoop(driver, devices(port))
        loop.start()
        try:
            while any(map(loop.silent, loop.devices)):
                time.sleep(0.05)
            driver.began.clear()
            driver.took.clear()
            wall, cpu = time.perf_counter(), time.process_time()
            while time.perf_counter() - wall < seconds:
                loop.write("drive", WheelSpeeds(0.3, 0.3))
                time.sleep(0.05)
            wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        finally:
            loop.close()
            board.kill()
    late = [abs(then - before - 1 / rate) for before, then in zip(driver.began, driver.began[1:], strict=False)]
    print(f"cycles a second  {len(driver.began) / wall:.1f} of {rate:g}")
    print(f"off the period   {milliseconds(late)}")
    print(f"question, answer {milliseconds(driver.took)}")
    print(f"share of a core  {cpu / wall:.1%}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    chosen = parser.parse_args()
    main(chosen.rate, chosen.seconds)
