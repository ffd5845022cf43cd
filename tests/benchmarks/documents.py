"""Times of what an editor asks of a mission of 2,000 lines: `python -m tests.benchmarks.documents [--rounds 15]`.

Medians in milliseconds; `document` is what a page asks behind each key. "in a worker" includes the way to the process
of a server and back, as JSON.
"""

from __future__ import annotations

import argparse
import asyncio
import json
from collections.abc import Callable
from contextlib import closing
from functools import partial
from itertools import count
from statistics import median
from time import perf_counter

from btlang.editing.document import document
from btlang.editing.help import complete, hover
from btlang.editing.palette import palette
from btlang.editing.rename import rename
from btlang.editing.words import RobotWords
from btlang.server.page.processes import Checker
from btlang.text.source import Source
from tests.benchmarks.missions import mission

LINES = 2_000


def milliseconds(work: Callable[[], object], rounds: int) -> float:
    """The median of some rounds, behind one that isn't counted."""
    work()
    taken = []
    for _ in range(rounds):
        began = perf_counter()
        work()
        taken.append(perf_counter() - began)
    return median(taken) * 1e3


def here(text: str, rounds: int) -> None:
    """In this process."""
    words, place = RobotWords(), count(len(text) // 2)  # what may follow at the same place is remembered
    defined = text.index("task xaa")
    works: dict[str, Callable[[], object]] = {
        "text to tree": lambda: words.mission(Source(text)),
        "document": lambda: document(Source(text), words),
        "hover": lambda: hover(Source(text), len(text) // 2, words),
        "complete": lambda: complete(Source(text), words, next(place)),
        "rename": lambda: rename(Source(text), defined, words, "another task"),
        "palette": lambda: palette(Source(text), words),
    }
    for name, work in works.items():
        print(f"{name}, {LINES:,} lines: {milliseconds(work, rounds):.1f} ms")
    shown = document(Source(text), words)
    writing = milliseconds(partial(json.dumps, shown, separators=(",", ":")), rounds)
    size = len(json.dumps(shown, separators=(",", ":")))
    print(f"document as JSON: {writing:.1f} ms, {size / 1e3:,.0f} kB, {len(shown['nodes']):,} nodes")


async def in_a_worker(text: str, rounds: int) -> None:
    """Through the process of a server."""
    with closing(Checker()) as checker:
        taken = []
        for number in range(rounds + 1):
            began = perf_counter()
            await checker.answer("document", f"{text}# {number}\n", RobotWords())
            taken.append(perf_counter() - began)
    print(f"document in a worker: {median(taken[1:]) * 1e3:.1f} ms")


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast an editor gets its answers.")
    options.add_argument("--rounds", type=int, default=15)
    rounds = options.parse_args().rounds
    text = mission(LINES)
    here(text, rounds)
    asyncio.run(in_a_worker(text, rounds))


if __name__ == "__main__":
    main()
