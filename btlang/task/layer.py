"""A robot that is up: its session with all of the task layer, and its daily routine from the robot file."""

from __future__ import annotations

import gc
import os
import sys
import time
from collections.abc import Callable, Mapping
from functools import partial

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_source
from btlang.house_rules import HouseRules, no_house_rules, read_house_rules
from btlang.robots.files import DataFileError, as_mission_error, load_data
from btlang.robots.preflight import check_mission, needs_of_tree
from btlang.robots.registry import runs_on
from btlang.run.controls import disable
from btlang.run.world_input import WorldInput
from btlang.session import Run, Session
from btlang.task.commands.answers import refusal_data
from btlang.task.commands.handler import Handler
from btlang.task.commands.robot_handlers import component_data, takes_talk, takes_visitors
from btlang.task.execution.emergency import EmergencyLatch, latch_path
from btlang.task.execution.executor import Executor
from btlang.task.execution.manager import DAY, TaskManager
from btlang.task.execution.missions import MissionReader
from btlang.task.execution.run_sinks import Recordings
from btlang.task.live.feed import Feed
from btlang.task.messages import AddSchedule, Answer, Command, Put, RemoveSchedule, as_json, read_command
from btlang.task.schedule.recurrence import read_rule
from btlang.task.store.location import note_store, usual_store
from btlang.task.store.records import Missed, MissionText, Overlap, Restart, Schedule, Task
from btlang.task.store.task_store import open_store
from btlang.text.source import NOWHERE
from btlang.text.toml_table import Problems, Table

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any

    from btlang.robots.registry import Connect, Connector
    from btlang.run.events import Sink
    from btlang.task.execution.missions import MissionReader


_IDLE = MissionText("repeat forever: wait 24 h")
KEPT = 90 * DAY
"""The seconds for which tasks that are over are kept by default."""
_SLOW = 1.0  # ticks per second between tasks where no time is lost by waiting
_WHEELS = {"base", "navigation"}
_EMPTY = 1.0  # percent of the battery below which no mission begins that needs the wheels


class TaskLayer:
    """A robot for many tasks of many people: `handle` takes their commands until `close`; `start` begins to do them.

    - `robot` and `over` are those of btlang.Session; `reader` has the robot's words and its world, by default those
      that ship.
    - `folder` keeps what belongs to the robot; `store` is the place of its store, by default a file there; `rules` is
      the path of its house rules; `recordings` is the folder for recordings of tasks, None for none.
    - `speed` is that of all runs: if it isn't "real", time is that of the robot, and begins at the moment `begins`
      (seconds since 1970). Tasks that are over are kept for `keeps` seconds.
    - `trouble` gets what goes wrong, for people. `sinks` makes sinks for each run (None: of the house rules between
      tasks), `down` is what the command of that name calls. `answers` to the robot's questions are those of WorldInput.

    Raises MissionError.
    """

    def __init__(
        self,
        robot: str | Connect = "simulated",
        reader: MissionReader | None = None,
        *,
        folder: str,
        over: str | None = None,
        store: str = "",
        rules: str | None = None,
        speed: float | str = "real",
        begins: float | None = None,
        durable: bool = False,
        keeps: float = KEPT,
        recordings: str | None = None,
        trouble: Callable[[str], object] = lambda text: None,
        down: Callable[[], object] = lambda: None,
        sinks: Callable[[Task | None, Mission, Run], list[Sink]] = lambda task, mission, run: [],
        answers: Mapping[str, list[str]] | None = None,
    ) -> None:
        os.makedirs(folder, mode=0o700, exist_ok=True)
        self.reader = reader or MissionReader()
        self.rules: HouseRules = no_house_rules()
        if rules is not None:
            self.rules = read_house_rules(self.reader.read(MissionText("", file=rules)))
        place = store or usual_store(folder)
        self.store = open_store(place, durable)
        try:
            self.store.own()
            note_store(folder, place)
            self.session = Session(robot, world=self.reader.world, over=over)
        except BaseException:
            self.store.close()
            raise
        self._begins = time.time() if begins is None else begins
        self._real = speed == "real"
        self.emergency = EmergencyLatch(latch_path(folder), self.session.emergency_stop)
        knows = self.reader.world is not None or not getattr(self.session.robot, "moves_by_itself", True)
        self.world_input = WorldInput(answers)
        self.feed = Feed(
            self.store, self._hindrances, self.reader.words, self.session.world if knows else None,
            "" if recordings is None else os.path.abspath(recordings), partial(component_data, self.session),
            lambda: self.world_input.question,
        )  # fmt: skip
        self.emergency.listeners.append(self.feed.wake)
        self.manager = TaskManager(self.store, keeps, self._needs)
        self.executor = Executor(
            self.session, self.store, self.manager, self.emergency, self.rules, self.reader.read(_IDLE),
            missions=self.reader.read, now=self.now, trouble=trouble,
            recordings=None if recordings is None else Recordings(
                recordings, trouble, keywords=self.reader.keywords, language=self.reader.language
            ),
            speed=speed, idle_rate=20.0 if self._real else _SLOW,
            sinks=lambda task, mission, run: [
                self.world_input, *self.feed.sinks(0 if task is None else task.id, mission, run),
                *sinks(task, mission, run),
            ],
        )  # fmt: skip
        self.handler = Handler(
            self.store,
            self.manager,
            self.executor,
            self.emergency,
            self.session,
            self._admit,
            self.now,
            down,
            self._needs,
            {"simulated": None, _over(robot, over): None},
            self.world_input,
        )

    def now(self) -> float:
        """Return the seconds since 1970, as the robot's day goes."""
        return time.time() if self._real else self._begins + float(self.session.robot.time)

    def handle(self, command: Command | dict[str, Any], person: str = "") -> Answer:
        """Do a command (see btlang.task.messages), or its JSON, from any thread. A refusal is an answer, too."""
        try:  # also one that is a command already, since its texts may be anything
            command = read_command(as_json(command) if isinstance(command, Command) else command)
        except MissionError as error:
            return Answer(False, str(error), refusal_data(error), error.diagnostics[0].code)
        answer = self.handler.handle(command, person)
        self.feed.wake()
        return answer

    def add(self, mission: MissionText, person: str = "", **fields: Any) -> Task:
        """Queue a mission of the robot's owner, with these fields of its task. Raises MissionError."""
        self._admit(mission)
        return self.handler.add(mission, person, **fields)

    def stop(self, person: str) -> None:
        """Stop the robot at once, from any thread, and latch the stop; nothing delays it."""
        self.emergency.stop(person)

    def disable(self) -> None:
        """Stop the robot, from any thread, without a latch: for one that is about to end."""
        disable(self.session.robot)

    def start(self) -> None:
        """Take up what was left, and begin to work. May be called again after `halt`."""
        self.executor.start()

    def halt(self) -> bool:
        """End the mission under way, as its task says for a restart; commands are still taken.

        False if a command of the mission hangs: the robot was stopped, but the mission isn't over.
        """
        return self.executor.halt()

    def close(self) -> bool:
        """Halt, then let go of the robot and of the store. May be called twice."""
        ended = self.executor.halt()
        if ended:
            self.session.close()
        else:
            self.session.connection.close()  # a session would wait for its run
        self.emergency.close()
        self.store.close()
        return ended

    def __enter__(self) -> TaskLayer:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _needs(self, text: MissionText) -> tuple[str, ...]:
        """Return what a mission needs; nothing for one that can't be read any more, which its task will say."""
        try:
            mission = self.reader.read(text)
        except MissionError:
            return ()
        return needs_of_tree(mission.tree, mission.vocabulary)

    def _hindrances(self) -> dict[str, Any]:
        return {
            "stopped": self.emergency.reason, "paused": self.executor.is_paused,
            "hindrance": self.executor.hindrance(), "acting": self.executor.is_rule_acting,
            "visitors": takes_visitors(self.session),
            "talks": takes_talk(self.session),
        }  # fmt: skip

    def _admit(self, text: MissionText) -> Mission:
        """Return a mission that this robot can do. Raises MissionError with all reasons why it can't."""
        self.reader.check(text.keywords)
        mission = self.reader.read(text)
        mission.check()
        body = getattr(self.session.robot, "body", None)
        check_mission(self.session.world, body, mission.tree, mission.vocabulary)
        state = self.executor.robot_state
        battery = None if state is None else state.battery
        if battery is not None and battery < _EMPTY and _WHEELS & {*needs_of_tree(mission.tree, mission.vocabulary)}:
            raise MissionError([diagnostic("BT186", NOWHERE, reason=f"its battery is at {battery:.0f}%")])
        return mission


def _over(robot: str | Connect, over: str | None) -> str:
    """Return what the robot runs on."""
    return runs_on(robot, over)[1] if isinstance(robot, str) else getattr(robot, "over", "simulated")


LABEL = "robot file"
"""The label of schedules that a file of schedules has made, and their person."""
_ENDING = ".txt"
_HOW_TO_SCHEDULE = (
    "Bring the robot up without --schedules and add the mission: btc task put NAME FILE. "
    'Or name its folder in the robot file: missions = "missions"'
)


class ScheduleFileError(DataFileError):
    """A file of schedules that can't be used."""

    code = "BT191"


def read_schedules(path: str) -> tuple[AddSchedule, ...]:
    """Return the schedules in a file, `[[schedule]]` each. Raises MissionError (BT191)."""
    try:
        return load_data(path, "a schedule", _schedules, ScheduleFileError)
    except ScheduleFileError as error:
        raise as_mission_error(error) from None


def make_robot_layer(
    robot: Connector, reader: MissionReader, *, rules: str | None = None, schedules: str | None = None, **options: Any
) -> TaskLayer:
    """Return the task layer of a robot, with the missions, schedules and rules of its file where none are given, and
    further options of TaskLayer. Raises MissionError.
    """
    body = robot.body
    path = schedules or body.schedules
    wanted = read_schedules(path) if path else ()
    layer = TaskLayer(robot, reader, rules=rules or body.rules or None, **options)
    try:
        _fill_library(layer, body.missions, list(wanted))
    except BaseException:
        layer.close()
        raise
    return layer


def _fill_library(layer: TaskLayer, missions: str, wanted: list[AddSchedule]) -> None:
    """Put the missions of a folder, "" for none, into the robot's library, and make these its schedules in place of
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
    try:
        for command in wanted:
            _do(layer, command)
    except MissionError as error:
        raise error.advising(_HOW_TO_SCHEDULE) from None


def _do(layer: TaskLayer, command: Command) -> None:
    """Do a command. Raises MissionError if it's refused."""
    layer.handler.do(command, LABEL)


def _is_of(command: AddSchedule, schedule: Schedule, layer: TaskLayer) -> bool:
    """Return whether a command would make the same schedule."""
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
        raise table.problem("every", _first_message(error)) from None
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


def _first_message(error: MissionError) -> str:
    """Return the first message with its advice, as part of a sentence."""
    first = error.diagnostics[0]
    return f"{first.message} {first.hint}".strip().rstrip(".")


_SWITCH = 0.0002  # seconds after which a thread that is at work lets another one go on; 0.005 if nobody says so


def keep_ticks_in_time() -> None:
    """Let ticks begin in time, once the robot is up.

    What there is then is never searched for garbage again (up to 50 ms), and a tick that is due waits for other threads
    much less than is usual.
    """
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(_SWITCH)
