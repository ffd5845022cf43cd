"""The replay of a recording: its events at the pace of the mission, with pause and steps, also for pictures."""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import cached_property

from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.status import FAILURE, RUNNING
from btlang.recording.reader import RecordedNodes
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Point, Pose
from btlang.run.controls import Controls
from btlang.run.events import Event, PeriodPassed, StatusesChanged
from btlang.run.robot_state import RobotState
from btlang.run.snapshot import RunState, Shape, find_asked
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from btlang.run.events import Sink


_IN_FRONT = 0.4  # metres from its centre at which a robot puts things down, about


class RecordedRobot:
    """A robot as a recording knows it at one moment."""

    def __init__(self, state: RobotState) -> None:
        self._state = state
        self.radius = standard_body().radius

    @property
    def battery(self) -> float:
        """Return the charge. Raises ActionFailed where it was not known."""
        if self._state.battery is None:
            raise ActionFailed("how full the battery was isn't recorded")
        return self._state.battery

    @property
    def pose(self) -> Pose:
        """Return the pose. Raises ActionFailed where it was not known."""
        if self._state.pose is None:
            raise ActionFailed("where the robot was isn't recorded")
        pose: Pose = self._state.pose
        return pose

    def locate(self, name: str) -> Point:
        """Return where a thing lies that the robot has just put down: in front of it."""
        return self.pose.ahead(_IN_FRONT)


def adapt_picture(picture: Sink) -> Callable[[Event], object]:
    """Return the same sink for events of a recording."""

    def take(event: Event) -> None:
        if isinstance(event, PeriodPassed) and event.state is not None:
            event = event.replace(robot=RecordedRobot(event.state))
        picture(event)

    return take


_KEPT = 2_000  # changes of statuses between two states that are kept: a jump takes so many, some milliseconds


class ReplayTimeline:
    """The events of a run by their times, and the state of the run after any of them."""

    def __init__(self, events: Sequence[Event], nodes: RecordedNodes) -> None:
        self.events = events
        self._times = [event.t for event in events]
        self._nodes = [nodes.node(index) for index in range(nodes.size)]
        self._parents = [nodes.parent(index) for index in range(nodes.size)]
        self._shape = Shape(self._parents)
        self._kept: list[tuple[int, RunState]] = []  # how many events each has taken

    def count_before(self, t: float) -> int:
        """Return how many events there are up to a time, in seconds of the mission."""
        return bisect_right(self._times, t)

    @cached_property
    def failures(self) -> list[float]:
        """Return when nodes failed, in seconds of the mission. Conditions that say no are no failures."""
        asked = find_asked(self._nodes, self._parents)
        found: dict[float, None] = {}
        for event in self.events:
            for index, status, before, _ in event.changes if isinstance(event, StatusesChanged) else ():
                if status == FAILURE and not asked[index] and not self._is_awaited(index, before):
                    found[event.t] = None
        return list(found)

    def _is_awaited(self, index: int, before: int) -> bool:
        """Whether the mission waits until a leaf says yes: it is asked again and again, and takes no time itself."""
        node, parent = self._nodes[index], self._parents[index]
        kind = CATALOGUE.get(self._nodes[parent].id) if parent >= 0 else None
        is_question = not node.children and before != RUNNING
        return (
            is_question and kind is not None and kind.again == ON_FAILURE and kind.is_endless(self._nodes[parent].ports)
        )

    def state(self, count: int) -> RunState:
        """Return the state after so many events; the caller may change it."""
        if not self._kept:
            self._keep()
        at = bisect_right(self._kept, count, key=lambda kept: kept[0]) - 1
        taken, kept = self._kept[at]
        state = kept.copy()
        for event in self.events[taken:count]:
            state.take(event)
        return state

    def _keep(self) -> None:
        """Keep states in one pass over all events; they are as far apart as a tree is large, or they would fill the
        memory.
        """
        state, changes = RunState(self._shape, self._nodes), 0
        self._kept.append((0, state.copy()))
        apart = max(_KEPT, len(self._shape))
        for count, event in enumerate(self.events):
            state.take(event)
            changes += event.count or 1
            if changes >= apart:
                self._kept.append((count + 1, state.copy()))
                changes = 0


class Player:
    """A player of the events of a timeline. `controls` pause it, go on by one period, and end it, from any thread.

    A sink with a method `jump` gets the state of the run after a jump; others get what was left out, if it was forward.
    """

    def __init__(
        self, timeline: ReplayTimeline, sinks: Sequence[Callable[[Event], object]], controls: Controls
    ) -> None:
        self._timeline, self._sinks, self._controls = timeline, sinks, controls
        self._count = 0  # events that have been played
        self._wanted: float | None = None  # where to go on, in seconds of the mission

    def seek(self, t: float) -> None:
        """Go on behind what happened up to a time, in seconds of the mission. From any thread."""
        self._wanted = t
        self._controls.wake()

    def move(self, seconds: float) -> None:
        """Go so many seconds on, or back where they are negative. From any thread."""
        self.seek(max(0.0, (self._now if self._wanted is None else self._wanted) + seconds))

    def next_failure(self) -> None:
        """Go on to the next time at which a node failed, and pause there; do nothing if none follows."""
        following = next((t for t in self._timeline.failures if t > self._now), None)
        if following is not None:
            self._controls.pause()
            self.seek(following)

    def play(self, speed: float, start: float = -math.inf) -> bool:
        """Play to the end; return False if it was stopped before.

        `speed` is seconds of the mission per second of real time, math.inf for no waiting. What comes before `start`
        comes at once. A step goes on to the end of the next period.
        """
        if start > -math.inf:
            self._wanted = start
        began: float | None = None  # the real time at which the mission would have begun, None where it stands still
        controls, events = self._controls, self._timeline.events
        while not controls.stopped and (self._count < len(events) or self._wanted is not None):
            if self._wanted is not None:
                self._jump(self._timeline.count_before(self._wanted))
                began = None
                self._stand_still()
                continue
            event = events[self._count]
            if speed < math.inf:
                began = time.monotonic() - event.t / speed if began is None else began
                if not controls.paused and (left := began + event.t / speed - time.monotonic()) > 0:
                    controls.wait(left)
                    continue
            self._count += 1
            for sink in self._sinks:
                sink(event)
            if isinstance(event, PeriodPassed) and controls.paused:
                began = None
                self._stand_still()
        return not controls.stopped

    @property
    def _now(self) -> float:
        return self._timeline.events[self._count - 1].t if self._count else 0.0

    def _stand_still(self) -> None:
        """Wait until the pause is over, a step or a jump is asked for."""
        controls = self._controls
        while controls.paused and not controls.stopped and self._wanted is None and not controls.take_step():
            controls.wait(None)

    def _jump(self, count: int) -> None:
        self._wanted = None
        skipped, self._count = self._timeline.events[self._count : count], count
        for sink in self._sinks:
            jump = getattr(sink, "jump", None)
            if jump is not None:
                jump(self._timeline.state(count))
                continue
            for event in skipped:
                sink(event)
