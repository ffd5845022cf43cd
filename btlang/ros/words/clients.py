"""What leaves share of a ROS 2 node: one publisher, subscription or client for each name and type.

All requests are made in the thread that spins the node: leaves hand them over with `post`, and look at what came back.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy._rclpy_pybind11 import RCLError
from rclpy.action import ActionClient
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from btlang.ros.clocks import wait_until
from btlang.ros.graph import full_name, is_ready, no_listener, no_publisher, no_server
from btlang.ros.lease import Lease
from btlang.ros.messages import type_name
from btlang.ros.node import ExecutorThread
from btlang.ros.subscriptions import Latest, MessageGate, NodeClock, latest_of
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, TypeAlias

    from btlang.robots.motion.guard.guard import Verdict

    Missing: TypeAlias = Callable[[], str]
    Key: TypeAlias = tuple[str, str, str, bool]  # kind, name and type of a Need; whether it is latched

    class Ending(Protocol):
        """Something that was halted: `waits_for` returns what it waits for, "" when it has ended."""

        def waits_for(self) -> str: ...


_HEARD = 0.5  # seconds that those who listen to one topic get to acknowledge


class RosNeed(Record):
    """Something that a leaf needs of the robot: `kind` is "action", "service", "publisher", "listener" or "node".

    `type` is that of its interface; `missing` is why it isn't there, "" if it is.
    """

    kind: str
    name: str
    type: str
    missing: str


class Unusable(Exception):
    """The reason why no client can be made."""


class RosClients:
    """The clients on one node, which somebody else spins; for the thread that ticks.

    Call `close` while the node still spins.
    """

    def __init__(self, node: Any) -> None:
        self.node = node
        self.clock = NodeClock(node)
        self.steady = Clock(clock_type=ClockType.STEADY_TIME)
        """A clock for timers that go on while simulated time stands still."""
        self.executor = ExecutorThread(node)
        self.endings: list[Ending] = []
        """What was halted and may not have ended yet."""
        self.judge: Callable[[str, float, float], Verdict | None] = lambda topic, linear, angular: None
        """The verdict of the guard about metres and degrees a second on a topic; None if it doesn't guard that one."""
        self.lease: Lease | None = None
        """The lease of the goals, once there is an action."""
        self._publishers: list[Any] = []
        self._types: dict[tuple[str, str], Any] = {}
        self._made: dict[Key, tuple[Any, Missing]] = {}  # each with a function for why it's of no use yet
        self._used: dict[Key, None] = {}  # since the mission began

    @property
    def problems(self) -> list[str]:
        """Errors in requests that couldn't be reported at once."""
        return self.executor.problems

    def post(self, work: Callable[[], object]) -> None:
        """Queue a callable for the thread that spins; from any thread, in the order of calls."""
        self.executor.post(work)

    def publisher(self, cls: Any, name: str, latched: bool = False) -> Any:
        """Return a publisher whose messages reach all listeners; those of a latched topic also later ones."""
        name = self._claim("listener", cls, name)

        def make() -> tuple[Any, Missing]:
            made = self.node.create_publisher(cls, name, _qos(latched))
            self._publishers.append(made)
            heard = made.get_subscription_count
            return made, lambda: "" if latched or heard() else no_listener(self.node, cls, name)

        return self._once(("listener", name, type_name(cls), latched), make)

    def _gate(self, cls: Any) -> MessageGate:
        return MessageGate(cls, lags=not getattr(self.node.get_clock(), "ros_time_is_active", True))

    def latest(self, cls: Any, name: str, latched: bool = False) -> Latest:
        """Return the latest message of a topic. One that isn't latched is heard from reliable and other publishers."""
        name = self._claim("publisher", cls, name)

        def make() -> tuple[Latest, Missing]:
            made = latest_of(cls)(
                name, self.clock.now, lambda: no_publisher(self.node, cls, name), self._gate(cls).refuses
            )
            qos = _qos(True) if latched else QoSProfile(depth=made.depth, reliability=ReliabilityPolicy.BEST_EFFORT)
            self.node.create_subscription(cls, name, made.store, qos)
            return made, made.why_not

        return self._once(("publisher", name, type_name(cls), latched), make)  # type: ignore[no-any-return]

    def action(self, cls: Any, name: str) -> Any:
        """Return an rclpy ActionClient; its requests are for `post`."""
        self.lease = self.lease or Lease(self.node)  # before the client
        return self._client("action", cls, name, lambda: ActionClient(self.node, cls, name))

    def service(self, cls: Any, name: str) -> Any:
        """Return an rclpy Client; its requests are for `post`."""
        return self._client("service", cls, name, lambda: self.node.create_client(cls, name))

    def parameter(self, node: str, parameter: str, ask: Callable[[], Latest]) -> Latest:
        """Return the latest value of a parameter of another node; `ask` begins to ask for it."""

        def make() -> tuple[Latest, Missing]:
            latest = ask()
            return latest, latest.why_not

        return self._once(("node", node, parameter, False), make)  # type: ignore[no-any-return]

    def begin(self) -> None:
        """Begin a new mission: what leaves need is what they ask for from now on. Clients stay."""
        self._used.clear()

    def used(self) -> list[tuple[str, str, str]]:
        """Return kind, name and type of each need, without checking whether it is there."""
        return [(kind, name, type) for kind, name, type, _ in self._used]

    def needs(self) -> list[RosNeed]:
        """Return everything that leaves need of the robot, by kind and name."""
        needs = [RosNeed(kind, name, type, self._made[key][1]()) for key in self._used for kind, name, type, _ in [key]]
        return sorted(needs, key=lambda need: (need.kind, need.name))

    def missing(self) -> list[str]:
        """Return a line for each need that isn't there."""
        return [need.missing for need in self.needs() if need.missing]

    def wait(self, limit: float) -> list[str]:
        """Block until nothing is missing, for at most `limit` real seconds; return what still is."""
        wait_until(lambda: not self.missing(), limit)
        return self.missing()

    def close(self, limit: float) -> list[str]:
        """Wait until everything halted has ended and listeners have heard it, for at most `limit` real seconds.

        Returns what hasn't ended.
        """
        until = time.monotonic() + limit
        wait_until(lambda: not (self.left() or self.executor.left), limit)
        left = self.left()
        for publisher in self._publishers:
            publisher.wait_for_all_acked(Duration(seconds=max(0.0, min(_HEARD, until - time.monotonic()))))
        self.endings.clear()
        return left

    def left(self) -> list[str]:
        """Return what halted goals wait for."""
        self.endings = [ending for ending in self.endings if ending.waits_for()]
        return [ending.waits_for() for ending in self.endings]

    def _client(self, kind: str, cls: Any, name: str, create: Callable[[], Any]) -> Any:
        name = self._claim(kind, cls, name)

        def make() -> tuple[Any, Missing]:
            client = create()
            return client, lambda: "" if is_ready(client) else no_server(self.node, cls, name)

        return self._once((kind, name, type_name(cls), False), make)

    def _claim(self, kind: str, cls: Any, name: str) -> str:
        """Return the name with the namespace. Raises Unusable for a second type: a node can use
        a name with only one.
        """
        sort = "topic" if kind in ("listener", "publisher") else kind
        try:
            name = full_name(self.node, kind, name)
        except (RCLError, ValueError) as error:
            raise _make_unusable(error) from None
        first = self._types.setdefault((sort, name), cls)
        if first is not cls:
            raise Unusable(f"another word uses the {sort} {name} with the type {type_name(first)}")
        return name

    def _once(self, key: Key, make: Callable[[], tuple[Any, Missing]]) -> Any:
        if key not in self._made:
            try:
                self._made[key] = make()
            except (RCLError, ValueError) as error:
                raise _make_unusable(error) from None
        self._used[key] = None
        return self._made[key][0]


def _make_unusable(error: Exception) -> Unusable:
    """Return an Unusable for an error of rclpy, which raises ValueError for a name."""
    return Unusable(f"ROS 2 refuses it: {str(error).partition(', at ')[0]}")


def _qos(latched: bool) -> QoSProfile:
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=1 if latched else 10, reliability=ReliabilityPolicy.RELIABLE, durability=durability)
