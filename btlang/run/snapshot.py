"""What is known of a run: the status of each node, the robot, the counts; and what of it is new for a page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from btlang.engine.changes import reports_each_round
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.events import Arrived, Ended, Heard, NavigationStarted, PeriodPassed, Said, StatusesChanged, Stopped
from btlang.run.robot_state import RobotState
from btlang.run.statuses import Status
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    from btlang.engine.changes import Changes
    from btlang.run.events import Event, Nodes
    from btlang.text.source import Span
    from btlang.tree.node import Node

    class WatchedNodes(Nodes, Protocol):
        """The nodes of a run that goes on (btlang.engine.engine.Engine), or of a recorded one."""

        def parent(self, index: int) -> int: ...

    class Spans(Protocol):
        """The nodes of a run by their numbers: a btlang.engine.engine.Engine, or those of a recording."""

        @property
        def size(self) -> int: ...

        def span(self, index: int) -> Span | None: ...


class Shape:
    """A node is its preorder number; all below node i are the numbers from i + 1 up to `ends[i]` (exclusive).

    `parents` holds the parent of each node (-1: the root), `before` the sibling in front of it (-1: there is none),
    `depths` the distance to the root, and `depth` the largest of them.
    """

    __slots__ = ("before", "depth", "depths", "ends", "parents")

    def __init__(self, parents: Sequence[int]) -> None:
        count = len(parents)
        self.parents = list(parents)
        self.ends = [i + 1 for i in range(count)]
        for i in range(count - 1, 0, -1):
            parent = parents[i]
            if self.ends[parent] < self.ends[i]:
                self.ends[parent] = self.ends[i]
        self.before, self.depths = [-1] * count, [0] * count
        latest = [-1] * count
        for i in range(1, count):
            self.before[i] = latest[parents[i]]
            latest[parents[i]] = i
            self.depths[i] = self.depths[parents[i]] + 1
        self.depth = max(self.depths)

    def __len__(self) -> int:
        return len(self.parents)

    def children(self, node: int) -> Iterator[int]:
        """Yield the children of a node in order."""
        child, end = node + 1, self.ends[node]
        while child < end:
            yield child
            child = self.ends[child]

    def after(self, node: int) -> int:
        """Return the sibling behind a node, -1 if there is none."""
        parent, end = self.parents[node], self.ends[node]
        return end if parent >= 0 and end < self.ends[parent] else -1


HALTED = IDLE + 1
"""The status of a node that was RUNNING and was halted."""
SUSPENDED = HALTED + 1
"""The status of a node that was halted by a pause, or by the end of the run."""


def find_asked(nodes: Sequence[Node], parents: Sequence[int]) -> list[bool]:
    """Return for each node whether its failure is an answer: it belongs to the condition of a rule, an `if` or a
    `while`. `parents` are the numbers of the nodes above, -1 for none.
    """
    asked = [False] * len(nodes)
    for index, parent in enumerate(parents):
        if parent >= 0:
            kind = CATALOGUE.get(nodes[parent].id)
            asked[index] = asked[parent] or (index == parent + 1 and kind is not None and kind.asks_first)
    return asked


def find_questions(nodes: Sequence[Node], parents: Sequence[int], is_question: Callable[[Node], bool]) -> list[bool]:
    """Return for each node whether it only asks: it's a condition, or leads nothing but conditions."""
    asks = [True] * len(nodes)
    inner = set(parents)
    for index in range(len(nodes) - 1, -1, -1):
        if index not in inner:
            asks[index] = is_question(nodes[index])
        if not asks[index] and parents[index] >= 0:
            asks[parents[index]] = False
    return asks


class Snapshot(Record):
    """A run after the event with this `number`, at `t` seconds of the mission: for who joins late.

    `statuses` are those of the nodes that were reached, by path; HALTED and SUSPENDED nodes count as IDLE. `running`
    are the words of the commands under way, `said` what the robot said last.
    """

    run: str
    number: int
    t: float
    status: Status
    statuses: Mapping[str, Status]
    running: tuple[str, ...]
    said: str
    robot: RobotState | None


class Doing(Record):
    """The activity of a robot, in words: the number of its task (0: none), where it is going, what it said and heard
    last.
    """

    task: int = 0
    goal: str = ""
    says: str = ""
    heard: str = ""

    def after(self, event: Event) -> Doing:
        """Return what it does after an event."""
        if isinstance(event, Said):
            return Doing(self.task, self.goal, event.text, self.heard)
        if isinstance(event, Heard):
            return Doing(self.task, self.goal, self.says, event.text)
        if isinstance(event, NavigationStarted | Arrived | Stopped | Ended):
            task = 0 if isinstance(event, Ended) else self.task
            return Doing(task, event.name if isinstance(event, NavigationStarted) else "", self.says, self.heard)
        return self


class RunState:
    """The state of a run, which follows its status changes. `statuses` holds one number for each node, in preorder.

    A node that is started again keeps nothing of its earlier round: what it has not reached yet is IDLE again. Where
    that round was over within a tick, this is so once the new one is RUNNING (see btlang/engine/status_trace.py).
    `nodes` are those of the tree. It is `brief` where nobody asks when nodes started and ended, and why they failed.
    """

    def __init__(self, shape: Shape, nodes: Sequence[Node], brief: bool = False) -> None:
        self.shape = shape
        self.statuses = bytearray([IDLE]) * len(shape)
        self.started: dict[int, float] = {}
        self.ended: dict[int, float] = {}
        self.reasons: dict[int, str] = {}
        self.doing = Doing()
        self.now = 0.0
        self.ticks = 0
        self.overruns = 0
        self.robot: RobotState | None = None
        self._nodes = nodes
        self._brief = brief
        self._over = bytearray(len(shape))  # 1: this run of the node is over, a new one clears what is below it
        self._seen = [0] * len(shape)  # the sweep in which a node was last found to need no clearing
        self._sweep = 1
        self._halted: list[int] = []  # by the halts that come in a row
        self._completions: list[Iterable[int]] = []  # nodes that completed or were halted at one time
        self._completed: set[int] = set()  # more of them
        self._completed_at = -1.0

    def copy(self) -> RunState:
        """Return another one, which goes on from here by itself."""
        other = RunState.__new__(RunState)
        for name, value in vars(self).items():
            shared = name in ("shape", "_nodes") or not isinstance(value, bytearray | dict | list | set)
            setattr(other, name, value if shared else value.copy())
        return other

    def take(self, event: Event) -> None:
        """Take in an event of the run."""
        if isinstance(event, StatusesChanged):
            if self._brief:
                self._take_brief(event.changes, event.t)
                return
            for index, status, _, reason in event.without_paths():
                self.change(index, status, event.t, reason)
        elif isinstance(event, PeriodPassed):
            self.now, self.ticks, self.overruns, self.robot = event.t, event.ticks, event.overruns, event.state
        else:
            self.doing = self.doing.after(event)

    def change(self, index: int, status: int, t: float, reason: str = "") -> None:
        """Take in that a node has a new status."""
        self._begin_anew(index)
        before = self.statuses[index]
        if status == IDLE:
            self._halt(index, t)
            return
        if self._halted:
            self._halted = []
        if status == RUNNING:
            if before in (SUCCESS, FAILURE, SKIPPED):
                self._clear_older(index, t)
            if before != SUSPENDED or not self._has_children(index):  # a command starts again, what is above goes on
                self.started[index] = t
            self.statuses[index] = RUNNING
            if index == 0:
                self.statuses[:] = self.statuses.replace(bytes([SUSPENDED]), bytes([HALTED]))
            return
        if before not in (RUNNING, SUSPENDED):
            self.started[index] = t
        self.statuses[index] = status
        self.ended[index] = t
        self._note_completed((index,), t)
        if status == FAILURE:
            self.reasons[index] = reason
        if before == RUNNING or (index and reports_each_round(self._nodes[self.shape.parents[index]])):
            self._end_run(index)

    def _take_brief(self, changes: Changes, t: float) -> None:
        for entry in changes.entries:
            if isinstance(entry, int):
                self.change(entry >> 6, entry & 7, t)
                continue
            if entry.has_running:
                for index, status, _, _ in entry:
                    self.change(index, status, t)
                continue
            self._halted = []
            top = self._over.find(1)
            while top >= 0:
                following = top + 1
                if entry.touches(top):
                    following = self._clear_below(top)
                top = self._over.find(1, following)
            for index, status in zip(entry.nodes, entry.statuses, strict=True):
                self.statuses[index] = status
            self._note_completed(entry.nodes, t)

    def _note_completed(self, nodes: Iterable[int], t: float) -> None:
        if t != self._completed_at:
            self._completed_at = t
            self._completed.clear()
            self._completions.clear()
        self._completions.append(nodes)

    def _halt(self, index: int, t: float) -> None:
        self.statuses[index] = HALTED
        self.ended[index] = t
        self._note_completed((index,), t)
        self._end_run(index)
        self._halted.append(index)
        if index == 0:  # the tree as a whole: the run is over or suspended, and then goes on where it was
            for node in self._halted:
                self.statuses[node] = SUSPENDED
                self._over[node] = 0
            self._halted = []

    def _end_run(self, index: int) -> None:
        if self._has_children(index):
            self._over[index] = 1
            self._sweep += 1

    def _begin_anew(self, index: int) -> None:
        """Begin the new run of a node: children report changes before their parents do, so the first change below it
        does.
        """
        over, top, parents = self._over, -1, self.shape.parents
        node = index
        while node >= 0 and self._seen[node] != self._sweep:
            self._seen[node] = self._sweep
            if over[node]:
                top = node
            node = parents[node]
            if node >= 0 and self.statuses[node] == RUNNING:
                break
        if top >= 0:
            self._clear_below(top)

    def _clear_below(self, top: int) -> int:
        """Clear all below a node whose new run begins; return the number of the node behind it."""
        end = self.shape.ends[top]
        self.statuses[top + 1 : end] = bytes([IDLE]) * (end - top - 1)
        self._over[top:end] = bytes(end - top)
        return end

    def _clear_older(self, index: int, t: float) -> None:
        """Clear all below a node but what has just changed."""
        self._note_completed((), t)
        self._completed.update(*self._completions)
        self._completions.clear()
        node, end = index + 1, self.shape.ends[index]
        while node < end:
            if self.statuses[node] == RUNNING:  # which has cleared what is below it
                node = self.shape.ends[node]
                continue
            if node not in self._completed:
                self.statuses[node] = IDLE
            node += 1

    def is_leaf(self, index: int) -> bool:
        """Return whether nothing is below a node."""
        return not self._has_children(index)

    def _has_children(self, index: int) -> bool:
        return self.shape.ends[index] > index + 1


def text_and_places(syntax: Any, nodes: Spans) -> tuple[str, list[tuple[int, int] | None]]:
    """Return the text that a mission was read from, and the characters of it that say each node.

    `syntax` is that of a btlang.api.Mission, None for one without a text. A node that another file says has no place.
    """
    source = None if syntax is None else syntax.span.source
    spans = [nodes.span(index) for index in range(nodes.size)]
    places = [(span.start, span.end) if span is not None and span.source is source else None for span in spans]
    return "" if source is None else source.text, places
