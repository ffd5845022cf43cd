"""How fast trees are written in English, and read back: `python -m tests.benchmarks.printing [--rounds 5]`.

Least CPU time of rounds in which all take turns. Leaves that no phrase says are said by their ids, which is the longest
way: each name is tried against all words.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from random import Random

import btlang
from btlang.backends.english import to_english
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.mission.reader import read_mission
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source
from btlang.tree.node import Tree
from tests.benchmarks.missions import mission
from tests.benchmarks.xml import five_thousand

LEAVES = 3_000
LINES = 1_000
_WORDS = (
    "Open", "Close", "Door", "Gripper", "Check", "Pose", "Update", "Plan", "Path", "Follow", "Compute", "Goal", "Pick",
    "Place", "Object", "Arm", "Drive", "Scan", "Load", "Push",
)  # fmt: skip


def unknown(kinds: int) -> Tree:
    """Leaves of so many kinds that no vocabulary knows, with ports."""
    random = Random(1)
    ids = ["".join(random.sample(_WORDS, random.randint(2, 4))) for _ in range(kinds)]
    leaves = "".join(
        f'<{random.choice(ids)} width="{number % 100 / 100}" frame_id="base {number % 7}" goal="{{goal}}"/>'
        for number in range(LEAVES)
    )
    body = f'<BehaviorTree ID="M"><Sequence>{leaves}</Sequence></BehaviorTree>'
    return read_xml(Source(f'<root BTCPP_format="4">{body}</root>'))


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast trees are written in English.")
    options.add_argument("--rounds", type=int, default=5)
    rounds, vocabulary = options.parse_args().rounds, world_vocabulary()
    trees = {
        f"{LEAVES:,} unknown leaves of as many kinds": unknown(LEAVES),
        f"{LEAVES:,} unknown leaves of 60 kinds": unknown(60),
        "5,000 nodes with unknown places": read_xml(Source(five_thousand(5_000, 4))),
        f"a mission of {LINES:,} lines": btlang.parse_tree(mission(LINES)).tree,
    }
    works: dict[str, Callable[[], object]] = {}
    for name, tree in trees.items():
        works[f"{name}, to English"] = partial(to_english, tree, vocabulary)
        works[f"{name}, read back"] = partial(read_mission, Source(to_english(tree, vocabulary)), vocabulary)
    taken = dict.fromkeys(works, float("inf"))
    with gc_paused:
        for _ in range(rounds):
            for name, work in works.items():
                began = time.process_time()
                work()
                taken[name] = min(taken[name], time.process_time() - began)
    for name, seconds in taken.items():
        print(f"{name}: {seconds * 1e3:.0f} ms")


if __name__ == "__main__":
    main()
