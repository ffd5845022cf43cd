"""What all topics of the simulator share: work for the stepping thread, publishing, and goals that drive."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from queue import Empty, SimpleQueue
from threading import Lock
from time import monotonic
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future as RosFuture

from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.lease import Leases
from btlang.ros.node import LATCHED
from btlang.support.record import Record

_OFF = "the simulated robot is shutting down"
COMMANDS = 10
"""How many commands of a topic may wait."""
_BRAKING = 1.0  # simulated seconds that a cancelled goal waits at most until the robot stands still


class CallQueue:
    """Work for the thread that calls `work`, which does it in order. `post` and `ask` are for all other threads."""

    def __init__(self) -> None:
        self._jobs: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._questions: set[Future[str]] = set()
        self._lock = Lock()
        self._closed = False

    def post(self, job: Callable[[], object]) -> None:
        """Hand over a call without waiting."""
        self._jobs.put(job)

    def ask(self, job: Callable[[], object]) -> tuple[bool, str]:
        """Wait until a call is done; return True and its text, or False and why the robot can't do it."""
        answer: Future[str] = Future()

        def do() -> None:
            try:
                text = job()
                answer.set_result(text if isinstance(text, str) else "")
            except RobotError as error:
                answer.set_exception(error)

        with self._lock:
            if self._closed:
                return False, _OFF
            self._questions.add(answer)
        self._jobs.put(do)
        try:
            return True, answer.result()
        except RobotError as error:
            return False, str(error)
        except CancelledError:
            return False, _OFF
        finally:
            self._questions.discard(answer)

    def work(self, seconds: float) -> None:
        """Do what is handed over for so many seconds of real time, or until `wake`."""
        end = monotonic() + seconds
        while True:
            try:
                job = self._jobs.get(timeout=max(0.0, end - monotonic()))
            except Empty:
                return
            if job is None:
                return
            job()

    def wake(self) -> None:
        """End `work`, from any thread and from handlers of signals."""
        self._jobs.put(None)

    def close(self) -> None:
        """Refuse calls from now on: whoever waits gets that as an answer."""
        with self._lock:
            self._closed = True
            waiting = list(self._questions)
        for answer in waiting:
            answer.cancel()


class Moment(Record):
    """The seconds of simulated time since the start, and the stamp for messages of this moment."""

    seconds: float
    stamp: Time


class PeriodicPublisher:
    """Due when it is first asked, then once a period of simulated time; at every step if steps are longer."""

    def __init__(self, hertz: float) -> None:
        self._period = 1 / hertz
        self._next = -math.inf

    def is_due(self, seconds: float) -> bool:
        """Return whether it is due now; missed periods aren't caught up with."""
        if seconds < self._next - 1e-6:
            return False
        self._next += self._period
        if self._next < seconds:
            self._next = seconds + self._period
        return True


class LatchedPublisher:
    """A topic with one value, `data`, that is published when it changes and kept for later subscribers."""

    def __init__(self, node: Node, kind: type[Any], topic: str, value: Any) -> None:
        self._kind = kind
        self._publisher = node.create_publisher(kind, topic, LATCHED)
        self._value = value
        self._publisher.publish(kind(data=value))

    def set(self, value: Any) -> None:
        """Publish a value that differs from the last one."""
        if value != self._value:
            self._value = value
            self._publisher.publish(self._kind(data=value))


class AcceptedGoal:
    """A goal that has been accepted; it begins with the next step. `failure` is why it didn't succeed."""

    def __init__(self, node: Node, handle: ServerGoalHandle) -> None:
        self._node, self.handle = node, handle
        self.failure: str | None = None
        self.began = 0.0
        self.cancelled: float | None = None
        """The second at which its client cancelled it."""
        self._abandoned = False
        self._ended = RosFuture()

    async def wait_for_end(self, leases: Leases) -> None:
        """Wait for `end`, and report how the goal ended; in the thread of the executor."""
        goal_id = bytes(self.handle.goal_id.uuid)
        leases.watch(goal_id, self._abandon)
        await self._ended
        leases.forget(goal_id)
        if self.failure is None:
            self.handle.succeed()
        elif self.handle.is_cancel_requested:
            self.handle.canceled()
        else:
            self.handle.abort()

    def end(self) -> None:
        """End the goal."""
        self._ended.set_result(None)
        self._node.executor.wake()

    def is_withdrawn(self, now: float) -> bool:
        """Return whether its client has cancelled it, or died, since the last call."""
        if self.cancelled is not None or not (self.handle.is_cancel_requested or self._abandoned):
            return False
        self.cancelled = now
        return True

    def brakes(self, now: float, robot: SimulatedRobot) -> bool:
        """Return whether it was withdrawn and has to wait until the robot stands still."""
        return self.cancelled is not None and now - self.cancelled < _BRAKING and robot.velocity != (0.0, 0.0)

    def _abandon(self) -> None:
        self._abandoned = True
