"""Calls of the methods of a component in its own process, and what they ask of the robot meanwhile."""

from __future__ import annotations

import threading
from functools import partial
from inspect import isgenerator, signature
from queue import Empty, SimpleQueue

from btlang.components.plain import refused, value_of
from btlang.engine.leaves.leaf import ActionFailed, Failed, reason_text
from btlang.robots.robot import Robot

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any, Protocol

    from btlang.components.component import Component

    class Link(Protocol):
        """The way to a robot: see btlang.components.worker.Worker."""

        @property
        def component(self) -> Component: ...
        @property
        def questions(self) -> Questions: ...
        def send(self, message: dict[str, Any]) -> None: ...
        def ended(self, number: int, outcome: dict[str, Any]) -> None: ...


_PERIOD = 0.05  # seconds that a `yield` waits
_AGAIN = 0.2  # seconds after which a question to the robot is asked once more


class Questions:
    """What one thread of the component asks its robot, one thing after the other."""

    def __init__(self, worker: Link, number: int = 0) -> None:
        self._worker, self.number = worker, number
        self.halted = threading.Event()
        self._asked = 0
        self._answers: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self._asking = threading.Lock()

    def halt(self) -> None:
        """Asks it to end, as the engine does with leaves."""
        self.halted.set()
        self._answers.put({})

    def answer(self, message: dict[str, Any]) -> None:
        """What the robot says to its question."""
        self._answers.put(message)

    def ask(self, **question: Any) -> Any:
        """What the robot says to it. Raises ActionFailed, also once the call was halted."""
        with self._asking:
            self._asked += 1
            asked = {"ask": self._asked, "call": self.number, **question}
            while not self.halted.is_set():
                self._worker.send(asked)
                try:
                    answer = self._answers.get(timeout=_AGAIN)
                    while answer.get("answer") != self._asked and not self.halted.is_set():
                        answer = self._answers.get(timeout=_AGAIN)  # to a question that was asked twice
                except Empty:
                    continue
                return value_of(answer)
        raise ActionFailed("it was halted")


class Call(Questions):
    """One call of a method, in a thread of its own."""

    def __init__(self, worker: Link, number: int, method: str, arguments: Mapping[str, Any]) -> None:
        super().__init__(worker, number)
        self._method, self._arguments = method, dict(arguments)
        self._stored: dict[str, Any] = {}

    def start(self) -> None:
        """Begins it."""
        threading.Thread(target=self._work, name="btlang call", daemon=True).start()

    def _work(self) -> None:
        try:
            self._worker.ended(self.number, {"value": self._result(), "stored": self._stored})
        except BaseException as problem:
            self._worker.ended(self.number, refused(problem))

    def _result(self) -> object:
        method: Callable[..., Any] = getattr(self._worker.component, self._method)
        takes = signature(method).parameters
        given = dict(self._arguments)
        for name in given.pop("outputs", ()):
            given[name] = partial(self._stored.__setitem__, name)
        services = {"robot": RemoteRobot(self), "halted": self.halted}
        given |= {name: service for name, service in services.items() if name in takes}
        result = method(**given)
        if isgenerator(result):
            generator = result
            try:
                while not self.halted.is_set():
                    next(generator)
                    self.halted.wait(_PERIOD)
                return False
            except StopIteration as end:
                result = end.value
            finally:
                generator.close()
        if isinstance(result, Failed):
            raise ActionFailed(reason_text(result.reason))
        return result


class RemoteRobot:
    """The robot as a method of a component gets it: see btlang.robots.robot.Robot. Each use waits for the mission."""

    def __init__(self, call: Call) -> None:
        self._call = call

    def __getattr__(self, name: str) -> Any:
        if not callable(getattr(Robot, name, None)):
            return self._handle(self._call.ask(robot=name))
        return lambda *args, **named: self._handle(self._call.ask(robot=name, args=args, named=named))

    def _handle(self, value: Any) -> Any:
        return RemoteOperation(self._call, value["operation"]) if isinstance(value, dict) else value


class RemoteOperation:
    """See btlang.robots.robot.Operation."""

    def __init__(self, call: Call, number: int) -> None:
        self._call, self._number = call, number

    @property
    def done(self) -> bool:
        """See Operation."""
        return bool(self._call.ask(operation=self._number, robot="done"))

    @property
    def failure(self) -> str | None:
        """See Operation."""
        failure: str | None = self._call.ask(operation=self._number, robot="failure")
        return failure

    def cancel(self) -> None:
        """See Operation."""
        self._call.ask(operation=self._number, robot="cancel", args=())


class RemoteDevice:
    """A device of the robot, which its process reads and writes."""

    def __init__(self, worker: Link) -> None:
        self._worker, self._questions = worker, worker.questions

    def read(self, name: str) -> Any:
        """See Component.read."""
        return self._questions.ask(device=name)

    def write(self, name: str, command: Any) -> None:
        """See Component.write."""
        self._worker.send({"write": name, "command": command})
