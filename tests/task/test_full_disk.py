"""A disk that is full while a mission runs: no file of the robot's process may grow, as a limit of its size says."""

from __future__ import annotations

import resource
import time
from pathlib import Path

from btlang.task.store import open_store
from btlang.task.task import FINAL, State

from .layers import LONG, wait_until
from .test_crashes import Peer


def answer(peer: Peer) -> str:
    """The next one, after what was printed meanwhile."""
    until = time.monotonic() + LONG
    while time.monotonic() < until:
        line = peer.lines.get(timeout=LONG)
        if line.startswith("answer"):
            return line
    raise AssertionError("no answer")


def test_what_happens_on_a_full_disk_is_written_later(tmp_path: Path) -> None:
    def states() -> list[State]:
        return [task.state for task in store.tasks()]

    peer = Peer(tmp_path)
    store = open_store(str(tmp_path / "tasks.db"))  # once: whoever opens a store checks it, and holds up who writes
    peer.send(command="submit", text="wait 60 s then print over")
    assert answer(peer) == "answer 1"
    wait_until(lambda: states() == [State.UNDERWAY])
    resource.prlimit(peer.pid, resource.RLIMIT_FSIZE, (600, resource.RLIM_INFINITY))
    peer.send(command="submit", text="wave")
    refused = answer(peer)
    assert "error BT195" in refused
    assert "the disk may be full" in refused
    while peer.lines.get(timeout=LONG) != "printed over":
        pass
    peer.send(command="emergency_stop")
    assert "disk" not in answer(peer)
    wait_until(lambda: "emergency stop by ann" in (tmp_path / "emergency_stop").read_text())
    assert states() == [State.UNDERWAY]  # as far as the store knows
    resource.prlimit(peer.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    wait_until(lambda: states()[0] in FINAL)
    assert states()[0] in (State.COMPLETED, State.KILLED)  # the stop came in the tick in which the mission ended
    store.close()
    peer.end()
