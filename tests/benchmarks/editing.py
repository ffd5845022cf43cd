"""What somebody who types in a long text waits for: `python -m tests.benchmarks.editing [--lines 2000] [--fresh]`.

A word is typed letter by letter in the middle of texts of several kinds. Printed are the median and the longest time of
this process, in milliseconds, from a key to all messages about the text; with `--fresh` nothing is kept of the text
before, as where a file is read once.
"""

from __future__ import annotations

import argparse
import os
import time
from statistics import median

from btlang.editing.document import text_messages
from btlang.editing.words import RobotWords
from btlang.frontends.mission.tokens import lexer
from tests.benchmarks.missions import mission

TYPED = "wave at Bobby"


def plain(lines: int) -> list[str]:
    """Lines as people write them, with blocks and a few definitions."""
    return mission(lines).split("\n")


def definitions(lines: int) -> list[str]:
    """A text in which each statement gives commands a name."""
    written = (line for line in mission(3 * lines).split("\n") if line[:1].isalpha() and line[-1] != ":")
    plain = [line for line in written if "task" not in line]
    names = (f"job {chr(97 + at // 26 % 26)}{chr(97 + at % 26)}x" for at in range(lines // 4))
    made = [f"{name} means:\n    {plain[3 * at]}\n    {plain[3 * at + 1]}\nnod" for at, name in enumerate(names)]
    return "\n".join(made).split("\n")


def rules(lines: int) -> list[str]:
    """House rules, each of which stands alone."""
    conditions = ("the battery is low", "bumped", "someone is near", "the path is not clear", "Alice is in the lab")
    plain = [line for line in mission(2 * lines).split("\n") if line[:4] in ("wave", "nod", "say ", "prin", "look")]
    return [f"whenever {conditions[at % 5]}, {plain[at % len(plain)]}" for at in range(lines)]


def measure(lines: list[str], is_fresh: bool) -> list[float]:
    """Seconds of the process for each key."""
    words = RobotWords()
    lexer.FEWEST_LINES = 10**9 if is_fresh else 100
    at = next(at for at in range(len(lines) // 2, len(lines)) if lines[at][:1].isalpha() and lines[at - 1][-1:] != ":")
    text_messages(words.source("\n".join(lines)), words)
    taken: list[float] = []
    for letter in range(1, len(TYPED) + 1):
        text = "\n".join([*lines[:at], TYPED[:letter], *lines[at:]])
        began = time.process_time()
        text_messages(words.source(text), words)
        taken.append(time.process_time() - began)
    return taken


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast an editor gets messages.")
    options.add_argument("--lines", type=int, default=2_000)
    options.add_argument("--fresh", action="store_true")
    given = options.parse_args()
    print(f"{given.lines:,} lines, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    for kind in (plain, definitions, rules):
        taken = measure(kind(given.lines), given.fresh)
        print(
            f"{kind.__name__}: key to messages: median {median(taken) * 1e3:.0f} ms, longest {max(taken) * 1e3:.0f} ms"
        )


if __name__ == "__main__":
    main()
