"""Twenty components that are killed, stopped, fail to start, hang and lose answers, in random order.

Death is noticed within a second, service is back within three, no process is left over, and the robot stands while what
moved it is gone. Times are only asserted in the long profile: a few faults of it are in the suite.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.components.component import ACTIVE
from btlang.components.manager import ComponentKeeper
from tests.components.robots import robot_file
from tests.profiles import amount

NAMES = [f"m{n}" for n in range(20)]
FAULTS = "kill", "stop", "raise", "hang", "lose"
PART = '[[component]]\nname = "member {n}"\nclass = "storm:Member{n}"\nlimit = 1.0\nrestarts = 1000\n'
WORD = """
[[action]]
phrase = "roll by {name}"
id = "RollBy{n}"
call = "storm:Member{n}.roll"
needs = ["base"]
help = "Rolls on."
example = "roll by {name}"
"""


def storm(folder: Path, count: int) -> str:
    """A robot with so many components that go wrong, each with a word."""
    members = list(enumerate(NAMES))[:count]
    robot = robot_file(folder, "".join(PART.format(n=n) for n, _ in members))
    words = "".join(WORD.format(n=n, name=name) for n, name in members)
    (folder / "storm.toml").write_text(words, encoding="utf-8")
    return robot


@pytest.mark.long
def test_twenty_components_in_a_storm(tmp_path: Path) -> None:
    many, chance = amount(len(NAMES), 500), random.Random(1)
    robot = storm(tmp_path, len(NAMES))
    order = [n for _ in range(many // len(NAMES)) for n in chance.sample(range(len(NAMES)), len(NAMES))]
    noticed, back, processes = [], [], set[int]()
    with btlang.Session(robot) as session:
        manager = session.connection.manager  # type: ignore[attr-defined]
        assert manager.wait(60), manager.statuses()
        start = session.robot.pose
        for at, n in enumerate(order):
            keeper = manager.keeper(f"member {n}")
            processes.add(keeper.status().process)
            run = None
            if at % 4 == 0:
                run = session.start(btlang.parse_tree(f"roll by {NAMES[n]}", keywords=[str(tmp_path / "storm.toml")]))
                wait_until(lambda: session.robot.velocity[0] > 0.1)
            began = time.monotonic()
            hit(keeper, FAULTS[at % len(FAULTS)], tmp_path)
            wait_until(lambda keeper=keeper: keeper.state != ACTIVE)
            noticed.append(time.monotonic() - began)
            if run is not None:
                outcome = run.wait(30)
                assert outcome is not None
                assert (outcome.succeeded, session.robot.velocity) == (False, (0.0, 0.0))
                assert f"member {n}" in outcome.why()
                session.robot.put(start)
            if many > len(NAMES):  # else they come back while others are hit
                wait_until(lambda keeper=keeper: keeper.state == ACTIVE)
                back.append(time.monotonic() - began)
        wait_until(lambda: all(status.state == ACTIVE for status in manager.statuses()), 90.0)
        processes |= {status.process for status in manager.statuses()}
    wait_until(lambda: not running_in(processes))
    if many > len(NAMES):
        slowest = sorted(zip(back, (FAULTS[at % len(FAULTS)] for at in range(many)), strict=True))[-5:]
        print(slowest)
        print(f"of {many}: noticed after {max(noticed):.2f} s, back after {max(back):.2f} s at the latest")
        assert max(noticed) < 1.0
        assert max(back) < 3.0


def test_a_robot_that_is_killed_leaves_no_component(tmp_path: Path) -> None:
    """Not even one that is stopped, and can't notice."""
    program = "import btlang, sys\nwith btlang.Session(sys.argv[1]) as s:\n" + (
        "    print(*(each.process for each in s.connection.manager.statuses()), flush=True)\n    sys.stdin.read()"
    )
    robot = storm(tmp_path, 2)
    up = [sys.executable, "-c", program, robot]
    with subprocess.Popen(up, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        components = [int(each) for each in process.stdout.readline().split()]
        assert len(components) == 2
        assert len(running_in(set(components))) >= 4
        os.kill(components[0], signal.SIGSTOP)
        process.kill()
    wait_until(lambda: not running_in(set(components)))


def running_in(groups: set[int | None]) -> list[int]:
    """The processes in these process groups: components, and what they have started."""
    found = []
    for each in filter(str.isdigit, os.listdir("/proc")):
        try:
            stat = Path(f"/proc/{each}/stat").read_text(encoding="utf-8", errors="replace").rsplit(")", 1)[1].split()
        except OSError:  # it has just ended
            continue
        if int(stat[2]) in groups and stat[0] != "Z":
            found.append(int(each))
    return found


def hit(keeper: ComponentKeeper, fault: str, folder: Path) -> None:
    """It dies, and may go wrong when it is started again."""
    if fault in ("raise", "hang", "lose"):
        (folder / f"{keeper.part.name}.plan").write_text(fault, encoding="utf-8")
    process = keeper.status().process
    assert process is not None
    os.kill(process, signal.SIGSTOP if fault == "stop" else signal.SIGKILL)


def wait_until(holds: Any, seconds: float = 30.0) -> None:
    until = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < until
        time.sleep(0.005)
