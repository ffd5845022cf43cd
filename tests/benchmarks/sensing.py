"""What conditions of the robot cost: `python -m tests.benchmarks.sensing [--rounds 9]`.

2,000 of those that ship, asked at each tick of a run on the simulated robot, which takes a step in between: how long
each takes, and the share of a core at 20 ticks a second, in time of the thread.
"""

from __future__ import annotations

import argparse
import math
import time
from itertools import cycle, islice
from statistics import median

import btlang
from btlang.session import Session
from btlang.tree.node import Node, Tree

COUNT, RATE = 2_000, 20.0
ASKED = (
    "the path is clear",
    "there is a wall on the left",
    "Bob is near",
    "someone is near",
    "the battery is low",
    "the robot is at the kitchen",
    "Bob is in the kitchen",
    "the robot is holding the cup",
)


def seconds(asked: tuple[str, ...], rounds: int) -> float:
    """The median time of a tick that asks COUNT conditions, these in turn."""
    missions = [btlang.parse_tree(f"if {words} then stop") for words in asked]
    leaves = [next(node for node in mission.tree.walk() if not node.children) for mission in missions]
    guarded = tuple(Node("ForceSuccess", (leaf,)) for leaf in islice(cycle(leaves), COUNT))
    tree = Tree(Node("ReactiveSequence", (*guarded, Node("Sleep", (), (("msec", "1000000000"),)))))
    taken = []
    with Session() as session:
        run = session.prepare(missions[0].replace(tree=tree, syntax=None), speed=math.inf)
        for _ in range(rounds + 2):
            began = time.thread_time()
            run.nodes.tick()
            taken.append(time.thread_time() - began)
            session.robot.step(1 / RATE)
    return median(taken[2:])


def main() -> None:
    """Prints the figures."""
    options = argparse.ArgumentParser(description="What conditions of the robot cost.")
    options.add_argument("--rounds", type=int, default=9)
    rounds = options.parse_args().rounds
    for words in ASKED:
        print(f"{words}: {seconds((words,), rounds) / COUNT * 1e6:.2f} µs")
    tick = seconds(ASKED, rounds)
    print(
        f"all in turn: {tick * 1e3:.2f} ms a tick of {COUNT:,}, {tick * RATE:.1%} of a core at {RATE:g} ticks a second"
    )


if __name__ == "__main__":
    main()
