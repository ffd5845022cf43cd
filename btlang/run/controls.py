"""What may be asked of a run while it goes on: pause, resume, a single step, stop."""

from __future__ import annotations

from contextlib import suppress
from threading import Lock


class Controls:
    """May be used from any thread, from keys and from signal handlers; the run takes notice before its next tick."""

    def __init__(self) -> None:
        self._asleep = Lock()  # held but for a moment; unlike an Event it may be released within a signal handler
        self._asleep.acquire()
        self._steps = 0
        self.paused = False
        """Whether the run stands still, or will before its next tick."""
        self.stopped = False
        """Whether the run has been told to end."""

    def pause(self) -> None:
        """The robot comes to rest and the time of the mission stands still."""
        self.paused = True
        self._wake()

    def resume(self) -> None:
        """Goes on where the pause began: the commands that it interrupted start anew."""
        self.paused = False
        self._steps = 0
        self._wake()

    def toggle(self) -> None:
        """Pauses, or resumes."""
        if self.paused:
            self.resume()
        else:
            self.pause()

    def step(self) -> None:
        """One more tick, then a pause."""
        self._steps += 1
        self.pause()

    def stop(self) -> None:
        """Ends the run."""
        self.stopped = True
        self._wake()

    def take_step(self) -> bool:
        """Whether a single step was asked for that has not been made; the run then makes it."""
        if self._steps <= 0:
            return False
        self._steps -= 1
        return True

    def wait(self, seconds: float | None) -> None:
        """Sleeps so many seconds (None: without end), or until something is asked for."""
        self._asleep.acquire(timeout=-1 if seconds is None else max(0.0, seconds))

    def _wake(self) -> None:
        with suppress(RuntimeError):  # it is released already
            self._asleep.release()
