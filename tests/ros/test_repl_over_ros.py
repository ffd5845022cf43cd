"""The prompt with a robot over ROS 2."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable

from tests.ros.processes import LONG, REPOSITORY, Command


def typed(lines: str, domain: int, *options: str) -> subprocess.CompletedProcess[str]:
    """The prompt, which reads these lines and has to end by itself."""
    command = [sys.executable, "-m", "btlang", "repl", *options]
    environment = {"PATH": "", "PYTHONPATH": str(REPOSITORY), "ROS_DOMAIN_ID": str(domain), "HOME": "/nowhere"}
    return subprocess.run(command, input=lines, env=environment, capture_output=True, text=True, timeout=LONG)


def test_it_moves_the_robot_that_is_there(start_sim: Callable[..., Command], domain: int) -> None:
    sim = start_sim()
    done = typed("say hello\nspeed max\nreset\nsay bye\n", domain, "--robot", "small", "--over", "ros")
    assert (done.returncode, done.stderr) == (0, "")
    assert "done   say hello" in done.stdout
    assert "This robot runs in real time." in done.stdout
    assert "done   say bye" in done.stdout
    sim.wait_for('says "bye"')


def test_it_says_what_is_missing_and_goes_on(domain: int, nav2: object) -> None:
    done = typed("say hello\nworld\n", domain, "--robot", "ros")
    assert done.returncode == 2
    assert "error BT101: 'say hello' needs the topic /speech" in done.stderr
    assert "where the robot is isn't known: " in done.stdout
    refused = typed("", domain, "--robot", "ros", "--speed", "max")
    assert "runs in real time, so it takes no --speed" in refused.stderr
