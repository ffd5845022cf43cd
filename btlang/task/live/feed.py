"""What happens on a robot and becomes of its tasks, for any number of watchers, none of which can delay it."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import suppress

from btlang.api import Mission
from btlang.engine.status import NAMES
from btlang.house_rules import describe_rules
from btlang.passes.scripts import is_prepared
from btlang.run.bus import INLINE
from btlang.run.events import LOGGED, Arrived, DoorMoved, Ended, Event, PeriodPassed, StatusesChanged, Stopped
from btlang.run.follower import KnownNodes
from btlang.run.logs import as_json
from btlang.run.robot_state import RobotState, ask_sensor, round_scan
from btlang.run.sampler import numbers_in
from btlang.run.snapshot import Doing, find_questions, text_and_places
from btlang.session import Run
from btlang.task.live.robot_now import BodyNow, MapNow
from btlang.task.store.database import StoreError
from btlang.task.store.records import TaskChange
from btlang.text.source import Utf16Units

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    from btlang.robots.geometry import Point
    from btlang.robots.worlds.world import World
    from btlang.run.events import Sink
    from btlang.task.store.records import TaskChange
    from btlang.tree.node import Node

    class ChangeSource(Protocol):
        """The store of a feed: what became of tasks; see TaskStore."""

        listeners: list[Callable[[], object]]

        def latest_change(self) -> int: ...

        def changes(self, *, after: int, limit: int) -> Sequence[tuple[int, TaskChange]]: ...


_EARLY = 0.5  # of a period
_SHORTER = 0.95  # of a period: what comes once in each catches up after something came between


class Allowance:
    """A limit of how often something is sent: once in `period` seconds on average, within five in a hundred.

    What comes in step with that, but not evenly, need not wait: who slept out each period would fall behind by a little
    each time, up to a whole period.
    """

    def __init__(self, period: float) -> None:
        self._period = period * _SHORTER
        self._due = 0.0

    def wait(self, now: float) -> float:
        """Return the seconds until it may be sent."""
        return max(0.0, self._due - self._period * _EARLY - now)

    def use(self, now: float) -> None:
        """Count that it is sent."""
        self._due = max(self._due, now) + self._period


RATES = 0.1, 100.0
"""The least and the most messages of one kind in a second."""
_AGES = 1.0  # seconds between two messages about how old the readings are, also where nothing happens
_GATHERED, _GATHERED_AT_MOST = 0.2, 0.01  # of a period, and seconds: what comes so soon after other news goes with it
_SCANS = 0.5  # seconds between two
_MOST_EVENTS, _MOST_RUNS, _MOST_CHANGES = 1000, 16, 1000


class NoTasks:
    """The store of a feed without tasks."""

    def __init__(self) -> None:
        self.listeners: list[Callable[[], object]] = []

    def latest_change(self) -> int:
        """Return 0: there is no change."""
        return 0

    def changes(self, *, after: int, limit: int) -> Sequence[tuple[int, TaskChange]]:
        """Return no changes."""
        return ()


class _Watched:
    """A run with its task, 0 for the house rules between tasks.

    `changed` is when a status changed last, `valued` are nodes with the values of their keys.
    """

    def __init__(self, task: int, mission: Mission, run: Run) -> None:
        self.task, self.mission, self.run = task, mission, run
        self.changed = 0.0
        self.valued: dict[int, Node] = {}

    def take(self, event: StatusesChanged) -> None:
        """Take in changes, in the thread of the run."""
        self.valued.update(event.values_now())
        self.changed = event.wall


class Feed:
    """A feed of what happens on a robot.

    `sinks` makes the sinks of a run; `watch` reports the present state, then what happens.

    `robot` gives what keeps the robot from working, `words` are where its words and its world are, `world` is its map
    where it has one, `recordings` the folder of its recordings, "" for none, `parts` gives its components and devices,
    `question` gives what the robot is asking, "" for nothing. Methods may be called from any thread.
    """

    def __init__(
        self,
        store: ChangeSource,
        robot: Callable[[], dict[str, Any]],
        words: dict[str, Any],
        world: World | None = None,
        recordings: str = "",
        parts: Callable[[], dict[str, Any]] = dict,
        question: Callable[[], str] = str,
    ) -> None:
        self._recordings, self._look_at_parts, self._question = recordings, parts, question
        self._parts = parts()
        self._store, self._robot, self._words = store, robot, words
        self._map = None if world is None else MapNow(world)
        self._body = BodyNow()
        self._watchers: list[_Watcher] = []
        self._current: _Watched | None = None
        self._state: RobotState | None = None
        self._scan: list[float | None] = []
        self._scanned_from: list[float] | None = None
        self._planned: Sequence[Point] = ()
        self._way: list[list[float]] = []
        self._values: dict[str, float] = {}
        self._next_scan = 0.0
        self._read: dict[str, float] = {}  # when the state and the scan were read, on the clock of `_ages`
        self._doing = Doing()
        store.listeners.append(self.wake)

    def sinks(self, task: int, mission: Mission, run: Run) -> list[Sink]:
        """Make the sinks of a run that is about to begin: of the task with a number, 0 for the house rules."""
        watched = _Watched(task, mission, run)
        self._current, self._values = watched, {}
        self._doing = Doing(watched.task) if watched.task else self._doing
        for watcher in tuple(self._watchers):
            watcher.runs.append(watched)
        return [_Tap(self, watched)]

    def wake(self) -> None:
        """Let watchers look: something may have changed."""
        for watcher in tuple(self._watchers):
            watcher.news.set()

    def watch(self, rate: float = 10.0, after: int | None = None) -> Generator[dict[str, Any]]:
        """Yield messages, each with its "type", until it is closed or the robot goes down; the caller waits for the
        next one.

        The first one, "hello", has the number of the last change of a task that is known. A client that comes back with
        it as `after` first gets all changes since, unless the store is another one by now.
        """
        least, most = RATES
        latest = self._store.latest_change()
        watcher = _Watcher(latest if after is None else min(after, latest))
        if self._current is not None:
            watcher.runs.append(self._current)
        self._watchers.append(watcher)
        try:
            hello = {"change": watcher.change, "words": self._words, "recordings": self._recordings}
            yield {"type": "hello", **hello}
            with suppress(StoreError):  # it is closed, or can't be read
                yield from self._messages(watcher, 1.0 / min(max(rate, least), most))
        finally:
            self._watchers.remove(watcher)

    def polled(self) -> Callable[[], list[dict[str, Any]]]:
        """Return a function that gives the messages since it was called last, without waiting: for a single thread."""
        watcher = _Watcher(self._store.latest_change())
        self._watchers.append(watcher)
        return lambda: list(self._new(watcher))

    def take(self, watched: _Watched, event: Event) -> None:
        """Take in an event, in the thread of the run."""
        if isinstance(event, PeriodPassed):
            self._state = event.state
            self._read["state"] = time.monotonic()
            if self._map is not None:
                self._map.look(event.robot)
            if self._watchers:
                self._take_way(ask_sensor(lambda: event.robot.way) or ())
                self._body.look(event.robot, event.wall)
                blackboard = watched.run.nodes.blackboard
                self._values = dict(numbers_in((key, blackboard.get(key)) for key in blackboard.keys()))  # noqa: SIM118
            if self._watchers and event.wall >= self._next_scan:
                self._next_scan = event.wall + _SCANS
                self._scan, self._scanned_from = _scan(event), None if event.state is None else event.state.place
                self._read["scan"] = time.monotonic()
                self._parts = self._look_at_parts()
        elif isinstance(event, StatusesChanged):
            watched.take(event)
        else:
            self._doing = self._doing.after(event)
            if isinstance(event, Arrived | Stopped | Ended):
                self._way = []
            elif isinstance(event, DoorMoved) and self._map is not None:
                self._map.move_door(event)
        for watcher in tuple(self._watchers):
            if isinstance(event, LOGGED):
                watcher.events.append((watched, event))
            watcher.news.set()

    def _take_way(self, planned: Sequence[Point]) -> None:
        if planned is not self._planned:  # a robot that follows the same one has the same
            self._planned, self._way = planned, [[round(x, 2), round(y, 2)] for x, y in planned]

    def _messages(self, watcher: _Watcher, period: float) -> Iterator[dict[str, Any]]:
        allowance = Allowance(period)
        due = 0.0
        while True:
            yield from self._new(watcher)
            if time.monotonic() >= due:
                due = time.monotonic() + _AGES
                yield self._ages()
            if not watcher.news.wait(max(0.0, due - time.monotonic())):
                continue
            # A period ends just before the next tick: so one message reports both, and not the tick a period later.
            time.sleep(max(min(period * _GATHERED, _GATHERED_AT_MOST), allowance.wait(time.monotonic())))
            allowance.use(time.monotonic())
            watcher.news.clear()

    def _ages(self) -> dict[str, Any]:
        """Return how many seconds ago the state and the scan were read, None for never, and when that was found."""
        now = time.monotonic()
        ages = {kind: round(now - self._read[kind], 2) if kind in self._read else None for kind in ("state", "scan")}
        return {"type": "ages", "t": round(now, 3), **ages}

    def _new(self, watcher: _Watcher) -> Iterator[dict[str, Any]]:
        while found := self._store.changes(after=watcher.change, limit=_MOST_CHANGES):
            for number, change in found:
                watcher.change = number
                yield {"type": "change", "number": number, **change.as_dict()}
        while watcher.runs:
            watched = watcher.runs[0]
            yield from _statuses(watcher, watched)
            if watched is self._current or len(watcher.runs) == 1:
                break
            watcher.runs.popleft()
        while watcher.events:
            watched, event = watcher.events.popleft()
            yield {"type": "event", "task": watched.task, "event": as_json(event, watched.mission.label)}
        for message in self._states():
            kind = message["type"]
            if message != watcher.states.get(kind):
                watcher.states[kind] = message
                yield message

    def _states(self) -> Iterator[dict[str, Any]]:
        """Yield the messages of which only the newest counts, as they are now."""
        text, start, end = self._body.speech
        yield {"type": "robot", **self._robot(), **_state(self._state)}
        yield {"type": "components", **self._parts}
        if self._map is not None:
            yield {"type": "map", **self._map.written}
        yield {"type": "things", "things": () if self._state is None else self._state.things}
        yield {"type": "asking", "text": self._question()}
        yield {"type": "scan", "ranges": self._scan, "pose": self._scanned_from if self._scan else None}
        yield {"type": "way", "points": self._way}
        yield {"type": "doing", **self._doing.as_dict()}
        yield {"type": "joints", "positions": self._body.joints}
        yield {"type": "speech", "text": text, "start": start, "end": end}
        yield {"type": "values", "values": self._values}


_SILENT: tuple[dict[str, Any], ...] = (
    {"type": "components", "components": [], "devices": []},
    {"type": "things", "things": ()},
    {"type": "asking", "text": ""},
    {"type": "scan", "ranges": [], "pose": None},
    {"type": "way", "points": []},
    {"type": "doing", **Doing().as_dict()},
    {"type": "joints", "positions": []},
    {"type": "speech", "text": "", "start": 0, "end": 0},
    {"type": "values", "values": {}},
)
"""The states that a watcher takes for granted until it gets others."""


class _Watcher:
    """A watcher: what it knows, and what happened since."""

    def __init__(self, change: int) -> None:
        self.change = change
        self.news = threading.Event()
        self.runs: deque[_Watched] = deque(maxlen=_MOST_RUNS)
        self.events: deque[tuple[_Watched, Event]] = deque(maxlen=_MOST_EVENTS)
        self.states = {message["type"]: message for message in _SILENT}
        self.run = ""
        self.known = KnownNodes(0)


class _Tap:
    """A sink that hands a run's events to the feed."""

    policy = INLINE

    def __init__(self, feed: Feed, watched: _Watched) -> None:
        self._feed, self._watched = feed, watched

    def __call__(self, event: Event) -> None:
        if isinstance(event, (StatusesChanged, PeriodPassed, *LOGGED)):
            self._feed.take(self._watched, event)


def _statuses(watcher: _Watcher, watched: _Watched) -> Iterator[dict[str, Any]]:
    """Yield the tree of a run, if it is a new one, and the statuses that are new: those between are left out."""
    run = watched.run
    if watcher.run != run.id:
        watcher.run, watcher.known = run.id, KnownNodes(run.nodes.size)
        yield {"type": "run", "run": run.id, "task": watched.task, "outline": str(watched.mission), **_tree(watched)}
    changed = watched.changed  # before the statuses, so that none of them is older
    codes = run.follower.codes()  # none before the first event
    found = watcher.known.new_statuses(codes) if codes else []
    valued = watcher.known.new_values(watched.valued.copy())  # a copy: the run goes on
    if found or valued:
        changes = [[index, NAMES[status]] for index, status in found]
        words = [[index, watched.mission.words(node), node.id, dict(node.ports)] for index, node in valued]
        said = {"words": words, "language": watched.mission.vocabulary.language} if words else {}
        yield {"type": "statuses", "run": run.id, "t": changed, "changes": changes, **said}


def _tree(watched: _Watched) -> dict[str, Any]:
    mission, nodes = watched.mission, watched.run.nodes
    filled = [nodes.filled(index) for index in range(nodes.size)]
    listed = [[nodes.path(index), node.id, mission.words(node), dict(node.ports)] for index, node in enumerate(filled)]
    text, places = text_and_places(mission.syntax, nodes)
    unit = Utf16Units(text).unit
    spans = [place and [unit(place[0]), unit(place[1])] for place in places]
    parents = [nodes.parent(index) for index in range(nodes.size)]
    asks = [index for index, asks in enumerate(find_questions(filled, parents, mission.is_question)) if asks]
    prepared = [index for index, node in enumerate(filled) if is_prepared(node)]
    return {
        "nodes": listed, "prepared": prepared, "text": text, "spans": spans, "asks": asks,
        "named": [index for index, node in enumerate(filled) if node.name],
        "language": mission.vocabulary.language, **describe_rules(mission, nodes),
    }  # fmt: skip


def _state(state: RobotState | None) -> dict[str, Any]:
    known = RobotState() if state is None else state
    return {"pose": known.place, "battery": known.charge, "left": known.left, "right": known.right}


def _scan(event: PeriodPassed) -> list[float | None]:
    return round_scan(ask_sensor(lambda: [float(distance) for distance in event.robot.scan()]) or ())
