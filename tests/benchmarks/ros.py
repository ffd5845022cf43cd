"""What a mission costs on a ROS 2 robot, beside rclpy alone: `python -m tests.benchmarks.ros [--rounds 3]`.

A robot in a process of its own publishes five topics, serves two actions and hears /cmd_vel over real DDS. First
missions at 100 ticks a second and a bare loop of rclpy take turns: is the rate held, what does each thread cost, and
how long is it from the start of a command that drives to its first velocity at the robot? Then goals are sent to
`btc ros-node --robot ros` and to a bare action server in turn: how long is it from there to the first velocity? The
last lines are ratios of medians. Needs btlang_interfaces and nav2_msgs (see docs/ros.md).
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

from btlang_interfaces.action import RunMission
from rclpy.action import ActionClient

from btlang.ros.node import SpunNode
from tests.benchmarks.ros_programs import APART, FEEDBACK, RATE, TOPICS
from tests.ros.client import answer
from tests.ros.domains import free_domain

ROOT = Path(__file__).parents[2]
GOALS = 10  # of a round, for each server
MISSION = f"move forward 10 m for {APART} s"


@contextmanager
def started(*arguments: str, ready: str = "ready") -> Iterator[subprocess.Popen[str]]:
    """A process that has said that it is ready; it is ended by a signal."""
    process = subprocess.Popen([sys.executable, "-m", *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        if not any(ready in line for line in iter(process.stdout.readline, "")):
            sys.exit(f"{arguments[0]} ended with {process.wait()}")
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate()


def measured(program: str, folder: Path, seconds: float) -> dict[str, Any]:
    """The figures of one run of a program of ros_programs."""
    report = folder / f"{program}.json"
    command = [sys.executable, "-m", "tests.benchmarks.ros_programs", program, str(report), str(seconds)]
    subprocess.run(command, cwd=ROOT, check=True)
    figures: dict[str, Any] = json.loads(report.read_text(encoding="utf-8"))
    return figures


def sent(seconds: float) -> dict[str, list[float]]:
    """When goals were sent to both servers in turn, each once the one before has ended."""
    times: dict[str, list[float]] = {"btlang": [], "bare": []}
    with SpunNode("user") as spun:
        clients = {name: ActionClient(spun.node, RunMission, f"/{name}/run_mission") for name in times}
        for client in clients.values():
            client.wait_for_server()
        time.sleep(1.0)  # a server that has not found the client's reader yet would drop its answer

        def send(name: str) -> Any:
            times[name].append(time.monotonic())
            return clients[name].send_goal_async(RunMission.Goal(mission=MISSION))

        for _ in range(int(seconds)):
            for name in times:
                handle = answer(answer(spun.node.executor.create_task(send, name)))
                assert handle.accepted
                answer(answer(spun.node.executor.create_task(handle.get_result_async)))
                time.sleep(APART)
    return times


def delays(starts: Sequence[float], arrivals: Sequence[tuple[float, float]]) -> list[float]:
    """From each start until the first velocity that is not zero came; a start that nothing followed does not count."""
    moving = [at for at, speed in arrivals if speed]
    after = [next((at - start for at in moving if at >= start), None) for start in starts]
    return [delay for delay in after if delay is not None and delay < 2.0]


def told(values: Sequence[float]) -> str:
    """Milliseconds: the median, the 99th percentile and the worst."""
    ordered = sorted(values)
    return " ".join(f"{ordered[min(int(len(ordered) * p), len(ordered) - 1)] * 1e3:7.2f}" for p in (0.5, 0.99, 1))


def share(runs: list[dict[str, Any]], clock: int) -> float:
    """The share of one core that a clock of `Marks` counted, as a median of runs."""
    shares: list[float] = [
        (run["ticks"][-1][clock] - run["ticks"][0][clock]) / (run["ticks"][-1][0] - run["ticks"][0][0]) for run in runs
    ]
    return median(shares)


def show(name: str, runs: list[dict[str, Any]]) -> None:
    """The figures of one side."""
    times = [[tick[0] for tick in run["ticks"]] for run in runs]
    rate = median((len(run) - 1) / (run[-1] - run[0]) for run in times)
    late = [max(0.0, b - a - 1 / RATE) for run in times for a, b in pairwise(run)]
    tick, spin, whole = (share(runs, clock) for clock in (1, 2, 3))
    print(f"{name:7} {rate:6.2f} ticks a second; each later than due by, ms (p50 p99 max) {told(late)}")
    print(f"        CPU: thread that ticks {tick:.1%}, that spins {spin:.1%}, DDS and others {whole - tick - spin:.1%}")


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="What a mission costs on a ROS 2 robot.")
    options.add_argument("--seconds", type=float, default=8.0)
    options.add_argument("--rounds", type=int, default=3)
    given = options.parse_args()
    runs: dict[str, list[dict[str, Any]]] = {"mission": [], "bare": []}
    with ExitStack() as stack:
        domain = stack.enter_context(free_domain())
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        os.environ |= {
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "FASTRTPS_DEFAULT_PROFILES_FILE": str(ROOT / "tests" / "ros" / "fast_discovery.xml"),
        }
        report = folder / "robot.json"
        with started("tests.benchmarks.ros_programs", "robot", str(report)):
            for _ in range(given.rounds):
                for program, those in runs.items():
                    those.append(measured(program, folder, given.seconds))
            with (
                started("btlang", "ros-node", "--robot", "ros"),
                started("tests.benchmarks.ros_programs", "bare-server", str(folder / "server.json")),
            ):
                goals = sent(given.rounds * GOALS)
        arrivals = json.loads(report.read_text(encoding="utf-8"))["arrivals"]
    rates = ", ".join(f"{name} {rate:g}" for name, (_, rate) in TOPICS.items())
    print(f"topics, messages a second: {rates}; two goals with {FEEDBACK:g} feedbacks a second")
    for name, those in runs.items():
        show(name, those)
    started_at = {name: [start for run in those for start in run["starts"]] for name, those in runs.items()}
    command = {name: delays(starts, arrivals) for name, starts in started_at.items()}
    goal = {name: delays(starts, arrivals) for name, starts in goals.items()}
    print("until the first velocity is at the robot, ms (p50 p99 max):")
    for what, found in (("start of a command", command), ("goal sent", goal)):
        for name, values in found.items():
            print(f"  {what:18} {name:7} {told(values)}  of {len(values)}")
    print(f"start of a command {median(command['mission']) / median(command['bare']):.1f}")
    print(f"goal sent {median(goal['btlang']) / median(goal['bare']):.1f}")


if __name__ == "__main__":
    main()
