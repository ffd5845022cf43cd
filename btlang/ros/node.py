"""A ROS 2 node that is spun in its own thread, and callables that are handed over to that thread."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from threading import Thread

import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions

from btlang.engine.leaves.leaf import describe_exception
from btlang.ros.available import unusable
from btlang.ros.clocks import AWAKE, HEARTBEAT, wait_until

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType

_LAST_DOMAIN = 232
_TASKS_OF_AN_ANSWER = 3  # one starts the next: the goal ends, its future is done, the result is sent
_DELIVERY = 0.2  # seconds
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""A quality of service by which late subscribers get the last message."""


class ExecutorThread:
    """A queue of callables for the thread that spins a node. `problems` has errors that
    couldn't be reported at once.
    """

    def __init__(self, node: Node) -> None:
        self.problems: list[str] = []
        self._posted: deque[Callable[[], object]] = deque()
        self._guard = node.create_guard_condition(self._work)

    def post(self, work: Callable[[], object]) -> None:
        """Queue a callable, from any thread or signal handler; they run in the order of calls."""
        self._posted.append(work)
        self._guard.trigger()

    @property
    def left(self) -> int:
        """How many callables haven't run yet."""
        return len(self._posted)

    def _work(self) -> None:
        while self._posted:
            work = self._posted[0]
            try:
                work()
            except Exception as problem:  # it would end the thread that spins
                self.problems.append(describe_exception(problem))
            self._posted.popleft()  # only now, so that it counts as left until it is done


class SpunNode:
    """A ROS 2 node in its own context, whose callbacks run in one thread, one at a time.

    Use it with `with`, or call `close`: a thread that still spins when the process ends would abort it. Signals stay
    with the program. With `use_sim_time` the node's clock is the topic /clock. `make` makes another kind of node.
    Raises MissionError (BT100).
    """

    def __init__(
        self,
        name: str,
        *,
        namespace: str = "",
        use_sim_time: bool = False,
        domain_id: int | None = None,
        make: Callable[..., Node] = Node,
    ) -> None:
        self.context = Context()
        overrides = [Parameter("use_sim_time", Parameter.Type.BOOL, use_sim_time)]
        try:
            rclpy.init(context=self.context, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO)
            self._check_domain()
            self.node = make(name, namespace=namespace, context=self.context, parameter_overrides=overrides)
        except RuntimeError as error:  # no such domain, no network, a log that cannot be written
            raise unusable(str(error)) from None
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._closing = False
        self._thread = Thread(target=self._watch, name=f"ros {name}", daemon=True)

    def start(self) -> None:
        """Begin to call callbacks. Call this once all publishers and subscriptions exist."""
        self.node.create_timer(HEARTBEAT, AWAKE.now, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._thread.start()

    def settle(self, seconds: float) -> None:
        """Wait until the thread has done everything requested so far and its answers are out.

        At most `limit` real seconds, plus the moment that DDS needs: nothing reports when a client has its answer.
        """
        until = time.monotonic() + seconds
        for _ in range(_TASKS_OF_AN_ANSWER):
            wait_until(self._executor.create_task(lambda: None).done, until - time.monotonic())
        time.sleep(_DELIVERY)

    def close(self) -> None:
        """End the thread, then the node, then its context. May be called twice."""
        self._closing = True
        self._executor.shutdown()
        if self._thread.ident is not None:
            self._thread.join()
        if self.context.ok():
            for waitable in tuple(self.node.waitables):  # clients and servers of actions, which destroy_node forgets:
                waitable.destroy()  # each would keep the node in the graph until Python collects garbage
            self.node.destroy_node()
            rclpy.shutdown(context=self.context)

    def __enter__(self) -> SpunNode:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _check_domain(self) -> None:
        """Check the domain id, since Fast DDS would end the process for a wrong one."""
        number = self.context.get_domain_id()
        if number > _LAST_DOMAIN:
            rclpy.shutdown(context=self.context)
            raise RuntimeError(f"ROS_DOMAIN_ID must be from 0 to {_LAST_DOMAIN}, not {number}")

    def _watch(self) -> None:
        AWAKE.watch()
        try:
            self._spin()
        finally:
            AWAKE.unwatch()

    def _spin(self) -> None:
        """Spin the node. An exception in a callback is logged, and spinning goes on."""
        while self.context.ok():
            try:
                self._executor.spin()
                return
            except ExternalShutdownException:
                return
            except Exception as error:
                if self._closing:  # rclpy takes away what this thread may be waiting with
                    return
                self.node.get_logger().error(f"{type(error).__name__}: {error}")
