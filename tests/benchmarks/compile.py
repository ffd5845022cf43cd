"""How fast missions are compiled: `python -m tests.benchmarks.compile [--rounds 5]`.

Medians of rounds in which what is compared takes turns; on a machine that others use, trust only the ratios.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from statistics import median

import btlang
from btlang.backends.engine import bind_leaf
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.frontends.mission.grouping.grouping import group
from btlang.frontends.mission.parsers.build import Builder
from btlang.frontends.mission.reader import PARSERS, read_mission
from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source
from tests.benchmarks.missions import mission

LINES = 10_000
CHECKED = 100
GROWING = (1_000, 10_000, 100_000)
LOOPS = 2_000_000
CHECKOUT = Path(btlang.__file__).parents[1]


def seconds(work: Callable[[], object]) -> float:
    """How long one call takes."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def medians(works: dict[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Seconds of each. In a round all take turns, so that a slow moment slows all of them."""
    taken: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(rounds):
        for name, work in works.items():
            taken[name].append(seconds(work))
    return {name: median(times) for name, times in taken.items()}


def loop() -> None:
    """What the speed of the machine is told in."""
    turns = LOOPS
    while turns:
        turns -= 1


def runnable(text: str) -> Engine:
    """A text compiled to a tree that could be ticked, without a robot."""
    tree = btlang.parse_tree(text)
    return Engine(tree.tree, cache(lambda id: bind_leaf(id, tree.vocabulary)), clock=Clock(), services={"robot": None})


def parsers(rounds: int) -> None:
    """From text, where both do the same before their part (words, phrases, matching), and that part alone."""
    vocabulary, source = world_vocabulary(), Source(mission(LINES))
    lexer = Lexer(source, vocabulary)
    units = [unit.tokens for unit in group(source, lexer.tokens, lexer.conditions, vocabulary.word).units]
    build = Builder(source)

    def grouped(parse: Callable[[Sequence[Token], Builder], object]) -> None:
        for tokens in units:
            parse(tokens, build)

    def compared(works: dict[str, Callable[[], object]], what: str) -> None:
        with gc_paused:  # as in `parse_tree`
            times = medians(works, rounds)
        yard, lark = times["shunting-yard"], times["lark"]
        told = f"shunting-yard {LINES / yard:,.0f} lines/s, Lark {LINES / lark:,.0f} lines/s"
        print(f"{what}, {LINES:,} lines: {told}, ratio {lark / yard:.2f}")

    for parser in PARSERS:  # the first use of Lark reads its grammar
        read_mission(Source("nod"), vocabulary, parser)
    compared({p: partial(read_mission, source, vocabulary, p) for p in PARSERS}, "text to syntax tree")
    compared({p: partial(grouped, import_module(PARSERS[p]).parse) for p in PARSERS}, "grouping alone")


def whole(rounds: int) -> None:
    """From text to closures, beside a loop of plain Python."""
    text = mission(LINES)
    runnable("nod")
    taken = medians({"compile": partial(runnable, text), "loop": loop}, rounds)
    speed, loops = LINES / taken["compile"], LOOPS / taken["loop"]
    told = f"{speed:,.0f} lines/s; this machine makes {loops / 1e6:.1f} million turns/s of `while turns: turns -= 1`"
    print(f"text to runnable tree, {LINES:,} lines: {told}, {loops / speed:,.0f} a line")


def again(rounds: int) -> None:
    """A short sentence in a process that has read one before, with the words that ship and with an own one."""

    @btlang.action("hop over")
    def hop() -> None:
        """An own word."""

    works: dict[str, Callable[[], object]] = {
        "": lambda: [btlang.parse_tree("move forward 1 m then say done") for _ in range(100)],
        " with an own word": lambda: [btlang.parse_tree("hop over then wave", keywords=[hop]) for _ in range(100)],
    }
    for what, taken in medians(works, rounds).items():
        print(f"parse_tree of a short sentence once more{what}: {taken * 10:.2f} ms")


def check(rounds: int) -> None:
    """The command beside a start of Python with what any command needs.

    -S in both: what a machine loads at each start of Python is no part of the one or the other.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "mission.txt")
        file.write_text(mission(CHECKED), encoding="utf-8")
        plain = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        environment = {**plain, "PYTHONPATH": str(CHECKOUT), "XDG_CACHE_HOME": folder}

        def start(*arguments: str) -> None:
            command = [sys.executable, "-S", *arguments]
            subprocess.run(command, env=environment, check=True, capture_output=True)

        works: dict[str, Callable[[], object]] = {
            "check": partial(start, "-m", "btlang", "check", str(file)),
            "python": partial(start, "-c", "import argparse, re"),
        }
        medians(works, 2)  # files in memory, bytecode written, words cached
        taken = medians(works, rounds * 5)
    told = f"{taken['check'] * 1e3:.0f} ms, `import argparse, re` {taken['python'] * 1e3:.0f} ms"
    print(f"btc check, {CHECKED} lines: {told}, ratio {taken['check'] / taken['python']:.2f}")


def growth(rounds: int) -> None:
    """Linear where the time of a line stays the same."""
    texts = {f"{lines:,}": mission(lines) for lines in GROWING}
    taken = medians({name: partial(runnable, text) for name, text in texts.items()}, min(rounds, 3))
    told = ", ".join(
        f"{taken[name] / text.count(chr(10)) * 1e6:.1f} µs a line of {name}" for name, text in texts.items()
    )
    print(f"growth, text to runnable tree: {told}")


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast missions are compiled.")
    options.add_argument("--rounds", type=int, default=5)
    rounds = options.parse_args().rounds
    for measure in (parsers, whole, again, check, growth):
        measure(rounds)


if __name__ == "__main__":
    main()
