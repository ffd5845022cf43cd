"""What the task layer costs: tasks accepted, submission to first tick, and the emergency stop under load.

    python -m tests.benchmarks.task_layer [--stops 200] [--tasks 2000]

A robot is up in a process of its own. First tasks are sent over its socket as fast as it takes them; then single ones,
from the command to the first tick of their missions; then it is stopped again and again, over the socket that is for
that alone, while others send a thousand tasks a second: from the call to the answer, which comes when the robot has
been stopped. The last figures are the same with a limit of size on all files, as on a full disk.
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.commands.client import RobotClient, emergency_stop
from btlang.task.messages import Pause, Release, Resume, Show, Submit

_WANTED = 1000  # tasks a second
_FULL = 1_000_000  # bytes of a file, from which on nothing more can be written


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stops", type=int, default=200)
    parser.add_argument("--tasks", type=int, default=2000)
    options = parser.parse_args()
    with _robot(), RobotClient() as client:
        client.send(Pause())
        began = time.perf_counter()
        for _ in range(options.tasks):
            assert client.send(Submit("print hi")).ok
        print(f"accepted: {options.tasks / (time.perf_counter() - began):.0f} tasks a second")
    with _robot(), RobotClient() as client:
        print(f"submission to first tick: {_figures([_first_tick(client) for _ in range(50)])}")
        print(f"emergency stop under load: {_figures(_stops(client, options.stops))}")
    with _robot(full=True), RobotClient() as client:
        print(f"the same with a full disk: {_figures(_stops(client, options.stops))}")


@contextmanager
def _robot(full: bool = False) -> Iterator[None]:
    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (_FULL, _FULL))

    with tempfile.TemporaryDirectory() as folder:
        os.environ |= {"XDG_RUNTIME_DIR": folder, "XDG_DATA_HOME": folder}
        command = [sys.executable, "-m", "btlang", "robot", "up", "--no-recordings"]
        robot = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=limit if full else None
        )
        while not Path(folder, "btlang", "robot.stop.sock").exists():
            time.sleep(0.01)
        time.sleep(0.5)
        try:
            yield
        finally:
            robot.terminate()
            robot.wait(30)


def _first_tick(client: RobotClient) -> float:
    """By the robot's own clock: `created` to the change to underway, and one period at most until the tick."""
    task = client.send(Submit("print hi")).data["task"]
    while True:
        changes = client.send(Show(task["id"])).data["task"]["changes"]
        began = [change["time"] for change in changes if change["state"] == "underway"]
        if began:
            return float(began[0] - task["created"])
        time.sleep(0.01)


def _stops(client: RobotClient, count: int) -> list[float]:
    over = threading.Event()
    threads = [threading.Thread(target=_flood, args=(over,), daemon=True) for _ in range(4)]
    for thread in threads:
        thread.start()
    times = []
    client.send(Submit("go to the lab then go to the kitchen", priority=9))
    for _ in range(count):
        time.sleep(0.05)
        began = time.perf_counter()
        emergency_stop("robot")
        times.append(time.perf_counter() - began)
        client.send(Release())
        client.send(Resume())
    over.set()
    for thread in threads:
        thread.join()
    return times


def _flood(over: threading.Event) -> None:
    with RobotClient("robot") as client:
        while not over.is_set():
            try:
                client.send(Submit("move forward 1 m"))
            except MissionError:
                return
            time.sleep(4 / _WANTED / 2)


def _figures(times: list[float]) -> str:
    ordered = sorted(times)
    at = [ordered[min(len(ordered) - 1, int(len(ordered) * share))] for share in (0.95, 0.99)]
    return (
        f"median {median(times) * 1e3:.1f} ms, p95 {at[0] * 1e3:.1f} ms, p99 {at[1] * 1e3:.1f} ms, "
        f"the slowest {ordered[-1] * 1e3:.1f} ms"
    )


if __name__ == "__main__":
    main()
