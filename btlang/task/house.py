"""What the robot file says a robot does all day: missions for its library, and a file of schedules."""

from __future__ import annotations

import os

from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_source
from btlang.robots.files import DataFileError, as_mission_error, load_data
from btlang.task.layer import TaskLayer
from btlang.task.messages import AddSchedule, Command, Put, RemoveSchedule
from btlang.task.recurrence import read_rule
from btlang.task.task import Missed, Overlap, Restart, Schedule
from btlang.text.toml_table import Problems, Table

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.registry import Connector
    from btlang.task.missions import MissionReader

LABEL = "robot file"
"""Of the schedules that a file of schedules has made, and their person."""
_ENDING = ".txt"


class ScheduleFileError(DataFileError):
    """A file of schedules that can't be used."""

    code = "BT191"


def read_schedules(path: str) -> tuple[AddSchedule, ...]:
    """The schedules in a file, `[[schedule]]` each. Raises MissionError (BT191)."""
    try:
        return load_data(path, "a schedule", _schedules, ScheduleFileError)
    except ScheduleFileError as error:
        raise as_mission_error(error) from None


def furnished_layer(
    robot: Connector, reader: MissionReader, *, rules: str | None = None, schedules: str | None = None, **options: Any
) -> TaskLayer:
    """The task layer of a robot, with the missions, schedules and rules of its file where none are given, and further
    options of TaskLayer. Raises MissionError.
    """
    body = robot.body
    path = schedules or body.schedules
    wanted = read_schedules(path) if path else ()
    layer = TaskLayer(robot, reader, rules=rules or body.rules or None, **options)
    try:
        _furnish(layer, body.missions, list(wanted))
    except BaseException:
        layer.close()
        raise
    return layer


def _furnish(layer: TaskLayer, missions: str, wanted: list[AddSchedule]) -> None:
    """Puts the missions of a folder, "" for none, into the robot's library, and makes these its schedules in place of
    those that a file has made before. Others stay. Raises MissionError.
    """
    for name in sorted(os.listdir(missions)) if missions else ():
        if name.endswith(_ENDING):
            text = read_source(os.path.join(missions, name)).text
            _do(layer, Put(name.removesuffix(_ENDING), text))
    for known in [each for each in layer.store.schedules() if LABEL in each.labels]:
        same = next((command for command in wanted if _is_of(command, known, layer)), None)
        if same is None:
            _do(layer, RemoveSchedule(known.id))
        else:
            wanted.remove(same)  # it goes on, with what it has missed
    for command in wanted:
        _do(layer, command)


def _do(layer: TaskLayer, command: Command) -> None:
    """Raises MissionError where it is refused."""
    layer.handler.do(command, LABEL)


def _is_of(command: AddSchedule, schedule: Schedule, layer: TaskLayer) -> bool:
    """Whether a command would make the same schedule."""
    text = layer.store.text(command.name)
    return text is not None and (
        (str(read_rule(command.rule, command.zone)), command.zone, text.text, command.priority, command.labels)
        == (schedule.rule, schedule.zone, schedule.mission.text, schedule.priority, schedule.labels)
        and (command.restart, command.overlap, command.missed, command.within)
        == (schedule.restart, schedule.overlap, schedule.missed, schedule.within)
    )


def _schedules(top: Table) -> tuple[AddSchedule, ...]:
    problems = Problems()
    found = problems.rows(top, "schedule", _schedule)
    problems.part(lambda: top.finish(None), None)
    problems.end()
    return tuple(each for each in found if each is not None)


def _schedule(table: Table) -> AddSchedule:
    rule, zone = table.text("every"), table.text("zone") if table.has("zone") else ""
    try:
        read_rule(rule, zone)
    except MissionError as error:
        raise table.problem("every", _plain(error)) from None
    return table.finish(
        AddSchedule(
            rule, name=table.text("mission"), zone=zone,
            priority=int(table.number("priority", 0, low=-100, high=100)),
            labels=(*table.texts("labels"), LABEL),
            restart=table.choice("restart", tuple(Restart), Restart.GIVE_UP),
            overlap=table.choice("overlap", tuple(Overlap), Overlap.SKIP),
            missed=table.choice("missed", tuple(Missed), Missed.SKIP),
            within=table.number("within", low=1.0) if table.has("within") else None,
        )
    )  # fmt: skip


def _plain(error: MissionError) -> str:
    """The first message with its advice, as part of a sentence."""
    first = error.diagnostics[0]
    return f"{first.message} {first.hint}".strip().rstrip(".")
