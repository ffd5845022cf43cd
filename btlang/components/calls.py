"""Calls of a component's methods in its own process, and values that go between processes as JSON."""

from __future__ import annotations

import base64
import threading
from collections.abc import Mapping
from functools import partial
from inspect import isgenerator, signature
from queue import Empty, SimpleQueue

from btlang.devices import kinds
from btlang.devices.kinds import Command, Reading
from btlang.engine.leaves.leaf import ActionFailed, Failed, Unknown, failure_reason, locate_failure, reason_text
from btlang.robots.geometry import Pose
from btlang.robots.robot import Robot
from btlang.support.record import Record
from btlang.text.json_text import dump_json, load_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Protocol

    from btlang.components.component import Component

    class Link(Protocol):
        """The link to a robot; see btlang.components.worker.Worker."""

        @property
        def component(self) -> Component: ...
        @property
        def questions(self) -> RobotQuestions: ...
        def send(self, message: dict[str, Any]) -> None: ...
        def report_end(self, number: int, outcome: dict[str, Any]) -> None: ...


_RECORDS = {
    each.__name__: each
    for each in (Pose, *(each for each in vars(kinds).values() if isinstance(each, type)))
    if issubclass(each, Reading | Command | Pose)
}
_RECORD, _BYTES = "record", "bytes"
_PERIOD = 0.05  # seconds that a `yield` waits
_AGAIN = 0.2  # seconds after which a question to the robot is asked once more


def pack(message: object) -> bytes:
    """Return a message as bytes. Raises TypeError for values that are neither plain data nor a pose, reading or
    command.
    """
    try:
        return dump_json(message, _other, separators=(",", ":")).encode()
    except ValueError:
        raise TypeError("a value that is in itself, or nested too deeply, can't be handed to another process") from None


def unpack(data: bytes) -> Any:
    """Return the message in bytes; tuples become lists. Raises ValueError if it isn't a message."""
    return load_json(data, _record)


def pack_error(problem: BaseException, locate: bool = False) -> dict[str, Any]:
    """Return the answer for an exception; `value_of` raises it on the other side, which has no traceback of it.

    With `locate` the reason names the line that raised it.
    """
    reason = locate_failure(problem) if locate else failure_reason(problem)
    return {"problem": reason, "unknown": isinstance(problem, Unknown)}


def pack_result(result: object) -> dict[str, Any]:
    """Return the answer for what a method returned. `Failed` stays a plain no: it is no error of a condition."""
    return {"refusal": reason_text(result.reason)} if isinstance(result, Failed) else {"value": result}


def value_of(answer: Mapping[str, Any]) -> Any:
    """Return the value of an answer. Raises ActionFailed, or Unknown, for one that `pack_error` has made."""
    if "problem" in answer:
        raise (Unknown if answer.get("unknown") else ActionFailed)(answer["problem"])
    return Failed(str(answer["refusal"])) if "refusal" in answer else answer.get("value")


def _other(value: object) -> Any:
    if isinstance(value, Record) and type(value).__name__ in _RECORDS:
        return {_RECORD: type(value).__name__, **value.as_dict()}
    if isinstance(value, bytes | bytearray | memoryview):
        return {_BYTES: base64.b64encode(value).decode()}
    if hasattr(value, "tolist"):  # arrays and numbers of numpy
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} can't be handed to another process")


def _record(data: dict[str, Any]) -> Any:
    if _BYTES in data and len(data) == 1:
        return base64.b64decode(data[_BYTES])
    kind = _RECORDS.get(data[_RECORD]) if isinstance(data.get(_RECORD), str) else None
    if kind is None:
        return data
    try:
        return kind(**{name: value for name, value in data.items() if name != _RECORD})
    except TypeError as problem:
        raise ValueError(str(problem)) from None


class RobotQuestions:
    """The questions of one thread of the component to its robot, one after the other."""

    def __init__(self, worker: Link, number: int = 0) -> None:
        self._worker, self.number = worker, number
        self.halted = threading.Event()
        self._asked = 0
        self._answers: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self._asking = threading.Lock()

    def halt(self) -> None:
        """Ask the thread to end, as the engine does with leaves."""
        self.halted.set()
        self._answers.put({})

    def answer(self, message: dict[str, Any]) -> None:
        """Take the robot's answer to the current question."""
        self._answers.put(message)

    def ask(self, **question: Any) -> Any:
        """Ask the robot; return its answer. Raises ActionFailed, also once the call was halted."""
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


class MethodCall(RobotQuestions):
    """One call of a method, in its own thread."""

    def __init__(self, worker: Link, number: int, method: str, arguments: Mapping[str, Any]) -> None:
        super().__init__(worker, number)
        self._method, self._arguments = method, dict(arguments)
        self._stored: dict[str, Any] = {}

    def start(self) -> None:
        """Begin the call."""
        threading.Thread(target=self._work, name="btlang call", daemon=True).start()

    def _work(self) -> None:
        try:
            self._worker.report_end(self.number, {**pack_result(self._result()), "stored": self._stored})
        except BaseException as problem:
            self._worker.report_end(self.number, pack_error(problem, locate=True))

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
        return result


class RemoteRobot:
    """The robot as a method of a component gets it: a Robot. Each use waits for the mission."""

    def __init__(self, call: MethodCall) -> None:
        self._call = call

    def __getattr__(self, name: str) -> Any:
        if not callable(getattr(Robot, name, None)):
            return self._handle(self._call.ask(robot=name))
        return lambda *args, **named: self._handle(self._call.ask(robot=name, args=args, named=named))

    def _handle(self, value: Any) -> Any:
        return RemoteOperation(self._call, value["operation"]) if isinstance(value, dict) else value


class RemoteOperation:
    """An operation of the robot as a method of a component gets it."""

    def __init__(self, call: MethodCall, number: int) -> None:
        self._call, self._number = call, number

    @property
    def done(self) -> bool:
        return bool(self._call.ask(operation=self._number, robot="done"))

    @property
    def failure(self) -> str | None:
        failure: str | None = self._call.ask(operation=self._number, robot="failure")
        return failure

    def cancel(self) -> None:
        self._call.ask(operation=self._number, robot="cancel", args=())


class RemoteDevice:
    """A device of the robot, which its process reads and writes."""

    def __init__(self, worker: Link) -> None:
        self._worker, self._questions = worker, worker.questions

    def read(self, name: str) -> Any:
        return self._questions.ask(device=name)

    def write(self, name: str, command: Any) -> None:
        self._worker.send({"write": name, "command": command})
