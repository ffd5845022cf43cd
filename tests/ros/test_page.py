"""The program that docs/ros.md shows, as it stands there, against a real node."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from tests.ros.processes import LONG, Command
from tests.test_readme import blocks


def test_the_client_of_the_page(start_node: Callable[..., Command], domain: int, tmp_path: Path):
    [program] = [block.text for block in blocks("py") if block.page.name == "ros.md"]
    file = tmp_path / "client.py"
    file.write_text(program, encoding="utf-8")
    start_node("--speed", "10")
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    done = subprocess.run(
        [sys.executable, str(file)], env=environment, capture_output=True, text=True, timeout=2 * LONG, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    *running, ended = done.stdout.splitlines()
    assert ended == "success "
    assert set(running) <= {"move forward 1 m", "say done", ""}
