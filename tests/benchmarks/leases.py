"""Whether goals are halted though their clients live: runs on action servers while all cores are busy.

    python -m tests.benchmarks.leases [RUNS]

It counts the halts, of which there must be none.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.ros.domains import free_domain
from tests.ros.processes import Command

MISSION = "move forward 30 cm at 0.2 meters per second then turn left 45 degrees then move backward 20 cm"


def main(runs: int) -> None:
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
    failed = 0
    with tempfile.TemporaryDirectory() as folder, free_domain() as domain:
        paths = Path(folder, "server"), Path(folder, "run")
        for path in paths:
            path.mkdir()
        server = Command(paths[0], domain, "serve-actions", "--only", "motion")
        try:
            server.wait_for("ready")
            for number in range(1, runs + 1):
                run = Command(paths[1], domain, "run", "--robot", "actions", "-c", MISSION)
                failed += run.process.wait(120) != 0
                print(f"{number} runs, {failed} failed, {server.out.count('halted ')} halts", flush=True)
        finally:
            for process in busy:
                process.kill()
            server.end()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
