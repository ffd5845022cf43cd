"""How many tasks a second the stores accept, and how many they give out and end.

    python -m tests.benchmarks.task_store [--tasks 3000] [--kept 20000] [--threads 4]

Each kind of store is measured with and without `durable`: empty, with as many ended tasks as are `kept`, and from
several threads. The first line is what the disk does alone: one small write that is brought to it.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from btlang.task.store.records import MissionText, Task, TaskState
from btlang.task.store.task_store import TaskStore, open_store
from tests.task.places import connection, new_place, server

MISSION = MissionText("go to the lobby then say hello then go to the dock", "tour", values={"speed": 0.5})
TASK = Task(0, MISSION, "ada", 100.0, labels=("day", "guests"), needs=("base", "voice"))


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", type=int, default=3_000)
    parser.add_argument("--kept", type=int, default=20_000)
    parser.add_argument("--threads", type=int, default=4)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print(f"one fsync: {1e3 / _rate(100, _synced(Path(folder, 'alone'))):.2f} ms")
        connection().execute("ALTER SYSTEM RESET fsync")  # which tests go without
        connection().execute("SELECT pg_reload_conf()")
        first: dict[str, float] = {}
        for kind in ("sqlite", "postgres"):
            for durable in (False, True):
                with open_store(new_place(kind, Path(folder)), durable) as store:
                    print(f"{kind}{', durable' if durable else ''}, a second:")
                    for name, rate in _measured(store, options.tasks, options.kept, options.threads).items():
                        ratio = rate / first.setdefault(name, rate)
                        print(f"  {name}: {rate:,.0f}, {ratio:.2f} times the first")
    server().cleanup()


def _measured(store: TaskStore, tasks: int, kept: int, threads: int) -> dict[str, float]:
    def add(_: int) -> None:
        store.add(TASK)

    def work(_: int) -> None:
        task = store.claim(200.0)
        assert task is not None
        store.change(task.id, [TaskState.STANDBY], TaskState.COMPLETED, time=201.0, cause="done", ended=201.0)

    rates = {"add": _rate(tasks, add), "claim and change": _rate(tasks, work)}
    for _ in range(max(kept - tasks, 0)):
        store.add(TASK.replace(state=TaskState.COMPLETED))
    full = f" with {kept:,} ended"
    rates |= {"add" + full: _rate(tasks, add), "claim and change" + full: _rate(tasks, work)}
    with ThreadPoolExecutor(threads) as pool:
        for name, call in (("add", add), ("claim and change", work)):
            began = time.perf_counter()
            list(pool.map(call, range(tasks)))
            rates[f"{name} from {threads} threads"] = tasks / (time.perf_counter() - began)
    return rates


def _rate(count: int, call: Callable[[int], None]) -> float:
    began = time.perf_counter()
    for at in range(count):
        call(at)
    return count / (time.perf_counter() - began)


def _synced(path: Path) -> Callable[[int], None]:
    def write(_: int) -> None:
        with path.open("ab") as file:
            file.write(b"x" * 100)
            file.flush()
            os.fsync(file.fileno())

    return write


if __name__ == "__main__":
    main()
