"""A method of a component in another process as a leaf of a tree."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

from btlang.components.calls import pack_error, value_of
from btlang.engine.leaves.leaf import ActionFailed, Failed
from btlang.robots.command_gate import RobotProxy

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    class Link(Protocol):
        """The link to the process; see btlang.components.process_host.ProcessHost."""

        def begin(self, method: str, arguments: dict[str, Any], wake: Callable[[], object]) -> WorkerRequest: ...
        def halt(self, request: WorkerRequest) -> None: ...
        def answer(self, request: WorkerRequest, asked: dict[str, Any], answer: dict[str, Any]) -> None: ...


class WorkerRequest:
    """A request to the component. `outcome` is there once `done` is set."""

    def __init__(self, number: int, message: dict[str, Any], wake: Callable[[], object]) -> None:
        self.number, self.message, self.sent, self._wake = number, message, time.monotonic(), wake
        self.done = threading.Event()
        self.outcome: dict[str, Any] = {}
        self.asked: deque[dict[str, Any]] = deque(maxlen=1)  # a call asks one thing after the other
        self.latest = 0  # the number of the question that came last, which has this answer
        self.answer: dict[str, Any] | None = None

    def end(self, outcome: dict[str, Any]) -> None:
        """End the request: it is done, or nobody will do it."""
        if not self.done.is_set():
            self.outcome = outcome
            self.done.set()
            self._wake()

    def ask(self, message: dict[str, Any]) -> None:
        """Queue a question to the robot, for the thread that ticks."""
        self.latest, self.answer = message["ask"], None
        self.asked.append(message)
        self._wake()

    @property
    def value(self) -> Any:
        """The value of the outcome. Raises ActionFailed."""
        return value_of(self.outcome)


class RemoteLeaf:
    """A method of a component as a leaf. Its questions to the robot are answered in the thread that ticks."""

    def __init__(
        self,
        host: Link,
        method: str,
        outputs: tuple[str, ...],
        robot: Any,
        wake: Callable[[], object],
        beside: set[object],
    ) -> None:
        self._host, self._method, self._outputs, self._wake, self._beside = host, method, outputs, wake, beside
        self._proxy = RobotProxy(robot, lambda call: call())
        self._request: WorkerRequest | None = None
        self._stores: dict[str, Callable[[Any], object]] = {}
        self._operations: list[Any] = []

    def start(self, **ports: Any) -> object:
        """Call the method."""
        self._stores = {name: ports.pop(name) for name in self._outputs if name in ports}
        self._operations = []
        arguments = {**ports, "outputs": list(self._stores)} if self._stores else ports
        self._request = self._host.begin(self._method, arguments, self._wake)
        self._beside.add(self)
        return None

    def tick(self) -> object:
        """Answer the method's questions, and check whether it has ended."""
        if not self.poll():
            return None
        value = self.result()
        return True if value is None else value

    def poll(self) -> bool:
        """Answer a question of the method; return whether it has ended."""
        request = self._request
        assert request is not None
        if request.asked:
            asked = request.asked.popleft()
            self._host.answer(request, asked, self._do(asked))
        return request.done.is_set()

    def result(self) -> Any:
        """Return what the method has returned. Raises ActionFailed."""
        request, self._request = self._request, None
        assert request is not None
        self._beside.discard(self)
        try:
            value = request.value
            for name, stored in request.outcome.get("stored", {}).items():
                self._stores[name](stored)
        except BaseException:
            self._proxy.let_go()
            raise
        if isinstance(value, Failed):
            self._proxy.let_go()
        return value

    def halt(self) -> None:
        """End the method, and what it has started."""
        request, self._request = self._request, None
        self._beside.discard(self)
        if request is not None:
            self._proxy.let_go()  # first: a process that doesn't read holds up who writes to it
            self._host.halt(request)

    def _do(self, asked: dict[str, Any]) -> dict[str, Any]:
        """Do one use of the robot, or of an operation that the method has begun."""
        try:
            subject = self._operations[asked["operation"]] if "operation" in asked else self._proxy
            name = asked["robot"]
            if name.startswith("_"):
                raise ActionFailed(f"a robot has no {name}")
            value = getattr(subject, name)
            if "args" in asked:
                value = value(*asked["args"], **asked.get("named", {}))
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return pack_error(problem)
        if hasattr(value, "cancel"):
            self._operations.append(value)
            return {"value": {"operation": len(self._operations) - 1}}
        return {"value": value}
