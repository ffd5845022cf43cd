"""Benchmarks of this checkout beside those of another commit: `python -m tests.benchmarks.against REV ticks compile`.

Each benchmark runs in turn on both, `--turns` times, in one environment. A line is compared with the line of the other
commit that has the same words; of each number in it the median counts. Numbers with a unit of time or "lines/s" are
printed with their ratio, before to after: above 1 is faster now.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[2]
_FIGURE = re.compile(r"(?<![\w.])(\d[\d,]*(?:\.\d+)?)\s?(µs|ms|s|lines/s)(?![\w/])")
_NUMBER = re.compile(r"\d[\d,.]*")


def figures(checkout: Path, benchmark: str) -> dict[tuple[str, int], tuple[float, str]]:
    """Each figure that a benchmark prints, with its unit, by the words of its line and its place there."""
    command = [sys.executable, "-m", f"tests.benchmarks.{benchmark}"]
    done = subprocess.run(
        command,
        cwd=checkout,
        env={**os.environ, "PYTHONPATH": str(checkout)},
        capture_output=True,
        text=True,
        check=True,
    )
    found = {}
    for line in done.stdout.splitlines():
        for place, match in enumerate(_FIGURE.finditer(line)):
            found[_NUMBER.sub("N", line), place] = float(match[1].replace(",", "")), match[2]
    return found


def main() -> None:
    """Prints a line for each figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("revision")
    parser.add_argument("benchmarks", nargs="+")
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        before = Path(folder) / "before"
        subprocess.run(
            ["git", "worktree", "add", "--quiet", "--detach", before, options.revision], cwd=ROOT, check=True
        )
        try:
            for benchmark in options.benchmarks:
                compare(before, benchmark, options.turns)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", before], cwd=ROOT, check=True)


def compare(before: Path, benchmark: str, turns: int) -> None:
    """Runs one benchmark on both, in turn."""
    values: dict[tuple[str, int], dict[Path, list[float]]] = defaultdict(lambda: defaultdict(list))
    units: dict[tuple[str, int], str] = {}
    for _ in range(turns):
        for checkout in (before, ROOT):
            for key, (value, unit) in figures(checkout, benchmark).items():
                values[key][checkout].append(value)
                units[key] = unit
    print(f"{benchmark}:")
    for (words, place), of in values.items():
        if len(of) < 2:
            continue
        old, new = median(of[before]), median(of[ROOT])
        unit = units[words, place]
        ratio = (new / old if unit == "lines/s" else old / new) if old and new else 1.0
        print(f"  {ratio:5.2f}  {old:>10,.2f} -> {new:>10,.2f} {unit:8} {words[:90]} [{place + 1}]")


if __name__ == "__main__":
    main()
