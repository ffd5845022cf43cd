"""What the page *Try it* asks of btlang: texts, and a run in the simulated house that the page steps."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.document import messages
from btlang.editing.queries import DOES, PLACES, answer_of, in_units
from btlang.editing.words import RobotWords
from btlang.engine.leaves.leaf import describe_exception
from btlang.recording.film import check_words
from btlang.robots.worlds.world_file import read_world
from btlang.run.statuses import Status
from btlang.run.world_input import WorldInput
from btlang.session import Run, Session
from btlang.task.live.feed import Feed, NoTasks
from btlang.text.source import Source, Utf16Units
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.events import Sink

MOST_CHARACTERS = 20_000
_TOO_LONG = f"The playground reads missions of up to {MOST_CHARACTERS:,} characters."
_WORDS = RobotWords()


class Playground:
    """The playground of one page. Texts are missions in the house that ships; there are no files beside them.

    The methods answer with JSON, and never raise: `problem` is what went wrong, in a sentence.
    """

    def __init__(self) -> None:
        self._run: _HouseRun | None = None

    def house(self) -> str:
        """Return the map of the house and where the robot stands, as the messages of a Feed."""
        return _answer(lambda: {"news": _first_news()})

    def ask(self, kind: str, text: str, arguments: str = "{}") -> str:
        """Return what is asked of a text: see btlang.editing.queries. The arguments are JSON; places are UTF-16."""
        return _answer(lambda: _query(kind, text, json.loads(arguments)))

    def begin(self, text: str) -> str:
        """Begin a run of a mission, in place of the one before, in a house where nothing has happened."""
        return _answer(lambda: self._begin(text))

    def advance(self, seconds: float, patience: float) -> str:
        """Let so many seconds of the mission pass, but not many more than `patience` seconds of real time.

        `passed` are the seconds that did, `seconds` those since the beginning, and `news` the messages of a Feed about
        them. Once it's `over`, `ended` says how, and `why` it failed.
        """
        return _answer(lambda: {} if self._run is None else self._run.advance(seconds, patience))

    def hear(self, text: str) -> str:
        """Let the robot hear an answer to what it asks."""
        return _answer(lambda: {} if self._run is None else self._run.hear(text))

    def stop(self) -> str:
        """End the run, and bring the robot to rest."""
        return _answer(lambda: {} if self._run is None else self._run.stop())

    def _begin(self, text: str) -> dict[str, Any]:
        source = _source(text)
        try:
            mission = _WORDS.mission(source)
            check_words(mission.tree, mission.vocabulary, mission.label)
            self._run = _HouseRun(mission)
        except MissionError as error:
            self._run = None
            return in_units({"ok": False, "messages": messages(error.diagnostics, source)}, text)
        return {"ok": True, "messages": [], "news": self._run.news()}


class _HouseRun:
    """A run that nothing but `advance` moves on."""

    def __init__(self, mission: Mission) -> None:
        self._session = Session(world=mission.world)
        self._run: Run = self._session.prepare(mission, speed="max")
        self._input = WorldInput()
        self._feed = Feed(NoTasks(), _robot_state, {}, self._session.world, question=lambda: self._input.question)
        self.news: Callable[[], list[dict[str, Any]]] = self._feed.polled()
        sinks: list[Sink] = [self._input, *self._feed.sinks(1, mission, self._run)]
        for sink in sinks:
            self._run.bus.add(sink)

    def advance(self, seconds: float, patience: float) -> dict[str, Any]:
        """See Playground.advance."""
        run, began, end = self._run, self._run.seconds, perf_counter() + patience
        status = Status.RUNNING
        while status == Status.RUNNING and run.seconds - began < seconds - 1e-9:
            status = run.tick()
            if perf_counter() >= end:
                break
        if status == Status.RUNNING:
            return {"news": self.news(), "over": False, "passed": run.seconds - began, "seconds": run.seconds}
        return self._ended(str(run.outcome).partition("\n")[0], run.why())  # its further lines say why, too

    def hear(self, text: str) -> dict[str, Any]:
        """See Playground.hear."""
        self._input.type(text)
        return {"news": self.news()}

    def stop(self) -> dict[str, Any]:
        """See Playground.stop."""
        return self._ended(f"Stopped after {self._run.seconds:.1f} s.", "")

    def _ended(self, ended: str, why: str) -> dict[str, Any]:
        succeeded = self._run.succeeded
        self._run.halt()
        self._session.close()
        return {"news": self.news(), "over": True, "ended": ended, "why": why, "succeeded": succeeded}


def _first_news() -> list[dict[str, Any]]:
    """Return the messages about the house before any run."""
    world = read_world(DEFAULT_WORLD)
    start = {"pose": [world.start.x, world.start.y, world.start.heading], "battery": None, "left": None, "right": None}
    return [{"type": "map", **world.as_map()}, {"type": "robot", **_robot_state(), **start}]


def _robot_state() -> dict[str, Any]:
    return {"stopped": "", "paused": False, "hindrance": "", "visitors": False, "talks": False}


def _query(kind: str, text: str, arguments: dict[str, Any]) -> dict[str, Any]:
    units = Utf16Units(text)
    given = {name: units.character(value) if name in PLACES else value for name, value in arguments.items()}
    return in_units(answer_of(DOES[kind], _source(text), _WORDS, given), text)


def _source(text: str) -> Source:
    """Return a text as a mission. Raises _Refused for one that is too long."""
    if len(text) > MOST_CHARACTERS:
        raise _Refused(_TOO_LONG)
    return _WORDS.source(text)


class _Refused(Exception):
    """The error of a text that isn't read, in a sentence."""


def _answer(find: Callable[[], dict[str, Any]]) -> str:
    try:
        found = find()
    except _Refused as refused:
        found = {"ok": False, "problem": str(refused)}
    except ModuleNotFoundError as error:
        found = {"ok": False, "problem": f"This needs the package {error.name}, which the playground doesn't have."}
    except Exception as error:
        found = {"ok": False, "problem": f"An error inside btlang: {describe_exception(error)}"}
    return json.dumps(found, default=str, separators=(",", ":"))
