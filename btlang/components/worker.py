"""The process of a component: `python -m btlang.components.worker FD`, which speaks with its robot over a socket.

Any message may be lost: the robot asks again for what it knows nothing of, and each request is done once. One thread
answers, so that a hook that hangs can be distinguished from a process that does. The process ends with its robot; with
`--shared PATH` several robots may come to a socket, and it ends when none is left.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import signal
import socket
import sys
import threading
import time
from contextlib import suppress
from multiprocessing.connection import Connection
from queue import Empty, SimpleQueue

from btlang.components.calls import MethodCall, RemoteDevice, RobotQuestions, pack, pack_error, unpack
from btlang.components.component import (
    ACTIVE,
    FINALIZED,
    INACTIVE,
    SHARED,
    TRANSITIONS,
    UNCONFIGURED,
    UPWARDS,
    Component,
    ComponentError,
    Transition,
)
from btlang.components.location import describe, load_class
from btlang.engine.leaves.leaf import describe_exception, locate_failure
from btlang.robots.bodies.body_file import load_body

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

_PERIOD = 0.05  # seconds that a `yield` waits
_AGAIN = 0.2  # seconds after which a question to the robot is asked once more
_ALONE = 2.0  # seconds that a shared component waits for another robot
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
_MOST_FILES = 1024  # that are open at the start of a process
_HEIGHTS = {FINALIZED: -1, UNCONFIGURED: 0, INACTIVE: 1, ACTIVE: 2}


class Worker:
    """The requests of one robot to the component. `state` is the one that this robot led it to."""

    def __init__(self, connection: Connection, life: ComponentLifeCycle) -> None:
        self._connection, self._life = connection, life
        self._sending = threading.Lock()
        self.questions = RobotQuestions(self)
        self.state = UNCONFIGURED
        self._calls: dict[int, MethodCall] = {}
        self._ended: dict[int, dict[str, Any]] = {}
        self._begun: set[int] = set()  # requests of the life that wait or are under way
        self._latest = 0  # the newest request that was begun
        self._gone = False

    @property
    def component(self) -> Component:
        """The component that it talks for."""
        return self._life.component

    def run(self) -> None:
        """Serve the robot until it is gone."""
        while True:
            try:
                message = unpack(self._connection.recv_bytes())
            except (EOFError, OSError):
                break
            self._take(message)
        self._gone = True
        self.halt_calls()
        self.questions.halt()

    def send(self, message: dict[str, Any]) -> None:
        """Send a message to the robot, if it still exists. Raises TypeError for values that can't be sent."""
        data = pack(message)
        if not self._gone:
            with self._sending, suppress(OSError):  # the robot is gone, which `run` notices too
                self._connection.send_bytes(data)

    def report_end(self, number: int, outcome: dict[str, Any]) -> None:
        """Note that a request is done; its outcome is sent until the robot confirms it."""
        try:
            pack(outcome)
        except TypeError as problem:
            outcome = {"problem": str(problem)}
        self._ended[number] = outcome
        self._begun.discard(number)
        self._calls.pop(number, None)
        self.report()

    def report(self) -> None:
        """Send the state again and again, so that no answer is lost for good."""
        known = [*self._calls, *self._begun]
        self.send({"state": self.state, "known": known, "ended": dict(self._ended), "problem": self._life.problem})

    def halt_calls(self) -> None:
        """End all calls of this robot."""
        for call in tuple(self._calls.values()):
            call.halt()

    def _take(self, message: dict[str, Any]) -> None:
        if "beat" in message:
            for number in message["beat"]:
                self._ended.pop(number, None)
            self.report()
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
                call = self._calls[number] = MethodCall(self, number, message["method"], message["arguments"])
                call.start()
            else:
                self._begun.add(message["id"])
                self._life.put(self, message)

    def _knows(self, number: int) -> bool:
        return number in self._calls or number in self._ended or number in self._begun


class ComponentLifeCycle:
    """The component and its life cycle, in a thread: for one robot, or for several that share it.

    With several, its state is that of the robot that needs it most; a hook is called when that changes.
    """

    def __init__(self, shared: bool = False) -> None:
        self.component, self.state, self.problem = Component(), UNCONFIGURED, ""
        self.workers: list[Worker] = []
        self._shared = shared
        self._loaded: dict[str, Any] | None = None
        self._asked: SimpleQueue[tuple[Worker, dict[str, Any]]] = SimpleQueue()
        threading.Thread(target=self._work, name="btlang life", daemon=True).start()

    def put(self, worker: Worker, message: dict[str, Any]) -> None:
        """Queue a request of a robot."""
        self._asked.put((worker, message))

    def _work(self) -> None:
        due = last = time.monotonic()
        while True:
            rate = self.component.rate if self.state == ACTIVE else 0.0
            try:
                wait = max(0.0, due - time.monotonic()) if rate else None
                worker, message = self._asked.get(timeout=wait)
            except Empty:
                now = time.monotonic()
                self._step(now - last)
                last, due = now, max(due + 1 / rate, now)
                continue
            try:
                value = self._load(worker, message) if message["do"] == "load" else self._go(worker, message["do"])
                due = last = time.monotonic()
                worker.report_end(message["id"], {"value": value})
            except BaseException as problem:
                worker.report_end(message["id"], pack_error(problem, locate=True))

    def _load(self, worker: Worker, message: dict[str, Any]) -> object:
        if self._loaded is None:
            self.component = load_class(message["place"], message["folder"])()
            self.component.name = message["name"]
            self.component.body = load_body(message["file"]) if message["file"] else None
            self.component._report_event = self._report_event
            devices = {} if self._shared else dict.fromkeys(message["devices"], RemoteDevice(worker))
            self.component._devices = devices
            self.component.set_parameters(message["parameters"])
            if not isinstance(self.component.rate, int | float) or not 0 <= self.component.rate <= 1000:
                raise ComponentError(f"its rate must be from 0 to 1000 steps a second, not {self.component.rate!r}")
            self._loaded = message
        elif any(self._loaded[key] != message[key] for key in ("place", "parameters")):
            raise ComponentError("another robot shares it with another class or other parameters")
        return describe(self.component)

    def _go(self, worker: Worker, name: str) -> str:
        transition = TRANSITIONS[name]
        if worker.state == transition.ends:
            return worker.state  # it was done, and the answer was lost
        if worker.state not in transition.begins:
            raise ComponentError(f"it can't {name}: it is {worker.state}")
        if name not in UPWARDS:
            worker.halt_calls()
        if self._is_due(worker, transition):
            try:
                getattr(self.component, transition.hook)()
            except Exception as problem:
                self._fail(problem, transition.fails)
                raise
            self.state = transition.ends
        worker.state = transition.ends
        return worker.state

    def _is_due(self, worker: Worker, transition: Transition) -> bool:
        """Return whether the hook has to be called: no robot has led it there yet, or none needs it any more."""
        if transition.name in UPWARDS:
            return _HEIGHTS[self.state] < _HEIGHTS[transition.ends]
        others = (_HEIGHTS[other.state] for other in self.workers if other is not worker)
        return all(height <= _HEIGHTS[transition.ends] for height in others)

    def _step(self, seconds: float) -> None:
        """Do a step; if it raises, the component isn't active any more."""
        try:
            self.component.step(seconds)
        except BaseException as problem:
            self.problem = f"failed in its step: {locate_failure(problem)}"
            self._fail(problem, UNCONFIGURED)
            for worker in tuple(self.workers):
                worker.report()

    def _fail(self, problem: BaseException, state: str) -> None:
        self.state = state
        for worker in self.workers:
            worker.state = state
        try:
            self.component.error(
                problem if isinstance(problem, Exception) else ComponentError(describe_exception(problem))
            )
        except Exception as another:
            self.problem = f"failed in its error hook: {locate_failure(another)}"

    def _report_event(self, kind: str, data: Mapping[str, Any]) -> None:
        for worker in tuple(self.workers):
            worker.send({"tell": kind, "data": dict(data)})


def _end() -> None:
    """End this process with everything that it has started."""
    os.killpg(0, signal.SIGKILL)


def _fork_reaper() -> None:
    """Fork a process that waits for the end of this one, however it ends, and ends what this one has started."""
    waits, held = os.pipe()
    if os.fork():
        os.close(waits)
        return
    os.close(held)
    os.closerange(3, waits)
    os.closerange(waits + 1, _MOST_FILES)
    os.read(waits, 1)
    _end()


def main(descriptor: int, robot: int) -> None:
    """Work for the robot whose process has the number `robot`, over an inherited socket."""
    ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)  # also while this process is stopped
    if os.getppid() == robot:
        _fork_reaper()
        life = ComponentLifeCycle()
        life.workers.append(worker := Worker(Connection(descriptor), life))
        worker.run()
    _end()


def main_shared(path: str) -> None:
    """Work for all robots that connect to a socket, until none is left; end if another process does that already."""
    if os.fork():  # no robot is its parent: whoever started it may be gone before the others
        os._exit(0)
    os.setsid()
    _fork_reaper()
    with open(f"{path}.lock", "w") as lock, socket.socket(socket.AF_UNIX) as door:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return
        with suppress(FileNotFoundError):
            os.unlink(path)
        door.bind(path)
        door.listen()
        life = ComponentLifeCycle(shared=True)
        door.settimeout(_ALONE)
        while True:
            try:
                connection = Connection(door.accept()[0].detach())
            except TimeoutError:
                if not life.workers:
                    break
                continue
            worker = Worker(connection, life)
            life.workers.append(worker)
            threading.Thread(target=_converse, args=(worker, life), name="btlang robot", daemon=True).start()
        os.unlink(path)
    _end()


def _converse(worker: Worker, life: ComponentLifeCycle) -> None:
    worker.run()
    life.workers.remove(worker)
    if life.problem:  # whoever needs it starts it again
        _end()


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the robot, which says when to end
    if sys.argv[1] == SHARED:
        main_shared(sys.argv[2])
    else:
        main(int(sys.argv[1]), int(sys.argv[2]))
