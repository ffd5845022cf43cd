"""Answers about a robot that is down, from the store that it left."""

from __future__ import annotations

import os
import time
from collections.abc import Callable

from btlang.diagnostics.diagnostic import MissionError
from btlang.task import messages
from btlang.task.commands.client import USUAL_NAME, RobotClient, data_folder, find_listening, robots_known
from btlang.task.commands.store_handlers import LibraryHandler, ScheduleHandler
from btlang.task.commands.store_reader import StoreReader
from btlang.task.execution.manager import TaskManager
from btlang.task.messages import Answer, Command
from btlang.task.store.location import latest_store
from btlang.task.store.task_store import open_store
from btlang.text.formatting import joined

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn

    from btlang.task.store.records import MissionText

_DOWN = "the robot is down"
COMMAND = "command"
"""The setting of the store with the command that brought the robot up last."""


class DownRobot:
    """A client of a robot that is down: it answers what the store knows. Raises MissionError if that can't be read."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._store = open_store(_store_of(name))
        self.command = self._store.setting(COMMAND)
        """The command that brought it up last, "" if that isn't known."""
        reader = StoreReader(self._store, TaskManager(self._store), self._now, lambda: _DOWN)
        library = LibraryHandler(self._store, _refuse_mission, self._now, None, ())
        schedules = ScheduleHandler(self._store, lambda: None, _refuse_mission, self._now)
        self._does: dict[type[Command], Callable[[Any, str], Answer]] = {
            messages.List: reader.list, messages.Show: reader.show, messages.Report: reader.report,
            messages.Trail: reader.trail, messages.Library: library.list, messages.Schedules: schedules.list,
        }  # fmt: skip

    def send(self, command: Command) -> Answer:
        """Return what the store says; a refusal is an answer, too."""
        try:
            return self._does[type(command)](command, "")
        except MissionError as error:
            return Answer(False, str(error), {}, error.diagnostics[0].code)

    def _now(self) -> float:
        """Return the time, or that of the last change: the clock of a robot with another speed is ahead."""
        last = self._store.changes(after=self._store.latest_change() - 1)
        return max(time.time(), *(change.time + 1.0 for _, change in last), 0.0)

    def __enter__(self) -> DownRobot:
        return self

    def __exit__(self, *problem: object) -> None:
        self._store.close()


_READS = (messages.List, messages.Show, messages.Report, messages.Trail, messages.Library, messages.Schedules)


def open_reader(name: str, command: Command, note: Callable[[str], object]) -> RobotClient | DownRobot:
    """Return a client of the robot of a name, "" for the only one; of one that is down for a command that only reads.

    `note` gets the text that says so. Raises MissionError (BT185) if there is no such robot, or several.
    """
    try:
        return RobotClient(name)
    except MissionError:
        down = "" if not isinstance(command, _READS) or (not name and find_listening()) else _name_of_one_down(name)
        if not down:
            raise
    client = DownRobot(down)
    start = client.command or ("btc robot up" if down == USUAL_NAME else f"btc robot up --name {down}")
    note(f"The robot '{down}' is down; this is from its store. To bring it up: {start}")
    others = [] if name else [each for each in _robots_with_store() if each != down]
    if others:
        note(f"For {joined(others, 'or')}: --name NAME")
    return client


def _name_of_one_down(name: str) -> str:
    """Return the name of a robot with a store: this one, or else the one that was used last; "" if there's none."""
    known = [name] * _has_store(_store_of(name)) if name else _robots_with_store()
    return max(known, key=lambda each: _last_use(_store_of(each)), default="")


def _robots_with_store() -> list[str]:
    return [each for each in robots_known() if _has_store(_store_of(each))]


def _last_use(place: str) -> float:
    """Return when a store was last written, in seconds since 1970; 0 where that can't be seen."""
    return os.path.getmtime(place) if os.path.isfile(place) else 0.0


def _store_of(name: str) -> str:
    return latest_store(data_folder(name))


def _has_store(place: str) -> bool:
    return "://" in place or os.path.isfile(place)


def _refuse_mission(given: MissionText | messages.AddSchedule) -> NoReturn:
    raise AssertionError("a robot that is down takes no missions")
