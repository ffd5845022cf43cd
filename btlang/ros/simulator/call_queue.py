"""Work that callbacks hand over to the thread that steps the simulation."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from queue import Empty, SimpleQueue
from threading import Lock
from time import monotonic

from btlang.robots.robot import RobotError


class CallQueue:
    """`post` and `ask` are for any thread but the one that calls `work`, which does it all, in order."""

    def __init__(self) -> None:
        self._jobs: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._questions: set[Future[str]] = set()
        self._lock = Lock()
        self._closed = False

    def post(self, job: Callable[[], object]) -> None:
        """Hands over something to do, and waits for nothing."""
        self._jobs.put(job)

    def ask(self, job: Callable[[], object]) -> tuple[bool, str]:
        """Waits until it is done: True and the text it returned, or False and why the robot cannot do it."""
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
        """Does what is handed over within so many seconds of real time, or until `wake`."""
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
        """Ends `work`, from any thread and from handlers of signals."""
        self._jobs.put(None)

    def close(self) -> None:
        """Nobody works any more: whoever asks or waits now gets that as an answer."""
        with self._lock:
            self._closed = True
            waiting = list(self._questions)
        for answer in waiting:
            answer.cancel()


_OFF = "the simulated robot is shutting down"
