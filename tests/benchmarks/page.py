"""How fast the page is, in a browser without a window: `python -m tests.benchmarks.page [--hours 8]`.

Pictures a second of trees of 500, 2,000 and 10,000 nodes at 20 Hz; milliseconds from a status that changes in the
robot to its picture, with a real server and 500 nodes of which nearly all change in each tick; from a key to what is
said of 2,000 lines; and the memory of the page while it hears the news of eight hours. All processes, the browser's
too, share this computer.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from pathlib import Path

from hatch_build import build_page
from tests.benchmarks.documents import LINES
from tests.benchmarks.missions import mission
from tests.benchmarks.server import mission as busy_mission
from tests.server.doors import PASSWORD
from tests.web.packages import ROOT, WEB, installed, node
from tests.web.served import served

SCRIPTS = ROOT / "tests" / "web"


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=int, default=8, help="of news; 0 for none")
    options = parser.parse_args()
    problem = build_page(WEB)
    if problem:
        parser.error(problem)
    folder = installed(SCRIPTS)
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    with served() as address, tempfile.TemporaryDirectory() as texts:
        for size, found in json.loads(node(SCRIPTS / "figures.mjs", address, PASSWORD, folder=folder)).items():
            still, scrolled = (found[name]["frames"] for name in ("still", "scrolled"))
            print(f"{size} nodes: open in {found['opened']} ms; {still} pictures a second, {scrolled} while scrolling")
        running, long = Path(texts, "running.txt"), Path(texts, "long.txt")
        running.write_text(busy_mission(), encoding="utf-8")
        long.write_text(mission(LINES), encoding="utf-8")
        paces = json.loads(node(SCRIPTS / "pace.mjs", address, PASSWORD, str(running), str(long), folder=folder))
        for what, key in (("status to picture, 500 nodes", "painted"), (f"key to messages, {LINES:,} lines", "keys")):
            print(
                f"{what}: {paces[key]['p50']} ms, 95 in 100 within {paces[key]['p95']} ms, worst {paces[key]['worst']}"
            )
        if options.hours:
            hours = str(options.hours)
            memory = json.loads(node(SCRIPTS / "memory.mjs", address, PASSWORD, hours, folder=folder, seconds=900.0))
            first, last = memory[1], memory[-1]
            growth = last["megabytes"] / first["megabytes"] - 1
            print(f"memory: {first['megabytes']} MB after half an hour, {last['megabytes']} MB after {last['hours']} h")
            print(f"  {growth:+.0%}; elements {first['elements']} to {last['elements']}")


if __name__ == "__main__":
    main()
