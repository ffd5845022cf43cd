"""People, questions, zones, doors and switches between `btc sim-ros` and missions on a ROS 2 robot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.ros.processes import LONG, Command

HALL = """
start = { x = 1.5, y = 2.0, facing = 0 }
walls = [[[0, 0], [10, 0], [10, 4], [0, 4], [0, 0]], [[5, 0], [5, 1.5]], [[5, 2.7], [5, 4]]]
places = [{ name = "lab", x = 8, y = 2 }, { name = "landing", x = 3.5, y = 0.8 }]
objects = [{ name = "lamp", x = 6, y = 3, switch = "off" }, { name = "cup", x = 3, y = 2.2, known = false }]
doors = [{ name = "lab door", from = [5, 1.5], to = [5, 2.7], open = false }]

[[zones]]
name = "stairs"
kind = "keep out"
points = [[3, 0.3], [4, 0.3], [4, 1.2], [3, 1.2]]

[[people]]
name = "Alice"
x = 3
y = 3
comes = 20
answers = { coffee = "Sure, thanks!" }
"""
VISIT = """
wait until the robot sees Alice
ask Alice "Would you like some coffee?"
if the answer is yes, say "Coffee!"
go to the landing, otherwise say "Not there."
open the lab door
check that the lab door is open
switch on the lamp
check that the lamp is on
call the staff saying "All done."
"""


class Hall:
    """`btc sim-ros` in the hall, and missions there."""

    def __init__(self, folder: Path, domain: int, start_sim: Callable[..., Command]) -> None:
        self._folder, self._domain, self._start = folder, domain, start_sim
        self._file = folder / "hall.toml"
        self._count = 0

    def open(self, more: str = "", speed: int = 8) -> Command:
        self._file.write_text(HALL + more, encoding="utf-8")
        return self._start("--world", str(self._file), "--speed", str(speed))

    def run(self, mission: str, *options: str) -> tuple[int, str, str]:
        """The exit code, the output and the errors."""
        folder = self._folder / f"run{self._count}"
        folder.mkdir()
        self._count += 1
        given = ("--world", str(self._file), "--robot", "ros", "--sim-time", "--lines", *options)
        command = Command(folder, self._domain, "run", "-c", mission, *given)
        code = command.process.wait(3 * LONG)
        assert "Traceback" not in command.out + command.err
        return code, command.out, command.err


@pytest.fixture
def hall(tmp_path: Path, domain: int, start_sim: Callable[..., Command], nav2: object, run_mission: object) -> Hall:
    return Hall(tmp_path, domain, start_sim)


def told(out: str) -> list[str]:
    """The lines without their times, but for commands that begin or succeed."""
    lines = [line.split(maxsplit=1)[1] for line in out.splitlines() if line[:1] == " "]
    return [" ".join(line.split()) for line in lines if not line.startswith(("start", "done"))]


def test_a_visit(hall: Hall) -> None:
    sim = hall.open()
    code, out, err = hall.run(VISIT)
    assert code == 0, err + out
    assert [line for line in told(out) if not line.startswith(("sees cup", "navigates", "arrives"))] == [
        "sees Alice",
        'says "Would you like some coffee?"',
        'asks Alice: "Would you like some coffee?"',
        'hears "Sure, thanks!" from Alice',
        'says "Coffee!"',
        "failed go to landing: the landing is in the stairs, where the robot may not go",
        'says "Not there."',
        "door lab door open",
        "switch lamp on",
        'calls "All done."',
    ]
    sim.wait_for('calls "All done."')
