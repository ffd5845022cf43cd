"""The process of a component: `python -m btlang.components.worker FD`, which speaks with its robot over a socket.

Whatever is said may be lost: the robot asks again for what it knows nothing of, and each request is done once. What
answers it is one thread, so that a hook that hangs is told from a process that does. It ends with its robot.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time
from functools import partial
from inspect import isgenerator, signature
from multiprocessing.connection import Connection
from queue import Empty, SimpleQueue

from btlang.components.component import Component, ComponentError
from btlang.components.life_cycle import ACTIVE, TRANSITIONS, UNCONFIGURED
from btlang.components.location import describe, load_class
from btlang.components.plain import packed, unpacked
from btlang.engine.leaves.leaf import ActionFailed, Failed, Unknown, described, reason_text
from btlang.robots.capabilities import Robot

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

_PERIOD = 0.05  # seconds that a `yield` waits
_AGAIN = 0.2  # seconds after which a question to the robot is asked once more
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG


class Questions:
    """What one thread of the component asks its robot, one thing after the other."""

    def __init__(self, worker: Worker, number: int = 0) -> None:
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
                if "problem" in answer:
                    raise (Unknown if answer.get("unknown") else ActionFailed)(answer["problem"])
                return answer.get("value")
        raise ActionFailed("it was halted")


class Call(Questions):
    """One call of a method, in a thread of its own."""

    def __init__(self, worker: Worker, number: int, method: str, arguments: Mapping[str, Any]) -> None:
        super().__init__(worker, number)
        self._method, self._arguments = method, dict(arguments)
        self._stored: dict[str, Any] = {}

    def start(self) -> None:
        """Begins it."""
        threading.Thread(target=self._work, name="btlang call", daemon=True).start()

    def _work(self) -> None:
        try:
            self._worker.ended(self.number, {"value": self._result(), "stored": self._stored})
        except ActionFailed as problem:
            ended = {"problem": str(problem), "unknown": isinstance(problem, Unknown)}
            self._worker.ended(self.number, ended)
        except BaseException as problem:
            self._worker.ended(self.number, {"problem": described(problem)})

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
    """See btlang.robots.capabilities.Operation."""

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

    def __init__(self, worker: Worker) -> None:
        self._worker = worker

    def read(self, name: str) -> Any:
        """See Component.read."""
        return self._worker.questions.ask(device=name)

    def write(self, name: str, command: Any) -> None:
        """See Component.write."""
        self._worker.send({"write": name, "command": command})


class Worker:
    """The component, its life, and what is under way."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._sending = threading.Lock()
        self.component = Component()
        self.questions = Questions(self)
        self._state = UNCONFIGURED
        self._calls: dict[int, Call] = {}
        self._ended: dict[int, dict[str, Any]] = {}
        self._life: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self._begun: set[int] = set()  # requests of the life that wait or are under way
        self._latest = 0  # the newest request that was begun
        self._problem = ""

    def run(self) -> None:
        """Until the robot is gone."""
        threading.Thread(target=self._live, name="btlang life", daemon=True).start()
        while True:
            try:
                message = unpacked(self._connection.recv_bytes())
            except (EOFError, OSError):
                return
            self._take(message)

    def send(self, message: dict[str, Any]) -> None:
        """Tells the robot, if it is still there. Raises TypeError for values that can't be told."""
        data = packed(message)
        try:
            with self._sending:
                self._connection.send_bytes(data)
        except OSError:
            _end()

    def ended(self, number: int, outcome: dict[str, Any]) -> None:
        """A request is done; it is told until the robot says that it knows."""
        try:
            packed(outcome)
        except TypeError as problem:
            outcome = {"problem": str(problem)}
        self._ended[number] = outcome
        self._begun.discard(number)
        self._calls.pop(number, None)
        self._report()

    def _take(self, message: dict[str, Any]) -> None:
        if "beat" in message:
            for number in message["beat"]:
                self._ended.pop(number, None)
            self._report()
        elif "answer" in message:
            asker = self._calls.get(message["call"]) if message["call"] else self.questions
            if asker is not None:
                asker.answer(message)
        elif "halt" in message:
            if message["halt"] in self._calls:
                self._calls[message["halt"]].halt()
        elif message["id"] > self._latest or (message.get("again") and not self._knows(message["id"])):
            self._latest = max(self._latest, message["id"])
            if message["do"] == "call":
                number = message["id"]
                call = self._calls[number] = Call(self, number, message["method"], message["arguments"])
                call.start()
            else:
                self._begun.add(message["id"])
                self._life.put(message)

    def _knows(self, number: int) -> bool:
        return number in self._calls or number in self._ended or number in self._begun

    def _report(self) -> None:
        known = [*self._calls, *self._begun]
        self.send({"state": self._state, "known": known, "ended": dict(self._ended), "problem": self._problem})

    def _live(self) -> None:
        """The thread of hooks and steps."""
        due = last = time.monotonic()
        while True:
            rate = self.component.rate if self._state == ACTIVE else 0.0
            try:
                wait = max(0.0, due - time.monotonic()) if rate else None
                message = self._life.get(timeout=wait)
            except Empty:
                now = time.monotonic()
                self._guard(partial(self.component.step, now - last))
                last, due = now, max(due + 1 / rate, now)
                continue
            try:
                value = self._do(message)
                due = last = time.monotonic()
                self.ended(message["id"], {"value": value})
            except BaseException as problem:
                self.ended(message["id"], {"problem": described(problem) if _strange(problem) else str(problem)})

    def _do(self, message: dict[str, Any]) -> object:
        if message["do"] == "load":
            self.component = load_class(message["place"], message["folder"])()
            self.component.name = message["name"]
            self.component.body = message["body"]
            self.component._tell = lambda kind, data: self.send({"tell": kind, "data": dict(data)})
            self.component._devices = dict.fromkeys(message["devices"], RemoteDevice(self))
            self.component.set_parameters(message["parameters"])
            return describe(message["place"], message["folder"])
        transition = TRANSITIONS[message["do"]]
        if self._state == transition.ends:
            return self._state  # it was done, and the answer was lost
        if self._state not in transition.begins:
            raise ComponentError(f"it can't {transition.name}: it is {self._state}")
        for call in tuple(self._calls.values()) if transition.name != "activate" else ():
            call.halt()
        try:
            getattr(self.component, transition.hook)()
        except Exception as problem:
            self._state = transition.fails
            self._fail(problem)
            raise
        self._state = transition.ends
        return self._state

    def _guard(self, step: Callable[[], object]) -> None:
        """A step that raises ends the activity."""
        try:
            step()
        except Exception as problem:
            self._state, self._problem = UNCONFIGURED, f"its step failed: {described(problem)}"
            self._fail(problem)
            self._report()

    def _fail(self, problem: Exception) -> None:
        try:
            self.component.error(problem)
        except Exception as another:
            self._problem = f"its error hook failed: {described(another)}"


def _strange(problem: BaseException) -> bool:
    return not isinstance(problem, ActionFailed)


def _end() -> None:
    """With all that it has started."""
    os.killpg(0, signal.SIGKILL)


def main(descriptor: int, robot: int) -> None:
    """Works for the robot whose process has the number `robot`, over an inherited socket."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the robot, which says when to end
    ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)  # also while this process is stopped
    if os.getppid() == robot:
        Worker(Connection(descriptor)).run()
    _end()


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
