"""Whether this commit is slower than another one: `python -m tests.benchmarks.gate [REV] [--turns 3] [--bound 1.1]`.

REV is by default the commit that the file `baseline` beside this one names: one whose figures are to be kept. Both run
in turn, each time in processes of their own; of each figure the least counts, since whatever else the machine does only
adds to it. What is above the bound is measured anew, three times at most. Prints the ratios, now to before, and exits
with 1 if one stays above the bound.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
TRIES = 3


def measure(checkout: Path) -> dict[str, float]:
    """The figures of a checkout, by this commit's benchmarks."""
    command = [sys.executable, "-m", "tests.benchmarks.gate_measures"]
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    done = subprocess.run(command, cwd=checkout, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def compare(before: Path, turns: int, bound: float) -> dict[str, tuple[float, float]]:
    """The least figures of both, before and now."""
    found: dict[str, tuple[float, float]] = {}
    for _ in range(TRIES):
        for _ in range(turns):
            old, new = measure(before), measure(ROOT)
            for name in old.keys() & new.keys():
                least = found.get(name, (old[name], new[name]))
                found[name] = min(least[0], old[name]), min(least[1], new[name])
        if all(new <= bound * old for old, new in found.values()):
            break
    return {name: found[name] for name in new if name in found}


def main() -> int:
    """Prints a line for each figure; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision", nargs="?", default=(HERE / "baseline").read_text(encoding="utf-8").strip())
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--bound", type=float, default=1.1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        before = Path(folder) / "before"
        add = ["git", "worktree", "add", "--quiet", "--detach", before, options.revision]
        subprocess.run(add, cwd=ROOT, check=True)
        try:
            shutil.copytree(HERE, before / "tests" / "benchmarks", dirs_exist_ok=True)
            found = compare(before, options.turns, options.bound)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", before], cwd=ROOT, check=True)
    slower = [name for name, (old, new) in found.items() if new > options.bound * old]
    print(f"{'now/before':>10} {'before':>12} {'now':>12}   ({options.revision[:12]})")
    for name, (old, new) in found.items():
        print(f"{new / old:10.2f} {old:12.4g} {new:12.4g}   {name}{'   SLOWER' * (name in slower)}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
