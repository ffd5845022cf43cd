"""What is known of a run: the status of each node and when it got it, the robot, the counts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.leaf import ActionFailed
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.engine.watch import repeats
from btlang.record import Record
from btlang.run.live.shape import Shape

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.events import PeriodPassed
    from btlang.tree.node import Node

HALTED = IDLE + 1
"""Was RUNNING and was halted."""
SUSPENDED = HALTED + 1
"""Was halted by a pause, or by the end of the run."""


class Reading(Record):
    """What was read from a robot; None for what it does not tell."""

    pose: Any = None
    battery: float | None = None
    left: str | None = None
    right: str | None = None


def read_robot(robot: Any) -> Reading | None:
    """The reading of a robot, None where there is no robot. For the thread of the run."""
    if robot is None:
        return None
    hands = (_told(lambda: robot.holding("left")), _told(lambda: robot.holding("right")))
    return Reading(_told(lambda: robot.pose), _told(lambda: robot.battery), *hands)


def _told(ask: Callable[[], Any]) -> Any:
    """None where the robot has no such sensor, or it is silent."""
    try:
        return ask()
    except (ActionFailed, AttributeError):
        return None


class State:
    """Follows the status changes of a run. `statuses` holds one number for each node, in preorder.

    A node that is started again keeps nothing of its earlier round: what it has not reached yet is IDLE again. Where
    that round was over within a tick, this is so once the new one is RUNNING (see btlang/engine/watch.py).
    `nodes` are those of the tree.
    """

    def __init__(self, shape: Shape, nodes: Sequence[Node]) -> None:
        self.shape = shape
        self.statuses = bytearray([IDLE]) * len(shape)
        self.started: dict[int, float] = {}
        self.ended: dict[int, float] = {}
        self.reasons: dict[int, str] = {}
        self.said = ""
        self.now = 0.0
        self.ticks = 0
        self.overruns = 0
        self.robot: Reading | None = None
        self._nodes = nodes
        self._over = bytearray(len(shape))  # 1: this run of the node is over, a new one clears what is below it
        self._seen = [0] * len(shape)  # the sweep in which a node was last found to need no clearing
        self._sweep = 1
        self._halted: list[int] = []  # by the halts that come in a row

    def period(self, event: PeriodPassed, robot: Reading | None) -> None:
        """A period is over."""
        self.now, self.ticks, self.overruns = event.t, event.ticks, event.overruns
        self.robot = robot

    def change(self, index: int, status: int, t: float, reason: str = "") -> None:
        """A node has a new status."""
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
            if before != SUSPENDED or not self._has_children(index):  # a command starts anew, what is above goes on
                self.started[index] = t
            self.statuses[index] = RUNNING
            if index == 0:
                self.statuses[:] = self.statuses.replace(bytes([SUSPENDED]), bytes([HALTED]))
            return
        if before not in (RUNNING, SUSPENDED):
            self.started[index] = t
        self.statuses[index] = status
        self.ended[index] = t
        if status == FAILURE:
            self.reasons[index] = reason
        if before == RUNNING or (index and repeats(self._nodes[self.shape.parents[index]])):
            self._end_run(index)

    def _halt(self, index: int, t: float) -> None:
        self.statuses[index] = HALTED
        self.ended[index] = t
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
        """Children tell their changes before their parents, so the first news from below a node begins its new run."""
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
            end = self.shape.ends[top]
            self.statuses[top + 1 : end] = bytes([IDLE]) * (end - top - 1)
            over[top:end] = bytes(end - top)

    def _clear_older(self, index: int, t: float) -> None:
        """Nothing below a node counts any more but what has just changed."""
        node, end = index + 1, self.shape.ends[index]
        while node < end:
            if self.statuses[node] == RUNNING:  # which has cleared what is below it
                node = self.shape.ends[node]
                continue
            if self.ended.get(node) != t:
                self.statuses[node] = IDLE
            node += 1

    def _has_children(self, index: int) -> bool:
        return self.shape.ends[index] > index + 1
