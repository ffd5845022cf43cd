"""What is left on the machine and in the ROS graph when missions have ended: nothing."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.profiles import amount
from tests.ros.client import check_nodes
from tests.ros.processes import LONG, Command

RUNS = amount(2, 20)
LOST = 1
"""The segments that Fast DDS may leave: once in a thousand ends a thread of its own holds one for a moment too long.

A node that isn't destroyed would leave one in each run.
"""
SHARED = {"FASTDDS_BUILTIN_TRANSPORTS": None}
"""As Fast DDS is by default: with shared memory."""


def segments(process: int) -> set[str]:
    """The shared memory of Fast DDS that a process has mapped; none when it has ended.

    Without its ports: these have few names, which the next participants use again, those of other tests too.
    """
    try:
        maps = Path(f"/proc/{process}/maps").read_text(encoding="utf-8")
    except (FileNotFoundError, ProcessLookupError):
        return set()
    return set(re.findall(r"/dev/shm/fastrtps_[0-9a-f]{16}", maps))


@pytest.mark.long
def test_missions_in_a_row(start_sim: Callable[..., Command], domain: int, tmp_path: Path) -> None:
    sim = start_sim("--speed", "1", **SHARED)
    check_nodes(domain, "btlang_sim")
    used = segments(sim.process.pid)
    assert used
    for number in range(RUNS):
        folder = tmp_path / str(number)
        folder.mkdir()
        mission = Command(folder, domain, "run", "--robot", "ros", "-c", "print done", "--quiet", **SHARED)
        own, until = set(), time.monotonic() + LONG
        while mission.process.poll() is None and time.monotonic() < until:
            own |= segments(mission.process.pid)
            time.sleep(0.01)
        assert own - used, "no segment of its own was seen"
        used |= own
        assert (mission.end(), mission.err) == (0, "")  # and no process of its group is left
    check_nodes(domain, "btlang_sim")
    assert sim.end() == 130
    check_nodes(domain)
    left = [segment for segment in used if Path(segment).exists() or Path(f"{segment}_el").exists()]
    assert len(left) <= LOST, left
