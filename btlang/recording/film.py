"""Runs as data that a page can play: of a recording, of two side by side, or of a trial in the simulated world."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
from functools import partial
from operator import itemgetter

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.engine.compile import outline
from btlang.engine.status import FAILURE, IDLE, NAMES
from btlang.house_rules import describe_rules
from btlang.passes.scripts import is_prepared
from btlang.recording.bundle import TREE
from btlang.recording.diff import compare_endings, first_pair, mission_differences, only_in_one, steps
from btlang.recording.reader import RecordedNodes, open_recording, read_recording
from btlang.recording.story import NO_REASON, Story
from btlang.robots.worlds.world_file import read_world
from btlang.run.bus import BLOCK
from btlang.run.events import LOGGED, Ended, Event, PeriodPassed, Sampled, StatusesChanged
from btlang.run.follower import KnownNodes
from btlang.run.logs import as_json
from btlang.run.robot_state import Movements, round_scan
from btlang.run.sampler import Sampler, numbers_in
from btlang.run.snapshot import RunState, Shape, find_questions, text_and_places
from btlang.session import Session
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from btlang.run.events import Sink
    from btlang.run.outcome import Outcome
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon


MOST_CHANGES = 200_000
"""The limit of changes of statuses in a film; a longer run ends there."""
_MOST_EVENTS = 20_000
_MOST_STATES = 50_000
_MOST_PLACES = 200_000  # of people and objects
_APART = 0.1  # seconds between two looks at where people are: more would fill the memory, and nobody would see it


class Film:
    """A sink that keeps what happens in a run of a mission, up to MOST_CHANGES; `data` gives it out.

    The words of nodes are the mission's, or in another `language` (see Mission.words).
    """

    policy = BLOCK

    def __init__(self, mission: Mission, about: dict[str, str] | None = None, language: str = "") -> None:
        self._mission, self._about = mission, about or {}
        self._label = partial(mission.words, language=language)
        self._nodes = RecordedNodes(*outline(mission.tree))
        self._story = Story(mission, self._nodes, self._about, self._label)
        indices = range(self._nodes.size)
        self._state = RunState(
            Shape([self._nodes.parent(at) for at in indices]), [self._nodes.node(at) for at in indices]
        )
        self._known = KnownNodes(self._nodes.size)
        self._statuses: list[list[float | int]] = []
        self._words: list[list[Any]] = []
        self._doing: list[list[Any]] = []
        self._robot: list[list[Any]] = []
        self._things: list[list[Any]] = []
        self._movements, self._next_look = Movements(), 0.0
        self._latest: PeriodPassed | None = None
        self._scans: list[list[Any]] = []
        self._values: list[list[Any]] = []
        self._events: list[dict[str, Any]] = []
        self._count, self._end = 0, 0.0
        self.is_cut = False
        """Whether more happened than it keeps."""

    def take(self, events: Iterable[Event]) -> Film:
        """Take in all that happened."""
        for event in events:
            self(event)
        return self

    def __call__(self, event: Event) -> None:
        """Keep an event."""
        if self.is_cut:
            return
        self._story.take((event,))
        self._state.take(event)
        self._end = max(self._end, event.t)
        if isinstance(event, StatusesChanged):
            changes = self._known.new_statuses(bytes(self._state.statuses))
            if changes:
                self._statuses.append([round(event.t, 3), *(number for change in changes for number in change)])
            self._count += len(changes)
            valued = self._known.new_values(event.values_now())
            self._words += [[round(event.t, 3), index, self._label(node)] for index, node in valued]
        elif isinstance(event, PeriodPassed):
            self._take_state(event)
            if event.t >= self._next_look - 1e-9:
                self._next_look = event.t + _APART
                self._take_things(event)
            self._latest = event
        elif isinstance(event, Sampled):
            if event.scan:
                self._scans.append([round(event.t, 3), round_scan(event.scan)])
            self._values += [[round(event.t, 3), *each] for each in numbers_in(event.values.items())]
        elif isinstance(event, LOGGED):
            self._events.append(as_json(event, self._mission.label))
            doing = [*self._state.doing.as_dict().values()]
            if not self._doing or self._doing[-1][1:] != doing:
                self._doing.append([round(event.t, 3), *doing])
        full = self._count > MOST_CHANGES or len(self._events) > _MOST_EVENTS
        full = full or len(self._values) > _MOST_STATES
        self.is_cut = full or len(self._robot) > _MOST_STATES or len(self._things) > _MOST_PLACES

    def _take_state(self, event: PeriodPassed) -> None:
        state = event.state
        if state is None:
            return
        now: list[Any] = [*(state.place or (None, None, None)), state.charge, state.left, state.right]
        if not self._robot or self._robot[-1][1:] != now:
            self._robot.append([round(event.t, 3), *now])

    def _take_things(self, event: PeriodPassed) -> None:
        if event.state is not None:
            self._things += [[round(event.t, 3), *each] for each in self._movements.changed(event.state.things)]

    def data(self) -> dict[str, Any]:
        """Return the film as JSON has it.

        - `text`: the mission, "" where it had none; `nodes`: in preorder, with the number of the parent (-1: the root)
        and the characters of the text that say it (None for none); with `asks` it only asks; `prepared` are those whose
        children but the last only compute values for that one; `names`: those of statuses;
        - `words`: time, node and what it says with the values of its keys, where these are new;
        - `statuses`: a time in seconds, then node and status (a number of `names`) in turn, as a live view has them;
        - `doing`: time, task (0), where it is going, what it said and heard last, where one of these is new;
        - `robot`: time, x, y (metres), heading (degrees), battery (percent), what the left and the right hand hold;
        - `things`: time, name, x, y (metres, None where it isn't there) and whether the robot sees it, where one of
        these is new; of people who walk and of what the robot doesn't know by its world;
        - `values`: time, name and number of what the mission counts or measures, where it is new;
        - `scans`: time and metres, counter-clockwise from straight ahead; `events`: see btlang/run/events.schema.json;
        - `story`: time, node (-1: none) and words, of a node how it ended (see `names`) and why; `ending`: how the
        run ended (see Story.ending_data);
        - `failed`: the node that failed, or -1;
        - `rules`, `root`: the house rules round it, and the first node of the mission itself (see describe_rules);
        - `seconds`: how long it is; `is_cut`: whether more happened than is kept; `map`: see World.as_map.
        """
        nodes, mission = self._nodes, self._mission
        text, places = text_and_places(mission.syntax, nodes)
        if self._latest is not None:
            self._take_things(self._latest)
        parents = [nodes.parent(index) for index in range(nodes.size)]
        asks = find_questions([nodes.node(index) for index in range(nodes.size)], parents, mission.is_question)
        listed = []
        for index in range(nodes.size):
            node, (start, end) = nodes.node(index), places[index] or (None, None)
            listed.append(
                {
                    "parent": nodes.parent(index), "id": node.id, "label": self._label(node), "ports": node.ports,
                    "start": start, "end": end, "prepared": is_prepared(node),
                    "asks": asks[index],
                }
            )  # fmt: skip
        return {
            "about": self._about,
            "text": text,
            "names": list(NAMES),
            "nodes": listed,
            "words": self._words,
            "statuses": self._statuses,
            "doing": self._doing,
            "robot": self._robot,
            "things": self._things,
            "scans": self._scans,
            "values": self._values,
            "events": self._events,
            "story": [[round(t, 3), *more] for t, *more in self._story.notes],
            "ending": self._story.ending_data(),
            "failed": self._story.failed,
            "seconds": round(self._end, 3),
            "is_cut": self.is_cut,
            **describe_rules(mission, nodes),
            "map": read_world(mission.world).as_map(),
        }


def side_by_side(one: str, other: str, language: str = "") -> dict[str, Any]:
    """Return two recordings, by their paths, as JSON has it; runs nothing. Raises MissionError for what can't be read.

    - `films`: see Film.data; `stories`: what only one of the runs did: its number, then as in the `story` of a film;
    - `missions`: what differs between their trees, as `btc diff` writes it; nodes are compared only where nothing does:
    - `first`: of each run the time, node, status and reason of the first change of status that the other one doesn't
    have, with None and -1 for a run that has no more; None if there is none. Times don't count;
    - `ended`: the numbers of the nodes whose last status isn't the same.
    """
    with ExitStack() as stack:
        sides = [stack.enter_context(open_recording(path)) for path in (one, other)]
        films = [Film(mission, dict(recording.about), language) for recording, mission, _ in sides]
        events = [list(recording.events(nodes)) for recording, _, nodes in sides]
        data = [film.take(happened).data() for film, happened in zip(films, events, strict=True)]
        stories = [each["story"] for each in data]
        missions = list(mission_differences(sides[0][1], sides[1][1]))
        pair = None if missions else first_pair(*events)
        none = (None, -1, IDLE, "")
        first = pair and [
            {"t": t, "node": node, "status": NAMES[status], "reason": "" if reason in NO_REASON else reason}
            for t, node, status, reason in (step or none for step in pair)
        ]
        return {
            "films": data,
            "stories": [[which, *row] for which, row in only_in_one(stories[0], stories[1], itemgetter(2, 3))],
            "missions": missions,
            "first": first,
            "ended": [] if missions else compare_endings(*events),
        }


def count_failures(paths: Sequence[str]) -> dict[str, Any]:
    """Return what failed in runs of one mission, by their paths; those of others than the first one are left out.

    - `runs`: how many they are; `failed`: how many of them failed;
    - `failures`: the numbers of nodes, each with the number of runs in which it failed. Questions, whose failure is an
    answer, are left out where it didn't end the run.

    Raises MissionError for a first one that can't be read.
    """
    with open_recording(paths[0]) as (first, mission, nodes):
        indices = range(nodes.size)
        parents, at = [nodes.parent(index) for index in indices], {nodes.path(index): index for index in indices}
        asks = find_questions([nodes.node(index) for index in indices], parents, mission.is_question)
        counts, runs, failed = Counter[int](), 0, 0
        for path in paths:
            with suppress(MissionError):
                recording = read_recording(path)
                if recording.files.get(TREE) != first.files.get(TREE):
                    continue
                events = list(recording.events(nodes))
                now = {index for _, index, status, _ in steps(events) if status == FAILURE and not asks[index]}
                ends = [at[end.path] for end in events if isinstance(end, Ended) and end.path in at and not end.stopped]
                counts.update(now.union(ends))
                runs, failed = runs + 1, failed + len(ends)
        return {"runs": runs, "failed": failed, "failures": sorted(counts.items())}


MOST_SECONDS = 3600.0
"""The limit of the mission's time."""
_MOST_TICKS = 72_000
_RATE = 20.0
_SCANS = 2.0  # in a second of the mission
_ENDING = 2.0  # seconds that a stopped run may take at least to end
OURS = "btlang.actions."
"""The prefix of modules whose functions do nothing but command the robot that they are given."""


def simulate(
    mission: Mission,
    sink: Sink,
    seconds: float,
    patience: float,
    ticks: int = _MOST_TICKS,
    seed: int | None = None,
) -> tuple[Outcome | None, str]:
    """Run a mission on the simulated robot, as fast as possible, for at most so many seconds of the mission and ticks.

    The outcome, None for a mission with a command that never returns, and what stopped it: "" if it ended by itself. It
    is stopped after `patience` seconds of real time. Raises MissionError for a mission that can't be run.
    """
    mission.check()
    limit = min(max(seconds, 0.0), MOST_SECONDS, min(max(ticks, 1), _MOST_TICKS) / _RATE)
    options: dict[str, Any] = {} if seed is None else {"seed": seed}
    session = Session("simulated", world=mission.world)
    run = session.prepare(mission, speed="max", rate=_RATE, time_limit=limit, sinks=(sink,), **options)
    run.bus.add(Sampler(run.bus, run.nodes.blackboard, _SCANS))
    run.start()
    outcome = run.wait(patience)
    if outcome is not None:
        session.close()
        return outcome, outcome.stopped
    run.stop()
    outcome = run.wait(max(patience, _ENDING))
    if outcome is not None:  # closing the session would wait for the command
        session.close()
    return outcome, "it took too long to simulate"


def check_words(tree: Tree, vocabulary: Lexicon, label: Callable[[Node], str], further: str = OURS) -> None:
    """Raise MissionError (BT221) for a tree with words that are no words of btlang: what they do might move a real
    robot. `further` is where the names of functions of other words that are allowed begin.
    """
    for node in tree.walk():
        entry = vocabulary.entry(node.id)
        if entry is not None and not str(entry.call).startswith((OURS, further)):
            raise MissionError([diagnostic("BT221", node.span or NOWHERE, words=label(node), file=entry.file)])


def try_mission(
    mission: Mission, seconds: float = 600.0, patience: float = 6.0, seed: int | None = None
) -> dict[str, Any]:
    """Return the film of a run (see Film.data) of at most so many seconds of the mission and `patience` seconds of real
    time, and what `stopped` it: "" if it ended by itself.

    Raises MissionError for a mission that can't be run, and BT221 for one with words that are no words of btlang: what
    they do might move a real robot.
    """
    check_words(mission.tree, mission.vocabulary, mission.label)
    film = Film(mission)
    _, stopped = simulate(mission, film, seconds, patience, seed=seed)
    return {**film.data(), "stopped": stopped}
