"""A week of the museum guide in simulation: `python -m tests.guide.week SEED [DAYS]` prints what became of it.

One that is shorter than two days begins on Tuesday before the first tour: the museum is closed on Mondays.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from btlang.components.words import robot_words
from btlang.robots.registry import connector
from btlang.robots.worlds.world_file import load_world
from btlang.robots.worlds.world_writing import to_toml
from btlang.run.events import Bumped, Called, Event, Heard, PeriodPassed, Said
from btlang.speech.marks import read_marks
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import make_robot_layer
from btlang.task.store.records import FINAL, TaskState
from btlang.text.source import Source

GUIDE = Path(__file__).parents[2] / "examples" / "guide"
MONDAY = datetime(2026, 3, 2, tzinfo=UTC).timestamp()
OPENS = 9.5 * 3600.0
TOUR = 10.45 * 3600.0  # some minutes before the first one
DAY = 86_400.0
PATIENCE = 600.0  # seconds after a question in which it has to be answered: it may come while the robot charges


class Observer:
    """What happens in the museum, as far as the week is judged by it."""

    def __init__(self, world: Any) -> None:
        self.contacts: list[str] = []
        self.entries: list[str] = []
        self.least = 100.0
        self.open: list[tuple[float, str]] = []
        self.late: list[str] = []
        self.asked = self.answered = self.passed_on = 0
        self._zones = [zone for zone in world.zones if zone.is_closed]
        self.now: Callable[[], float] = float

    def __call__(self, event: Event) -> None:
        now = self.now()
        if isinstance(event, PeriodPassed):
            robot = event.robot
            if robot is None:
                return
            self.least = min(self.least, robot.battery if robot.battery is not None else self.least)
            if robot.pose is not None:
                point = robot.pose.x, robot.pose.y
                self.entries += [f"{zone.name} at {now:.0f}" for zone in self._zones if zone.contains(point)][:1]
            self.late += [f"{text} at {at:.0f}" for at, text in self.open if now - at > PATIENCE]
            self.open = [each for each in self.open if now - each[0] <= PATIENCE]
            return
        if isinstance(event, Bumped):
            self.contacts.append(f"{event.into} at {now:.0f}")
        elif isinstance(event, Heard) and event.text.endswith("?"):
            self.asked += 1
            self.open.append((now, event.text))
        elif isinstance(event, Called) and self.open:
            self.passed_on += 1
            self.open = []
        elif isinstance(event, Said) and self.open and event.text in self.answers:
            self.answered += 1
            self.open.pop(0)

    answers: frozenset[str] = frozenset()


def main(seed: int, days: float = 7.0) -> dict[str, Any]:
    """What became of a week with this seed."""
    robot = str(GUIDE / "robot.toml")
    connect = connector(robot)
    world = load_world(str(GUIDE / "world.toml"), connect.body).replace(seed=seed)
    begins = MONDAY + OPENS
    if days < 2.0:
        world, begins = world.replace(clock=TOUR, weekday=1), MONDAY + DAY + TOUR
    ends = begins + days * DAY
    observer = Observer(world)
    answers = tomllib.loads((GUIDE / "answers.toml").read_text(encoding="utf-8"))
    observer.answers = frozenset(read_marks(text)[0] for text in answers.values())
    reader = MissionReader(robot_words(robot), Source(to_toml(world), "world.toml"))
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        layer = make_robot_layer(
            connect, reader, folder=folder, speed="max", begins=begins, keeps=8 * DAY,
            trouble=lambda text: print(text, file=sys.stderr), sinks=lambda task, mission, run: [observer],
        )  # fmt: skip
        observer.now = layer.now
        with layer:
            while layer.now() < ends:
                time.sleep(0.01)
            tasks = [task for task in layer.store.tasks(limit=10_000) if (task.due or 0) <= ends - 600.0]
    states: dict[str, int] = {}
    for task in tasks:
        states[task.state] = states.get(task.state, 0) + 1
    unexplained = [
        f"task {task.id}: {task.state}"
        for task in tasks
        if task.state not in FINAL or (task.state is not TaskState.COMPLETED and not task.reason)
    ]
    return {
        "seed": seed, "tasks": states, "unexplained": unexplained,
        "reasons": sorted({f"{task.state}: {task.reason}" for task in tasks if task.state is not TaskState.COMPLETED}),
        "contacts": observer.contacts, "entries": observer.entries, "least battery": round(observer.least, 1),
        "asked": observer.asked, "answered": observer.answered, "passed on": observer.passed_on, "late": observer.late,
        "seconds": round(time.perf_counter() - began, 1),
    }  # fmt: skip


if __name__ == "__main__":
    print(json.dumps(main(int(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 7.0), indent=1))
