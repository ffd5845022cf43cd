"""A robot whose process is killed at any moment: nothing that it acknowledged is lost, and nothing is done twice."""

from __future__ import annotations

import json
import os
import queue
import random
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest

from btlang.task.store import open_store
from btlang.task.task import FINAL, State
from tests.profiles import amount

from .layers import LONG, wait_until

TWENTY = """
whenever n is 7, print "rule"
repeat 5 times: repeat 4 times: increase n then print "{n}" then wait 0.2 s
"""


class Peer:
    """A robot in another process."""

    def __init__(self, folder: Path) -> None:
        command = [sys.executable, "-m", "tests.task.peer", str(folder)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.lines: queue.Queue[str] = queue.Queue()
        self._thread = threading.Thread(target=self._read)
        self._thread.start()
        assert self.lines.get(timeout=LONG) == "up"

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.lines.put(line.strip())
        self.lines.put("")

    def send(self, **command: object) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(command) + "\n")
        self._process.stdin.flush()

    def kill(self) -> list[str]:
        """What it still wrote."""
        os.kill(self._process.pid, signal.SIGKILL)
        return self._rest()

    def end(self) -> list[str]:
        assert self._process.stdin is not None
        self._process.stdin.close()
        return self._rest()

    def _rest(self) -> list[str]:
        self._process.wait(LONG)
        self._thread.join(LONG)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(BrokenPipeError):
            self._process.stdin.close()
        self._process.stdout.close()
        lines = []
        while line := self.lines.get(timeout=LONG):
            lines.append(line)
        return lines


def values(folder: Path) -> tuple[dict[str, object], State]:
    """The values of the run of task 1 as they were saved, and its state."""
    with open_store(str(folder / "tasks.db")) as store:
        task = store.task(1)
        assert task is not None
        saved = json.loads(task.saved or "{}")
        return dict(saved["scopes"][0]["values"]) if "scopes" in saved else {}, task.state


def is_over(folder: Path) -> bool:
    return values(folder)[1] in FINAL


@pytest.mark.long
def test_a_task_that_is_resumed_does_nothing_again(tmp_path: Path) -> None:
    moments = range(1, 21) if amount(0, 1) else (1, 7, 8, 20)
    for moment in moments:
        folder = tmp_path / str(moment)
        peer = Peer(folder)
        peer.send(command="submit", text=TWENTY, values={"n": 0}, restart="resume")
        seen = []
        while f"printed {moment}" not in seen:
            seen.append(peer.lines.get(timeout=LONG))
        seen += peer.kill()
        known, _ = values(folder)
        recorded = known.get("n", 0)
        assert isinstance(recorded, int)
        assert recorded in (moment - 1, moment, moment + 1)
        peer = Peer(folder)
        wait_until(partial(is_over, folder))
        again = peer.end()
        numbers = [line.split()[1] for line in again if line.startswith("printed") and line != "printed rule"]
        assert numbers == [str(number) for number in range(recorded + 1, 21)]
        rules = [*seen, *again].count("printed rule")
        assert rules == 1 or (rules == 2 and recorded <= 7)  # the end of that print was not yet recorded
        assert values(folder)[1] is State.COMPLETED


@pytest.mark.long
def test_nothing_acknowledged_is_lost_and_nothing_ends_twice(tmp_path: Path) -> None:
    kills, most = amount(3, 200), amount(40, 1000)
    draw = random.Random(1)
    acknowledged: set[int] = set()
    sent, slowest = 0, 0.0
    for _ in range(kills):
        began = time.monotonic()
        peer = Peer(tmp_path)
        slowest = max(slowest, time.monotonic() - began)
        until = time.monotonic() + draw.uniform(0.0, 0.4)
        while time.monotonic() < until and sent < most:
            restart = ("give up", "again", "resume")[sent % 3]
            peer.send(command="submit", text=f"print {sent} then wait 0.5 s then nod", restart=restart)
            sent += 1
            time.sleep(draw.uniform(0.0, 0.003))
        answers = [line for line in peer.kill() if line.startswith("answer")]
        assert not [line for line in answers if "refused" in line]
        acknowledged |= {int(line.split()[1]) for line in answers}
    peer = Peer(tmp_path)
    with open_store(str(tmp_path / "tasks.db")) as store:
        until = time.monotonic() + 600
        while store.tasks({state for state in State if state not in FINAL}):
            assert time.monotonic() < until
            time.sleep(0.2)
        tasks = {task.id: task for task in store.tasks()}
        assert acknowledged <= tasks.keys()
        for number in tasks:
            states = [change.state for _, change in store.changes(number)]
            assert [state in FINAL for state in states] == [False] * (len(states) - 1) + [True]
        ends = {task.restart: set[State]() for task in tasks.values()}
        for task in tasks.values():
            ends[task.restart].add(task.state)
    peer.end()
    assert acknowledged
    print(f"{kills} kills, {len(acknowledged)} tasks acknowledged; the slowest start took {slowest:.1f} s", ends)
