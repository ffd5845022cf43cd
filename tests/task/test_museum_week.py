"""A week of a museum: tours on the hour, visitors who ask in between, charging, a power cut and a closed room a day."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import pytest

from btlang.task.commands.answers import write_report
from btlang.task.store.records import FINAL, MissionText, Task, TaskState
from btlang.task.store.task_store import TaskStore, open_store
from tests.profiles import amount

from .museum import DAY, HOUR

MONDAY = datetime(2026, 3, 2, tzinfo=UTC).timestamp()
WISHES = (
    "go to the living room then say hello",
    "go to Alice then wave",
    "go to the kitchen then say welcome",
    "frown",
)


def ask(store: TaskStore, draw: random.Random, day: float) -> None:
    """Five visitors of a day."""
    for _ in range(5):
        at = day + draw.uniform(10, 17) * HOUR
        mission = MissionText(draw.choice(WISHES))
        store.add(Task(0, mission, "visitors", at, earliest=at, deadline=at + HOUR / 2, priority=-1))


@pytest.mark.long
def test_the_report_has_every_tour_and_why_one_was_not_given(tmp_path: Path) -> None:
    days, draw = amount(1, 7), random.Random(7)
    ends = MONDAY + (days - 1) * DAY + amount(27, 48) * HOUR / 2
    with open_store(str(tmp_path / "tasks.db")) as store:
        for day in range(days):
            ask(store, draw, MONDAY + day * DAY)
    begins = MONDAY + 9 * HOUR
    for day in range(days):
        cut = MONDAY + day * DAY + draw.uniform(10.5, amount(12, 16)) * HOUR
        live(tmp_path, begins, cut, "cut")
        begins = cut + 600
    live(tmp_path, begins, ends, "end")
    with open_store(str(tmp_path / "tasks.db")) as store:
        lines = list(write_report(store, MONDAY, ends))
        tours = store.tasks(label="tour")
        rest = [task for task in store.tasks() if "tour" not in task.labels]
    print("\n".join(lines))
    assert sorted(tour.due for tour in tours) == [
        due for day in range(days) for hour in range(10, 18) if (due := MONDAY + day * DAY + hour * HOUR) < ends
    ]
    assert len(rest) == 5 * days
    for task in (*tours, *rest):
        assert task.state in FINAL or (task.earliest or 0) > ends
        assert task.reason or task.state not in FINAL or task.state is TaskState.COMPLETED
        told = any(f"task {task.id}, " in line for line in lines)
        is_shown = not task.schedule or task.state is not TaskState.COMPLETED
        assert told is (is_shown and (task.due or task.created) < ends)
    assert sum(tour.state is TaskState.COMPLETED for tour in tours) >= 2 * days
    assert any("there is no free way to the kitchen" in tour.reason for tour in tours)


def live(folder: Path, begins: float, ends: float, how: str) -> None:
    command = [sys.executable, "-m", "tests.task.museum", str(folder), str(begins), str(ends), how]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == (-signal.SIGKILL if how == "cut" else 0), done.stderr
