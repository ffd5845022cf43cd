"""What components and devices cost: `python -m tests.benchmarks.components`.

The examples on the simulated robot, and over simulated devices; and the words of a component, in the robot's process
and in one of its own.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import btlang
from btlang.cli.examples import examples
from btlang.components.words import robot_words
from btlang.robots.platforms import ALL
from btlang.robots.registry import connector
from btlang.vocabulary.shipped import shipped
from tests.components.robots import machine, robot_file

_ROUNDS = 5
_WORDS = 200


def main() -> None:
    """Prints the figures."""
    usual, over = ([_examples(robot) for _ in range(_ROUNDS)] for robot in (_simulated(), _over_devices()))
    one, other = statistics.median(usual), statistics.median(over)
    print(f"all examples, simulated robot  {one:6.2f} s")
    print(f"the same, over its devices     {other:6.2f} s   {other / one:.2f} times")
    for runs in ("here", "process"):
        with tempfile.TemporaryDirectory() as folder:
            _words(runs, Path(folder))


def _simulated() -> Any:
    return connector("simulated")


def _over_devices() -> Any:
    return connector("standard", "devices", simulate=[ALL])


def _examples(robot: Any) -> float:
    passed = 0.0
    folder = Path(shipped("examples"))
    for example in examples():
        world = str(folder / "worlds" / Path(example.world).name) if example.world else None
        mission = btlang.parse_file(str(folder / f"{example.name}.txt"), world=world)
        with btlang.Session(robot, world=mission.world) as session:
            began = time.perf_counter()
            session.run(mission, speed="max", seed=1, time_limit=300.0)
            passed += time.perf_counter() - began
    return passed


def _words(runs: str, folder: Path) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"'))
    command = btlang.parse_tree(f"repeat {_WORDS} times: brew tea", keywords=robot_words(robot))
    question = btlang.parse_tree(
        f"repeat {_WORDS} times: try check that something was brewed", keywords=robot_words(robot)
    )
    began = time.perf_counter()
    with btlang.Session(robot) as session:
        up = time.perf_counter() - began
        each = [_timed(session, mission) / _WORDS * 1000 for mission in (command, question)]
    where = "the robot's process" if runs == "here" else "a process of its own"
    print(f"in {where}: up in {up * 1000:.0f} ms, a command of two ticks {each[0]:.2f} ms, a question {each[1]:.2f} ms")


def _timed(session: btlang.Session, mission: btlang.Mission) -> float:
    began = time.perf_counter()
    session.run(mission, speed="max")
    return time.perf_counter() - began


if __name__ == "__main__":
    main()
