"""A run as data that a page can play, from its beginning to its end: of a recording, or of a trial."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.api import Mission
from btlang.engine.compile import outline
from btlang.engine.status import NAMES
from btlang.passes.scripts import is_prepared
from btlang.recording.reader import RecordedNodes
from btlang.recording.story import Story
from btlang.robots.worlds.world_file import read_world
from btlang.run.bus import BLOCK
from btlang.run.events import LOGGED, Event, PeriodPassed, Sampled, StatusesChanged
from btlang.run.json_log import as_json
from btlang.run.known_nodes import KnownNodes, text_and_places
from btlang.run.robot_state import Movements, rounded_scan
from btlang.run.shape import Shape
from btlang.run.snapshot import State

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_CHANGES = 200_000
"""Of statuses in a film; a longer run ends there."""
_MOST_EVENTS = 20_000
_MOST_STATES = 50_000
_MOST_PLACES = 200_000  # of people and objects
_APART = 0.1  # seconds between two looks at where people are: more would fill the memory, and nobody would see it


class Film:
    """A sink that keeps what happens in a run of a mission, up to MOST_CHANGES; `data` gives it out."""

    policy = BLOCK

    def __init__(self, mission: Mission, about: dict[str, str] | None = None) -> None:
        self._mission, self._about = mission, about or {}
        self._nodes = RecordedNodes(*outline(mission.tree))
        self._story = Story(mission, self._nodes, self._about)
        indices = range(self._nodes.size)
        self._state = State(Shape([self._nodes.parent(at) for at in indices]), [self._nodes.node(at) for at in indices])
        self._known = KnownNodes(self._nodes.size)
        self._statuses: list[list[float | int]] = []
        self._words: list[list[Any]] = []
        self._doing: list[list[Any]] = []
        self._robot: list[list[Any]] = []
        self._things: list[list[Any]] = []
        self._movements, self._next_look = Movements(), 0.0
        self._latest: PeriodPassed | None = None
        self._scans: list[list[Any]] = []
        self._events: list[dict[str, Any]] = []
        self._count, self._end = 0, 0.0
        self.is_cut = False
        """Whether more happened than it keeps."""

    def take(self, events: Iterable[Event]) -> Film:
        """All that happened."""
        for event in events:
            self(event)
        return self

    def __call__(self, event: Event) -> None:
        """Keeps an event."""
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
            words = self._known.new_words(event.values_now(), self._mission.label)
            self._words += [[round(event.t, 3), *each] for each in words]
        elif isinstance(event, PeriodPassed):
            self._take_state(event)
            if event.t >= self._next_look - 1e-9:
                self._next_look = event.t + _APART
                self._take_things(event)
            self._latest = event
        elif isinstance(event, Sampled) and event.scan:
            self._scans.append([round(event.t, 3), rounded_scan(event.scan)])
        elif isinstance(event, LOGGED):
            self._events.append(as_json(event, self._mission.label))
            doing = [*self._state.doing.as_dict().values()]
            if not self._doing or self._doing[-1][1:] != doing:
                self._doing.append([round(event.t, 3), *doing])
        full = self._count > MOST_CHANGES or len(self._events) > _MOST_EVENTS
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
        """As JSON has it.

        - `text`: the mission, "" where it had none; `nodes`: in preorder, with the number of the parent (-1: the root)
          and the characters of the text that say it (None for none); `prepared` are those whose children but the
          last only compute values for that one; `names`: those of statuses;
        - `words`: time, node and what it says with the values of its keys, where these are new;
        - `statuses`: a time in seconds, then node and status (a number of `names`) in turn, as a live view has them;
        - `doing`: time, task (0), where it is going, what it said and heard last, where one of these is new;
        - `robot`: time, x, y (metres), heading (degrees), battery (percent), what the left and the right hand hold;
        - `things`: time, name, x, y (metres, None where it isn't there) and whether the robot sees it, where one of
          these is new; of people who walk and of what the robot doesn't know by its world;
        - `scans`: time and metres, counter-clockwise from straight ahead; `events`: see btlang/run/events.schema.json;
        - `story`: time, node (-1: none) and words; `why`: how it ended; `failed`: the node that failed, or -1;
        - `seconds`: how long it is; `is_cut`: whether more happened than is kept; `map`: see World.as_map.
        """
        nodes, mission = self._nodes, self._mission
        text, places = text_and_places(mission.syntax, nodes)
        if self._latest is not None:
            self._take_things(self._latest)
        listed = []
        for index in range(nodes.size):
            node, (start, end) = nodes.node(index), places[index] or (None, None)
            listed.append(
                {
                    "parent": nodes.parent(index), "id": node.id, "label": mission.label(node), "ports": node.ports,
                    "start": start, "end": end, "prepared": is_prepared(node),
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
            "events": self._events,
            "story": [[round(t, 3), index, words] for t, index, words in self._story.notes],
            "why": "\n".join(self._story.ending()),
            "failed": self._story.failed,
            "seconds": round(self._end, 3),
            "is_cut": self.is_cut,
            "map": read_world(mission.world).as_map(),
        }
