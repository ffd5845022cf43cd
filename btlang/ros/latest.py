"""The latest message of a topic, and how old it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

from btlang.engine.leaves.leaf import Unknown
from btlang.robots.robot import SensorSilent
from btlang.ros.awake import AWAKE
from btlang.ros.steady_time import SteadyTime
from btlang.ros.times import seconds_of
from btlang.ros.word import type_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

AGE = 5.0
"""Seconds after which what came last no longer counts, where a table says nothing else."""


class NodeClock:
    """The clock of a node in seconds, from any thread.

    Without simulated time those are real ones in which this process is awake; else those of SteadyTime: a limit is
    always reached.
    """

    def __init__(self, node: Any) -> None:
        self._clock = node.get_clock()
        simulated = getattr(self._clock, "ros_time_is_active", True)
        self.now: Callable[[], float] = SteadyTime(self._seconds).now if simulated else AWAKE.now
        """Seconds of the node's clock."""

    def message(self) -> Any:
        """The time as builtin_interfaces/Time."""
        return self._clock.now().to_msg()

    def _seconds(self) -> float:
        return float(self._clock.now().nanoseconds) * 1e-9


class Latest:
    """What came last. `store` is for the thread of the callbacks, all else for any one.

    `named` is what it is called, such as "/scan"; `absence` says why nothing may have come, "" for no known reason.
    A message that `refuses` gives a reason for counts as silence (see `btlang.ros.gate`).
    """

    depth = 5
    """How many messages may wait for the thread that spins."""

    def __init__(
        self,
        named: str,
        now: Callable[[], float],
        absence: Callable[[], str] = str,
        refuses: Callable[[Any], str] = lambda message: "",
    ) -> None:
        self.named = named
        self.refused = ""
        """Why the latest one was refused, in words; "" where it was not."""
        self._now = now
        self._absence = absence
        self._refuses = refuses
        self._last: tuple[Any, float] | None = None  # with its time of arrival

    @property
    def has_come(self) -> bool:
        """Whether there is any message."""
        return self._last is not None

    @property
    def arrived(self) -> float:
        """The second at which the message came; -inf if there is none."""
        return -math.inf if self._last is None else self._last[1]

    @property
    def message(self) -> Any:
        """The message, however old; None if there is none."""
        return None if self._last is None else self._last[0]

    def store(self, message: Any) -> bool:
        """Keeps a message in place of the one before, unless it is refused."""
        reason = self._refuses(message)
        self.refused = f"{self.named} {reason}" if reason else ""
        if not reason:
            self._last = message, self._now()
        return not reason

    def silence(self) -> float:
        """Seconds since it came. While this process was asleep nothing could come."""
        return math.inf if self._last is None else min(self._now() - self._last[1], AWAKE.since_woke())

    def take(self, age: float | None = AGE) -> Any:
        """The message, not older than so many seconds; None for any age. Raises Unknown with the reason."""
        last = self._last
        if last is None:
            raise Unknown(self.why_not())
        silence = self.silence()
        if age is not None and silence > age:
            reason = self.refused or self._absence()
            raise Unknown(reason or f"nothing has arrived on {self.named} for {silence:.1f} s")
        return last[0]

    def why_not(self) -> str:
        """Why nothing has come, "" where something has."""
        if self.has_come:
            return ""
        return self.refused or self._absence() or f"nothing has arrived on {self.named} yet"


class LatestJoints(Latest):
    """The latest position of each joint. A robot may report its limbs in separate messages."""

    depth = 50

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._joints: dict[str, tuple[float, float, float]] = {}  # position, time of arrival, stamp

    def store(self, message: Any) -> bool:
        """See Latest."""
        if not super().store(message):
            return False
        now, stamp = self._now(), seconds_of(message.header.stamp)
        self._joints.update((name, (at, now, stamp)) for name, at in zip(message.name, message.position, strict=False))
        return True

    def missing(self, joints: Iterable[str]) -> list[str]:
        """Those of some joints of which no position has ever come."""
        return [joint for joint in joints if joint not in self._joints]

    def position(self, joint: str, age: float) -> tuple[float, float]:
        """Where a joint is, in radians or metres, and the stamp of that. Raises SensorSilent if it isn't known."""
        position, arrived, stamp = self._joints.get(joint, (math.nan, math.inf, 0.0))
        if not math.isfinite(position):
            raise SensorSilent(f'{self.named} doesn\'t report the joint "{joint}"')
        if min(self._now() - arrived, AWAKE.since_woke()) > age:
            raise SensorSilent(f'{self.named} hasn\'t reported the joint "{joint}" for {age:g} s')
        return position, stamp


def latest_of(cls: type) -> type[Latest]:
    """What keeps the latest messages of a type."""
    return LatestJoints if type_name(cls) == "sensor_msgs/msg/JointState" else Latest
